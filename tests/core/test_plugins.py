"""Catalogues merge what other distributions register, and one that is broken breaks nothing else."""

import importlib
import sys
import warnings

import pytest

from latentarm.core.errors import UserError
from latentarm.core.plugins import Catalogue, PluginWarning

GROUP = "latentarm.tests"
OWN = {"ours": "math:pi", "second": "math:e"}


def number(name, thing):
    if not isinstance(thing, float):
        raise TypeError(f"{thing!r} is no number")
    return thing


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install a distribution of one module: ``install("some-dist", {"name": "some_dist:thing"}, source)``."""
    monkeypatch.syspath_prepend(tmp_path)

    def install(distribution, entries, source=""):
        module = distribution.replace("-", "_")
        (tmp_path / f"{module}.py").write_text(source)
        folder = tmp_path / f"{module}-1.2.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.2\n")
        lines = [f"{name} = {value}" for name, value in entries.items()]
        (folder / "entry_points.txt").write_text("\n".join([f"[{GROUP}]", *lines]))
        importlib.invalidate_caches()

    return install


@pytest.fixture
def catalogue():
    return Catalogue(GROUP, "number", OWN, number)


def test_ours_come_first_and_theirs_are_found_without_being_imported(install, catalogue):
    install("theirs-dist", {"theirs": "theirs_dist:VALUE"}, "VALUE = 2.5")
    assert list(catalogue) == ["ours", "second", "theirs"]
    assert "theirs" in catalogue
    assert "theirs_dist" not in sys.modules
    assert catalogue["theirs"] == 2.5
    assert catalogue["ours"] == pytest.approx(3.14159, abs=1e-5)
    assert str(catalogue.origin("theirs")) == "theirs-dist 1.2"
    assert catalogue.origin("ours") is None


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import not_installed_anywhere", "ModuleNotFoundError"),
        ("raise RuntimeError('two\\nlines')", "RuntimeError: two lines"),
        ("", "AttributeError"),
        ("VALUE = 'text'", "'text' is no number"),
    ],
)
def test_one_that_does_not_load_is_named_and_the_others_work(install, catalogue, source, reason):
    install("broken-dist", {"broken": "broken_dist:VALUE"}, source)
    sys.modules.pop("broken_dist", None)
    with pytest.raises(UserError, match=f"'broken' of the distribution broken-dist 1.2 .*{reason}"):
        catalogue["broken"]
    with pytest.warns(PluginWarning, match=r"broken-dist 1\.2"):
        assert list(catalogue.usable()) == ["ours", "second"]


def test_a_name_of_ours_cannot_be_taken(install, catalogue):
    install("thief-dist", {"ours": "thief_dist:VALUE"}, "VALUE = 1.0")
    with pytest.warns(PluginWarning, match="'ours' of the distribution thief-dist 1.2 is left out"):
        assert list(catalogue) == ["ours", "second"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # said once
        assert catalogue["ours"] == pytest.approx(3.14159, abs=1e-5)


def test_a_name_that_two_distributions_claim_is_refused(install, catalogue):
    install("first-dist", {"theirs": "first_dist:VALUE"}, "VALUE = 1.0")
    install("other-dist", {"theirs": "other_dist:VALUE"}, "VALUE = 2.0")
    claim = r"first-dist 1\.2 and other-dist 1\.2 both register a number 'theirs'|other-dist 1\.2 and first"
    with pytest.raises(UserError, match=claim):
        catalogue["theirs"]


@pytest.mark.parametrize("name", ["Theirs", "a b", "x/../y", "\x1b[31mred"])
def test_a_name_that_could_not_be_typed_or_shown_is_left_out(install, catalogue, name):
    install("odd-dist", {name: "odd_dist:VALUE"}, "VALUE = 1.0")
    with pytest.warns(PluginWarning, match="lower-case letters") as said:
        assert list(catalogue) == ["ours", "second"]
    assert "\x1b" not in str(said[0].message)


def test_what_a_file_names_is_looked_up_and_never_imported(install, catalogue):
    with pytest.raises(
        UserError, match=r"config\.json names the number 'os:system', which is not one of ours"
    ):
        catalogue.find("os:system", "config.json")
    with pytest.raises(UserError, match=r"distribution theirs-dist.*pip install theirs-dist"):
        catalogue.find("theirs", "config.json", origin="theirs-dist")
    with pytest.raises(UserError, match="not one of ours"):
        catalogue.find("theirs", "config.json", origin="--index-url=elsewhere")
    install("theirs-dist", {"theirs": "theirs_dist:VALUE"}, "VALUE = 2.5")
    sys.modules.pop("theirs_dist", None)
    catalogue = Catalogue(GROUP, "number", OWN, number)
    assert catalogue.find("theirs", "config.json", origin="theirs-dist") == 2.5
