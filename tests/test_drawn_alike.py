"""Whether `make test` passes does not hang on what Hypothesis drew that day, or on which tests ran before."""

import importlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

WORD = "peculiar"


def drawn() -> list[list[str]]:
    """The texts that a test draws."""
    texts: list[list[str]] = []

    @given(st.lists(st.text(max_size=len(WORD)), min_size=10, max_size=10))
    def draw(some: list[str]) -> None:
        texts.append(some)

    draw()
    return texts


@pytest.mark.skipif(not settings().derandomize, reason="This profile draws at random.")
def test_a_test_draws_the_same_examples_whatever_is_loaded(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = drawn()
    assert len(before) == settings().max_examples
    folder = tmp_path_factory.mktemp("loaded")
    Path(folder / "loaded_later.py").write_text(f"WORD = {WORD!r}\n")
    monkeypatch.syspath_prepend(folder)
    assert importlib.import_module("loaded_later").WORD == WORD
    assert drawn() == before
