"""Robot models as XML that this program may not have written: bounded before MuJoCo parses them in C.

MuJoCo opens any path in a model, waits for a named pipe, repeats an element without limit, and crashes on a
model that attaches itself. `latentarm.core.untrusted.memory` bounds its memory.
"""

from collections.abc import Iterator, Mapping
from math import prod
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as Xml
from xml.parsers import expat

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import check_file, is_missing, read_bytes

MOST_XML_BYTES: Final = 20_000_000  # of one XML file without meshes
MOST_FILE_BYTES: Final = 1 << 28  # of a mesh, a picture or a height field
MOST_FILES: Final = 1000  # in a model
MOST_ELEMENTS: Final = 20_000  # in one file, and copies of one element
MOST_LEVELS: Final = 100  # as in MuJoCo's own parser
NESTED: Final = frozenset({"include", "model"})  # elements that name another model's file
FILE_ATTRIBUTES: Final = frozenset(
    {"file", "filename", "fileup", "filedown", "fileleft", "fileright", "filefront", "fileback"}
)
_COUNTS: Final = frozenset({"count", "nkey", "nuserdata", "njmax", "nconmax", "nstack"})
FOLDERS: Final = ("meshdir", "texturedir", "assetdir")


def read_model_xml(path: Path) -> tuple[Xml.Element, int]:
    """Read a URDF or MJCF file, and check every file that an MJCF names.

    Returns the outermost element, and the bytes of all these files.
    """
    root, size = read_xml(path)
    if root.tag == "mujoco":
        for found, file in enumerate(_named(path, root, (path.resolve(),))):
            if found >= MOST_FILES:
                raise UserError(f"{path} names more than {MOST_FILES:,} files.")
            size += file.stat().st_size
    return root, size


def read_xml(path: Path) -> tuple[Xml.Element, int]:
    """The outermost element of an XML file, and the file's bytes; does not open files that it names."""
    text = read_bytes(path, MOST_XML_BYTES)
    root = parse_xml(path, text)
    _check_copies(path, root)
    return root, len(text)


def parse_xml(path: Path, text: bytes) -> Xml.Element:
    """The outermost element of an XML document; like MuJoCo, it accepts undeclared prefixes."""

    def refuse(*_: object) -> None:
        # Without declarations nothing can expand or be fetched from elsewhere.
        raise UserError(f"{path} declares a document type, which no robot model needs: remove that line.")

    builder = Xml.TreeBuilder()
    depth = elements = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, elements
        depth += 1
        elements += 1
        if depth > MOST_LEVELS or elements > MOST_ELEMENTS:
            raise UserError(
                f"{path} has more than {MOST_ELEMENTS:,} elements, or more than {MOST_LEVELS} in each other."
            )
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError) as error:
        raise UserError(f"{path} is not valid XML: {error}.") from error
    return builder.close()


def _check_copies(path: Path, root: Xml.Element) -> None:
    """Bound the copies that elements such as <replicate> and <flexcomp> make of themselves."""
    waiting = [(root, 1)]
    while waiting:
        element, copies = waiting.pop()
        for name in _COUNTS & element.attrib.keys():
            try:
                asked = prod(max(int(float(number)), 1) for number in element.attrib[name].split())
            except (ValueError, OverflowError):
                asked = 1  # MuJoCo says what is wrong with it
            if element.tag == "replicate":
                copies *= asked
            if max(asked, copies) > MOST_ELEMENTS:
                raise UserError(
                    f"{path}: <{element.tag}> asks for more than {MOST_ELEMENTS:,} copies or entries."
                )
        waiting.extend((child, copies) for child in element)


def _named(path: Path, root: Xml.Element, above: tuple[Path, ...]) -> Iterator[Path]:
    """Files that an MJCF names, with repetitions, and those of the files that it includes."""
    folders = {above[0].parent}
    for compiler in root.iter("compiler"):
        folders |= {above[0].parent / compiler.attrib[key] for key in FOLDERS if key in compiler.attrib}
    for element in root.iter():
        for file in _places(element.attrib, folders):
            if element.tag not in NESTED:
                check_file(file, MOST_FILE_BYTES)
                yield file
                continue
            if file.resolve() in above or len(above) > MOST_LEVELS // 10:
                raise UserError(f"{path} contains itself by way of {file}, or too many files in each other.")
            inner, _ = read_xml(file)
            yield file
            yield from _named(file, inner, (*above, file.resolve()))


def _places(attributes: Mapping[str, str], folders: set[Path]) -> Iterator[Path]:
    """Every place where MuJoCo may look for an element's files; MuJoCo reports missing ones."""
    for key in FILE_ATTRIBUTES & attributes.keys():
        name = attributes[key].strip()
        yield from (place for folder in folders if name and not is_missing(place := folder / name))
