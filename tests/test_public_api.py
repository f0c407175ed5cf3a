"""What `import latentarm as la` offers."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path
from typing import get_args

import numpy as np
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
    places = [line.removeprefix("::: ") for line in text.splitlines() if line.startswith(":::")]
    documented = {place.rpartition(".")[2] for place in places if not place.startswith("latentarm.testing.")}
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


class Named:
    """A path that is neither a text nor a `Path`."""

    def __init__(self, path):
        self.path = path

    def __fspath__(self):
        return str(self.path)


@pytest.mark.parametrize("kind", [str, Named])
def test_paths_may_be_texts_or_path_like(kind, tmp_path):
    """Every function of the API that takes a file or a folder."""
    folder = {name: kind(tmp_path / name) for name in ("data", "run", "checkpoint", "journal.sqlite")}
    demonstrations = la.TableTop().demonstrate(4, np.random.default_rng(0))
    la.write_dataset(demonstrations, folder["data"])
    la.append_episode(folder["data"], demonstrations.episodes[0])
    read = la.read_dataset(folder["data"])
    assert len(read.episodes) == len(la.import_demonstrations(folder["data"]).episodes) == 5
    model = la.SCL(epochs=1).fit(read, checkpoint=folder["checkpoint"])
    config = {"held_out": [], "demonstrations": "", "kind": "scl", "context": "state", "fingerprint": ""}
    model.save(folder["run"], run=config | {"robot": "panda", "end_effector": None})
    assert la.load_model(folder["run"]).kind.name == "scl"
    assert la.load_decoder(folder["run"]).latent_dim == 2
    assert la.read_run(folder["run"]).robot == "panda"
    la.Recorder(folder["journal.sqlite"]).close()
    (tmp_path / "arm.xml").write_text(la.load_robot("planar").mjcf)
    assert la.load_robot(kind(tmp_path / "arm.xml")).dof


@pytest.mark.parametrize("name", la.__all__)
def test_no_function_asks_for_a_path_alone(name):
    found = getattr(la, name)
    functions = [found, *vars(found).values()] if isinstance(found, type) else [found]
    for function in filter(inspect.isfunction, functions):
        if function.__name__ == "__init__" or not function.__name__.startswith("_"):
            hints = [hint for key, hint in function.__annotations__.items() if key != "return"]
            assert not [hint for hint in hints if Path in (hint, *get_args(hint))], function
