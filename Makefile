# `make demo` and `make test` do all set-up by themselves: a fresh machine needs Python 3.11 and nothing else.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Every version is that of the lock. `make LOCK= ...` takes the newest of everything instead, torch included, whose default
# build brings gigabytes of CUDA: `make LOCK= TORCH=torch==2.13.0 ...` keeps the small one where that is the index's.
LOCK ?= constraints.txt
TORCH ?=
CONSTRAIN := $(if $(LOCK),PIP_CONSTRAINT=$(abspath $(LOCK)))
# uv installs several times faster than pip; scripts/uv.py gives it the package indexes that pip is configured with.
UV := $(CONSTRAIN) $(BIN)/python scripts/uv.py
INSTALL := $(UV) pip install --quiet --python $(BIN)/python $(TORCH)
WORKERS ?= $(shell env -u OMP_NUM_THREADS nproc 2>/dev/null || echo 2)
# One thread for each worker, unless the caller sets another number. A test file stays with one worker, so that what it
# trains is trained once; tests/conftest.py orders the files. Tests start a hundred processes: bytecode is kept even where
# the environment says otherwise, because each process would compile torch and us anew.
OMP_NUM_THREADS ?= 1
OPENBLAS_NUM_THREADS ?= 1
PYTEST := PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=$(OMP_NUM_THREADS) \
	OPENBLAS_NUM_THREADS=$(OPENBLAS_NUM_THREADS) $(BIN)/python -m pytest
PARALLEL := --numprocesses $(WORKERS) --dist loadfile --no-loadscope-reorder
# Tests in real time mostly wait: two at a time leave each what it needs, however many cores there are.
IN_PAIRS := --numprocesses $(if $(filter 1,$(WORKERS)),1,2) --dist loadfile --no-loadscope-reorder

.DEFAULT_GOAL := help
.PHONY: help demo test test-research test-all test-thorough check message-types format bench docs dist lock arms lerobot clean

help: ## Show what can be made.
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 16

$(VENV)/installed: pyproject.toml hatch_build.py package-lock.json research/pyproject.toml $(LOCK)
	$(PYTHON) -m venv $(VENV)
	$(CONSTRAIN) $(BIN)/pip install --quiet --disable-pip-version-check uv
	$(INSTALL) --editable '.[train]' --editable research
	@touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(INSTALL) --editable '.[dev]' --editable 'research[cluster,postgresql]'
	@touch $@

# Node comes with the dev extra, TypeScript from npm: both check the page's JavaScript, and neither reaches the browser.
# The certificates that npm trusts are the system's, as pip's are.
node_modules/installed: package-lock.json $(VENV)/installed-dev
	NODE_USE_SYSTEM_CA=1 $(BIN)/npm ci --no-audit --no-fund --loglevel=error
	@touch $@

demo: $(VENV)/installed ## Learn latent actions and stab marshmallows with a 7-DoF arm in physics (minutes).
	$(BIN)/latentarm demo --out demo

check: $(VENV)/installed-dev node_modules/installed ## Lint, formatting, types and import layers.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright --pythonpath $(BIN)/python --threads 2
	$(BIN)/lint-imports
	$(BIN)/node node_modules/typescript/bin/tsc

message-types: $(VENV)/installed-dev ## Write the types of the page's messages for its JavaScript.
	$(BIN)/python scripts/message_types.py

test: check ## Everything that must hold of the core, in minutes.
	$(BIN)/node --test 'tests/web/js/*.test.js'
	$(PYTEST) -m "not slow and not clock" $(PARALLEL) tests
	$(PYTEST) -m "not slow and clock" $(IN_PAIRS) tests/arms tests/web

test-research: $(VENV)/installed-dev ## The same of the research: simulated people, drives and studies, in smoke sizes.
	$(PYTEST) -m "not slow and not clock" $(PARALLEL) research/tests

test-all: check ## The slow tests too: kill tests, real lerobot, hundreds of approaches.
	$(PYTEST) -m "not clock and not browser" $(PARALLEL)
	$(PYTEST) -m "clock or browser" tests/arms tests/web

test-thorough: $(VENV)/installed-dev ## Random examples, 10,000 for motion and geometry, 2,000 drives (hours; nightly).
	$(PYTEST) --hypothesis-profile=random -m "not slow and not clock" $(PARALLEL)
	$(BIN)/python -m pytest --hypothesis-profile=thorough tests/control tests/safety tests/robots
	$(BIN)/latentarm measure clearance

arms: $(VENV)/installed-dev ## Fetch some 25 arms of other packages (420 MB), load each, and write docs/arms.md.
	$(BIN)/python scripts/fetch_arms.py
	$(BIN)/python scripts/arms_table.py
	$(BIN)/python -m pytest tests/robots/test_arms.py

# LeRobot wants torch below 2.12, so the lock does not apply here.
lerobot: $(VENV)/installed ## An environment with LeRobot 0.6 and our plug-in, for its tests (Python 3.12, several GB).
	$(BIN)/python scripts/uv.py venv --quiet --allow-existing --python 3.12 .venv-lerobot-06
	$(BIN)/python scripts/uv.py pip install --quiet --python .venv-lerobot-06/bin/python \
		--editable '.[lerobot,testing]' pytest-rerunfailures --editable plugins/lerobot_robot_latentarm

bench: $(VENV)/installed ## The online step and the batched fit, as ratios in one run.
	$(BIN)/latentarm bench

docs: $(VENV)/installed ## The documentation as a site, in site/; any warning is an error.
	$(INSTALL) --editable '.[docs]' --editable research
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --site-dir site

lock: $(VENV)/installed ## Pin the newest version of every package, direct or not, in constraints.txt.
	sed -n '/^torch==/p' constraints.txt > .torch
	$(BIN)/python scripts/uv.py pip compile --quiet --upgrade --no-annotate --no-header --all-extras \
		--constraint .torch --output-file .lock pyproject.toml research/pyproject.toml
	{ grep '^#' constraints.txt; sed '/^-e /d; s/+[a-z0-9.]*$$//' .lock; } > .torch && mv .torch constraints.txt && rm .lock

dist: $(VENV)/installed-dev ## Build the wheels and the sdists of latentarm and its research in dist/.
	rm -rf dist
	$(UV) build --quiet --all-packages --python $(BIN)/python --out-dir dist

format: $(VENV)/installed-dev ## Format and fix what can be fixed by machine.
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean: ## Remove the environment and what the demo wrote.
	rm -rf $(VENV) demo
