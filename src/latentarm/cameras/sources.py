"""The cameras of the command line: a name and an address each; only the name is ever shown."""

import ipaddress
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Final, Literal, final
from urllib.parse import urlsplit

from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import clean_name, same_name

MOST: Final = 4  # cameras of one page
TEST_PATTERN: Final = "testsrc"  # the address of a moving test pattern, for trying the page without a camera
_LONGEST_NAME: Final = 20
_LONGEST_ADDRESS: Final = 1000
_NETWORK: Final = ("rtsp", "rtsps")
_SCHEME: Final = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*)://")
_EXAMPLE: Final = "write --camera NAME=ADDRESS, as in --camera front=/dev/video0"

Kind = Literal["device", "network", "file", "pattern"]


@final
@dataclass(frozen=True)
class CameraSource:
    """One camera."""

    name: str
    # may hold a password: it is never shown, logged or sent, and not part of the `repr`
    address: str = field(repr=False)

    @property
    def kind(self) -> Kind:
        """The kind of address."""
        if self.address == TEST_PATTERN:
            return "pattern"
        if _SCHEME.match(self.address):
            return "network"
        return "device" if Path(self.address).is_char_device() or _in_dev(self.address) else "file"


def parse_cameras(asked: Sequence[str]) -> tuple[CameraSource, ...]:
    """The cameras of a command line, each ``NAME=ADDRESS``.

    Raises UserError if one is not of that form, two have one name, there are more than `MOST`, or the extra
    `camera` is not installed. The sentence quotes no address.
    """
    if len(asked) > MOST:
        raise UserError(f"{len(asked)} cameras are named: the page shows {MOST} at most.")
    cameras: list[CameraSource] = []
    for number, text in enumerate(asked, start=1):
        camera = _parsed(text, number)
        if any(same_name(camera.name, other.name) for other in cameras):
            raise UserError(f"Two cameras are called {camera.name}: give each its own name.")
        cameras.append(camera)
    if cameras and (find_spec("aiortc") is None or find_spec("av") is None):
        raise UserError("--camera needs the extra `camera`: pip install 'latentarm[camera]'.")
    return tuple(cameras)


def kept(asked: Sequence[str]) -> tuple[str, ...]:
    """The options that may be written to a file: no network addresses, which hold passwords."""
    return tuple(
        text for text, camera in zip(asked, parse_cameras(asked), strict=True) if camera.kind != "network"
    )


def _parsed(text: str, number: int) -> CameraSource:
    name, equals, address = text.partition("=")
    # An address without a name may hold a password before its first "=".
    if not equals or not name or not address or _SCHEME.match(name) or "/" in name:
        raise UserError(f"Camera {number} is not NAME=ADDRESS: {_EXAMPLE}.")
    try:
        name = clean_name(name, _LONGEST_NAME)
    except UserError as error:
        raise UserError(f"Camera {number}: {error}") from error
    if len(address) > _LONGEST_ADDRESS or not address.isprintable():
        raise UserError(f"The address of camera {name} is too long or holds characters that no address has.")
    _check_address(name, address)
    return CameraSource(name, address)


def _check_address(name: str, address: str) -> None:
    if address == TEST_PATTERN:
        return
    scheme = _SCHEME.match(address)
    if scheme is not None:
        if scheme[1].lower() not in _NETWORK:
            raise UserError(f"The address of camera {name} is neither a device, a video file nor rtsp://.")
        if not _has_host(address):
            raise UserError(f"The address of camera {name} names no host: write rtsp://HOST/PATH.")
        return
    if not Path(address).exists():
        what = "device" if _in_dev(address) else "file"
        raise UserError(f"Camera {name}: the {what} does not exist. Check what follows {name}=.")


def _has_host(address: str) -> bool:
    try:
        parts = urlsplit(address)
        host, _ = parts.hostname, parts.port
        return bool(host) and (":" not in host or ipaddress.ip_address(host).version == 6)
    except ValueError:
        return False


def _in_dev(address: str) -> bool:
    return Path(address).parts[:2] == ("/", "dev")
