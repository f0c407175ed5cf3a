"""A copy of a robot's model: its XML, and every file that the XML names."""

from pathlib import Path
from typing import Final
from xml.etree import ElementTree as Xml

from latentarm.core.errors import UserError
from latentarm.core.files import write_text, written_whole
from latentarm.core.untrusted.opening import read_bytes
from latentarm.robots.model_file import load_model_file
from latentarm.robots.model_xml import (
    FILE_ATTRIBUTES,
    FOLDERS,
    MOST_FILE_BYTES,
    NESTED,
    parse_xml,
    read_model_xml,
    read_xml,
)
from latentarm.robots.robot import Robot
from latentarm.robots.urdf import prepare_urdf

MOST_COPIED: Final = 64 << 20  # bytes of all the files of a copy
COPIES: Final = ("model.xml", "model.urdf")  # names of a copy: MJCF or URDF


def copy_model(robot: Robot, folder: Path) -> str:
    """Copy a model file with its meshes and textures, and return the copy's name, one of `COPIES`.

    An MJCF is copied as MuJoCo writes it, includes resolved; a URDF with its links and joints alone, without
    visual geometry.
    """
    source = Path(str(robot.model_path))
    root, _ = read_model_xml(source)
    if root.tag == "robot":
        prepare_urdf(source, root)
        for element in list(root):
            if element.tag not in ("link", "joint"):
                root.remove(element)
        name, places = COPIES[1], [source.parent]
    else:
        root = parse_xml(source, robot.mjcf.encode())
        compilers = list(root.iter("compiler"))
        places = [Path(one.attrib.pop(key)) for one in compilers for key in FOLDERS if key in one.attrib]
        name = COPIES[0]
    copied: dict[Path, str] = {}
    size = 0
    for element in root.iter():
        for key in FILE_ATTRIBUTES & element.attrib.keys():
            named = [place / element.attrib[key] for place in places]
            file = next((one for one in named if one.is_file()), named[0])
            if file not in copied:
                content = read_bytes(file, MOST_FILE_BYTES)
                size += len(content)
                if size > MOST_COPIED:
                    raise UserError(f"The meshes of {source} have more than {MOST_COPIED >> 20} MiB.")
                copied[file] = f"{len(copied)}-{file.name}"
                with written_whole(folder / copied[file]) as part:
                    part.write_bytes(content)
            element.set(key, copied[file])
    write_text(folder / name, Xml.tostring(root, encoding="unicode"))
    return name


def load_copy(path: Path, end_effector: str | None) -> Robot:
    """Load a robot from a copy that `copy_model` made, and open no file outside the copy's folder."""
    _check_inside(path, path.name)
    root, _ = read_xml(path)
    for element in root.iter():
        if element.attrib.keys() & set(FOLDERS) or (element.tag in NESTED and "file" in element.attrib):
            raise UserError(f"{path} names other models or folders, which a copy does not: train again.")
        for key in FILE_ATTRIBUTES & element.attrib.keys():
            _check_inside(path, element.attrib[key])
    return load_model_file(path, end_effector)


def _check_inside(path: Path, name: str) -> None:
    """Refuse a file outside the copy's folder, also one behind a link."""
    folder = path.parent.parent.resolve() / path.parent.name
    if (path.parent / name).resolve().parent != folder:
        raise UserError(f"{path} names {name!r}, which does not lie beside it: train the model again.")
