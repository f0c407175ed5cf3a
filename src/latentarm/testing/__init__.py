"""Contract tests of each family, which authors of plug-ins run over theirs.

Each module has one class. Subclass it in a test file of your own and give it the fixture that it names. The
modules import pytest and hypothesis, which ``pip install 'latentarm[testing]'`` brings.
"""

import pytest

# Before the modules are imported, so that pytest rewrites their assertions.
pytest.register_assert_rewrite(*(f"{__name__}.{family}" for family in ("arms", "beliefs", "models", "tasks")))
