"""What `import latentarm as la` offers."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import latentarm as la

PAGES = Path(__file__).parents[1] / "docs" / "api"
STUB = Path(la.__file__).with_suffix(".pyi")


@pytest.mark.parametrize("name", la.__all__)
def test_a_name_of_the_api_is_there_and_documented(name):
    assert getattr(la, name).__doc__, name


@pytest.mark.skipif(not PAGES.exists(), reason="the documentation is not beside this installation")
def test_the_site_documents_every_name():
    text = "".join(page.read_text() for page in PAGES.glob("*.md"))
    documented = {line.rpartition(".")[2] for line in text.splitlines() if line.startswith(":::")}
    assert documented == set(la.__all__)


def test_type_checkers_see_the_same_names():
    tree = ast.parse(STUB.read_text())
    names = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert names == set(la.__all__)
    assert STUB.with_name("py.typed").exists()


def test_importing_it_loads_nothing_heavy():
    code = "import sys, latentarm; print(*{'torch', 'mujoco', 'numpy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="Stepp"):
        la.Stepp  # noqa: B018
