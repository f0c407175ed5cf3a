"""An MIT package must not need code under terms that are stricter than its own."""

import re
from importlib.metadata import PackagePath, distribution

import pytest
from packaging.requirements import Requirement

REFUSED = re.compile(r"(?<!L)(?<!Lesser )A?GPL|(?<!Lesser )General Public Licen[sc]e|Affero", re.IGNORECASE)
KNOWN = re.compile(
    r"MIT|BSD|Apache|PSF|Python Software Foundation|ISC|MPL|Mozilla|HPND|Zlib|Unlicense|CC0|0BSD|LGPL|Lesser",
    re.IGNORECASE,
)

LOOKED_INTO = {
    "docutils": "public domain and BSD; what is under the GPL is an Emacs mode that is not installed",
}

OF_CUDA = re.compile(r"cuda-|nvidia-")
"""What torch's default build for Linux brings besides: the CPU build does without, and so does our code."""


def needed_by(name: str, found: dict[str, set[str]], extras: frozenset[str] = frozenset()) -> None:
    """All distributions that installing one brings, with the extras that were asked for."""
    key = name.lower().replace("_", "-")
    if key in found and extras <= found[key]:
        return
    found.setdefault(key, set()).update(extras)
    for line in distribution(name).requires or []:
        requirement = Requirement(line)
        marker = requirement.marker
        if marker is None or any(marker.evaluate({"extra": extra}) for extra in extras | {""}):
            needed_by(requirement.name, found, frozenset(requirement.extras))


def runtime_distributions() -> list[str]:
    found: dict[str, set[str]] = {}
    needed_by("latentarm", found)
    needed_by("latentarm-research", found)
    return sorted(name for name in found if not OF_CUDA.match(name))


def licence_of(name: str) -> str:
    """What a distribution says of its licence: expression, classifiers, field, or else its licence file."""
    metadata = distribution(name).metadata
    classifiers = [one for one in metadata.get_all("Classifier") or [] if one.startswith("License ::")]
    # Some put the whole text in the field; its first lines name it.
    field = "\n".join((metadata.get("License") or "").splitlines()[:2])
    said = " ".join([metadata.get("License-Expression") or "", *classifiers, field]).strip()
    if KNOWN.search(said) or REFUSED.search(said):
        return said
    files: list[PackagePath] = distribution(name).files or []
    texts = [file.read_text() for file in files if re.search(r"licen[sc]e|copying", file.name, re.IGNORECASE)]
    return " ".join(text[:400] for text in texts) or said


@pytest.mark.parametrize("name", runtime_distributions())
def test_a_runtime_dependency_has_a_permissive_licence(name):
    if name in LOOKED_INTO:
        return
    licence = licence_of(name)
    assert not REFUSED.search(licence), f"{name} is under {licence}"
    assert KNOWN.search(licence), f"{name} does not say a known licence: {licence[:200]!r}"


@pytest.mark.parametrize(
    "refused", ["GPL-3.0-only", "AGPL-3.0-or-later", "GNU General Public License v3 (GPLv3)"]
)
def test_the_check_knows_what_it_refuses(refused):
    assert REFUSED.search(refused)


@pytest.mark.parametrize(
    "allowed", ["LGPL-3.0", "GNU Lesser General Public License v3", "MIT", "BSD-3-Clause"]
)
def test_the_check_knows_what_it_allows(allowed):
    assert KNOWN.search(allowed)
    assert not REFUSED.search(allowed)
