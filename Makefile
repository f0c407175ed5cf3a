# `make demo` and `make test` do all set-up by themselves: a fresh machine needs Python 3.11 and nothing else.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt

.DEFAULT_GOAL := help
.PHONY: help demo test test-all test-thorough check format bench docs clean

help: ## Show what can be made.
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 16

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) --editable .
	@touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(PIP) --editable '.[dev]'
	@touch $@

demo: $(VENV)/installed ## Learn latent actions and drive a 7-DoF arm to three goals (minutes).
	$(BIN)/latentarm demo --out demo

check: $(VENV)/installed-dev ## Lint, formatting, types and import layers.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports

test: check ## Everything that must hold, in minutes.
	$(BIN)/python -m pytest -m "not slow"

test-all: check ## The slow tests too: kill tests, real lerobot, hundreds of approaches.
	$(BIN)/python -m pytest

test-thorough: $(VENV)/installed-dev ## 10,000 Hypothesis examples for motion and geometry, 2,000 drives (hours; nightly).
	$(BIN)/python -m pytest --hypothesis-profile=thorough tests/control tests/kinematics tests/robots
	$(BIN)/python scripts/clearance_drives.py

bench: $(VENV)/installed ## The online step and the batched fit, as ratios in one run.
	$(BIN)/latentarm bench

docs: $(VENV)/installed ## The documentation as a site, in site/; any warning is an error.
	$(PIP) --editable '.[docs]'
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --site-dir site

format: $(VENV)/installed-dev ## Format and fix what can be fixed by machine.
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean: ## Remove the environment and what the demo wrote.
	rm -rf $(VENV) demo
