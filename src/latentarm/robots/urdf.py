"""Finds a URDF's meshes and reads its velocity limits, which MuJoCo does not do."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import final
from xml.etree import ElementTree as Xml

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import check_file
from latentarm.robots.model_xml import MOST_FILE_BYTES

MESH_FORMATS = (".stl", ".obj", ".msh")  # mesh files that MuJoCo reads


@final
@dataclass(frozen=True)
class Urdf:
    """A URDF prepared for MuJoCo."""

    text: str  # without visual geometry, its collision meshes as absolute paths
    # limits by joint, rad/s (m/s where prismatic); without zeros, which exporters write for unknown ones
    velocity: dict[str, float]
    mesh_bytes: int  # of all collision meshes, on disk


def prepare_urdf(path: Path, root: Xml.Element) -> Urdf:
    """Resolve the meshes of a URDF, read its velocity limits and change its parsed <robot> element."""
    if any(element.tag.startswith("xacro:") for element in root.iter()):
        raise UserError(f"{path} is a xacro file: expand it first, with `xacro {path.name} > robot.urdf`.")
    names = [joint.get("name") for joint in root.findall("joint")]
    for name in names:
        if names.count(name) > 1:  # MuJoCo would silently name the second one itself
            raise UserError(f"{path} has two joints named {name!r}: give each a name of its own.")
    mesh_bytes = 0
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
        for mesh in link.iterfind("collision/geometry/mesh"):
            file = _mesh_file(path, str(link.get("name")), mesh.get("filename", ""))
            mesh.set("filename", str(file))
            mesh_bytes += file.stat().st_size
    # MuJoCo would merge links that have no joint, and with them the end-effector's name.
    for element in root.findall("mujoco"):
        root.remove(element)
    text = Xml.tostring(root, encoding="unicode")
    return Urdf(text=text, velocity=dict(_velocities(path, root)), mesh_bytes=mesh_bytes)


def _velocities(path: Path, root: Xml.Element) -> Iterator[tuple[str, float]]:
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        text = "0" if limit is None else limit.get("velocity", "0")
        try:
            velocity = float(text)
        except ValueError as error:
            raise UserError(
                f"{path}: the velocity limit of joint {joint.get('name')} is {text!r}, not a number."
            ) from error
        if velocity != 0.0:
            yield str(joint.get("name")), velocity


def _mesh_file(path: Path, link: str, filename: str) -> Path:
    """Path of a link's mesh from a plain, a file:// or a package:// name."""
    named = next((found for found in _places(path, filename) if found.is_file()), None)
    if named is None:
        raise UserError(
            f"{path}: the collision mesh {filename!r} of link {link} does not exist: put the robot's mesh"
            " files where the URDF names them."
        )
    if named.suffix.lower() not in MESH_FORMATS:
        raise UserError(
            f"{path}: the collision mesh {filename!r} of link {link} is in a format that cannot be read:"
            f" convert it to one of {', '.join(MESH_FORMATS)}."
        )
    check_file(named, MOST_FILE_BYTES)
    return named


def _places(path: Path, filename: str) -> Iterator[Path]:
    folder = path.resolve().parent
    if filename.startswith("package://"):
        package, _, rest = filename.removeprefix("package://").partition("/")
        for above in (folder, *folder.parents):
            # The package's own folder, or a workspace that holds it, somewhere above the file.
            if above.name == package:
                yield above / rest
            yield above / package / rest
    else:
        yield folder / filename.removeprefix("file://")
