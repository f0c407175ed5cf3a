"""Tests that everything of a family passes; authors of plug-ins run them over theirs.

Each module has one class. Subclass it in a test file of your own and give it the fixture that it names. The
modules import pytest and hypothesis, which ``pip install 'latentarm[testing]'`` brings.
"""

import pytest

# Before they are imported: their assertions are to say what they compared.
pytest.register_assert_rewrite(*(f"{__name__}.{family}" for family in ("arms", "beliefs", "models", "tasks")))
