"""The two files of the source: cameras as calibrated, and the tags on things.

A tags file is written by hand::

    cameras = "cameras.toml"  # beside this file; `latentarm calibrate` writes it
    family = "apriltag_36h11"

    [[tags]]
    id = 3
    thing = "bowl"  # as the task names it
    size_m = 0.04  # side of the black square
    position_m = [0.09, 0.09, 0.0]  # of the tag's middle in the thing's frame
    quaternion_wxyz = [1, 0, 0, 0]  # tag's x right, y up, z out of it, as one reads it
"""

import json
from pathlib import Path
from typing import Annotated, Any, Final, Self, TypeVar, final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator
from scipy.spatial.transform import Rotation

from latentarm.cameras.sources import MOST, CameraSource, parse_cameras
from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.hand_written import MOST_BYTES, parse_toml
from latentarm.core.untrusted.opening import read_bytes
from latentarm.surroundings.contract import FARTHEST_M, MOST_HOLD_S
from latentarm.surroundings.tags.detecting import FAMILIES
from latentarm.surroundings.tags.frames import frame
from latentarm.surroundings.tags.hand_eye import HandEye, Mount
from latentarm.surroundings.tags.lens import Lens

MOST_TAGS: Final = 200
Number = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(ge=-FARTHEST_M, le=FARTHEST_M)]
Positive = Annotated[float, Field(gt=0.0, le=1e5)]


Read = TypeVar("Read", bound=BaseModel)


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Placed(_Entry):
    position_m: tuple[Length, Length, Length] = (0.0, 0.0, 0.0)
    quaternion_wxyz: tuple[Number, Number, Number, Number] = (1.0, 0.0, 0.0, 0.0)

    @property
    def pose(self) -> FloatArray:
        """(4, 4), m."""
        turn = Rotation.from_quat(self.quaternion_wxyz, scalar_first=True).as_matrix()
        return frame(turn, np.array(self.position_m))

    @field_validator("quaternion_wxyz")
    @classmethod
    def _turns(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if not 0.99 < np.linalg.norm(value) < 1.01:
            raise ValueError("must have length 1")
        return value


@final
class CameraEntry(_Placed):
    """A camera; the pose is in the frame of what it is fixed to."""

    address: Annotated[str, Field(repr=False)]  # as in ``--camera``
    size_px: tuple[Annotated[int, Field(ge=16, le=8192)], Annotated[int, Field(ge=16, le=8192)]]
    focal_px: tuple[Positive, Positive]
    centre_px: tuple[Positive, Positive]
    distortion: tuple[Number, Number, Number, Number, Number]
    mount: Mount | None = None  # None until it is known where the camera is
    position_sd_m: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    orientation_sd_rad: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0

    @property
    def lens(self) -> Lens:
        """Its optics."""
        matrix = np.diag([*self.focal_px, 1.0])
        matrix[:2, 2] = self.centre_px
        return Lens(self.size_px, matrix, np.array(self.distortion))

    def source(self, name: str) -> CameraSource:
        """The source of its pictures."""
        return parse_cameras([f"{name}={self.address}"])[0]

    @classmethod
    def of_lens(cls, address: str, lens: Lens) -> Self:
        """A camera of which it is not known yet where it is."""
        matrix = lens.matrix
        return cls(
            address=address,
            size_px=lens.size_px,
            focal_px=(matrix[0, 0], matrix[1, 1]),
            centre_px=(matrix[0, 2], matrix[1, 2]),
            distortion=tuple(lens.distortion[:5]),
        )

    def at(self, found: HandEye, mount: Mount) -> Self:
        """The camera where it was found to be."""
        turn = Rotation.from_matrix(found.camera[:3, :3]).as_quat(scalar_first=True)
        return self.model_copy(
            update={
                "mount": mount,
                "position_m": tuple(found.camera[:3, 3].tolist()),
                "quaternion_wxyz": tuple(turn.tolist()),
                "position_sd_m": found.position_sd_m,
                "orientation_sd_rad": found.orientation_sd_rad,
            }
        )


@final
class TagEntry(_Placed):
    """A tag; the pose is in the frame of its thing."""

    id: Annotated[int, Field(ge=0)]
    thing: Annotated[str, Field(min_length=1, max_length=100)]
    size_m: Annotated[float, Field(gt=0.001, lt=1.0)]
    most_tilt_deg: Annotated[float, Field(gt=0.0, le=180.0)] = 180.0  # by which the thing's z can lean


@final
class TagsFile(_Entry):
    """A tags file."""

    cameras: Annotated[str, Field(min_length=1)]
    family: str
    hold_s: Annotated[float, Field(gt=0.0, le=MOST_HOLD_S)] = 2.0  # how long a sighting counts
    tags: Annotated[tuple[TagEntry, ...], Field(min_length=1, max_length=MOST_TAGS)]

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.family not in FAMILIES:
            raise ValueError(f"the family must be one of {', '.join(FAMILIES)}")
        numbers = [tag.id for tag in self.tags]
        twice = sorted({number for number in numbers if numbers.count(number) > 1})
        if twice:
            raise ValueError(f"the tag {twice[0]} is there twice")
        return self


class _CamerasFile(_Entry):
    cameras: Annotated[dict[str, CameraEntry], Field(min_length=1, max_length=MOST)]


def read_tags(path: Path) -> TagsFile:
    """Read a tags file."""
    return _checked(TagsFile, path, "tags file")


def read_cameras(path: Path) -> dict[str, CameraEntry]:
    """Read a cameras file: its cameras by name."""
    return _checked(_CamerasFile, path, "cameras file").cameras


def write_cameras(path: Path, cameras: dict[str, CameraEntry]) -> None:
    """Write a cameras file."""
    lines = ["# Written by `latentarm calibrate`. Poses are of the camera (x right, y down, z ahead)."]
    for name, entry in cameras.items():
        lines += ["", f"[cameras.{json.dumps(name)}]"]
        stated: dict[str, Any] = entry.model_dump(mode="json", exclude_none=True)
        lines += [f"{key} = {json.dumps(value)}" for key, value in stated.items()]
    write_text(path, "\n".join(lines) + "\n")


def _checked(kind: type[Read], path: Path, what: str) -> Read:
    try:
        return kind.model_validate(parse_toml(read_bytes(path, MOST_BYTES), path, what))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(one) for one in first["loc"]) or what
        said = str(first["msg"]).removeprefix("Value error, ")
        raise UserError(f"{path}: {where}: {said[:1].lower()}{said[1:]}.") from error
