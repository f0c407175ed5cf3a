"""The address and port on which a page is served."""

import ipaddress
import re
import socket
import ssl
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.cameras.sources import CameraSource
from latentarm.core.errors import UserError
from latentarm.web.arm_process.drive_setup import Spec

_BACKLOG: Final = 2048

_OWN_PORTS: Final = {"http": ":80", "https": ":443"}
_ORIGIN: Final = re.compile(r"https?://([\w.-]+|\[[0-9a-fA-F:]+\])(:[0-9]{1,5})?")


@final
@dataclass(frozen=True)
class TeleopConfig:
    """The options of `latentarm teleop`, see its ``--help``.

    Raises UserError if the address cannot be one that people open, or only one file for TLS is named.
    """

    spec: Spec
    host: str = "127.0.0.1"  # the address that people open: a name or a number
    port: int = 8460  # 0 takes any free one
    certfile: Path | None = None  # for TLS, PEM
    keyfile: Path | None = None  # its private key, PEM
    pins: bool = False
    cameras: tuple[CameraSource, ...] = ()
    lock_setup: bool = False
    public_url: str | None = None  # the page's origin where a proxy serves it, such as https://arm.example

    def __post_init__(self) -> None:
        if not 0 <= self.port <= 65535:
            raise UserError(f"The port is {self.port}: it must be from 0 to 65535.")
        if (self.certfile is None) != (self.keyfile is None):
            raise UserError("TLS needs a certificate and its key: name both --certfile and --keyfile.")
        if _is_anywhere(self.host):
            raise UserError(
                f"The page must know the address that people open, and {self.host} is not one: name this"
                " machine's own address or name with --host."
            )
        if self.public_url is not None and not _ORIGIN.fullmatch(self.public_url):
            raise UserError(
                f"--public-url {self.public_url} is not an address such as https://arm.example or"
                " https://arm.example:8443, without a path."
            )

    @property
    def encrypted(self) -> bool:
        """Whether people reach the page over TLS alone."""
        return self.certfile is not None if self.public_url is None else self.public_url.startswith("https:")

    @property
    def private(self) -> bool:
        """Whether only this machine can reach the page."""
        return self.public_url is None and self._loopback

    def origins(self, port: int) -> list[str]:
        """The page's web origins, the first of them for links; ``port`` is the one that is listened on."""
        if self.public_url is not None:
            return [_without_own_port(self.public_url.lower())]
        names = [self.host, "127.0.0.1", "localhost"] if self._loopback else [self.host]
        scheme = "http" if self.certfile is None else "https"
        found = [f"{scheme}://{f'[{name}]' if ':' in name else name.lower()}:{port}" for name in names]
        return [_without_own_port(one) for one in dict.fromkeys(found)]

    @property
    def _loopback(self) -> bool:
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


def listen(config: TeleopConfig) -> socket.socket:
    """Open a listening socket. Raises UserError if the address is taken, or is not this machine's."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            config.host, config.port, type=socket.SOCK_STREAM
        )[0]
        listening = socket.socket(family, kind, protocol)
    except OSError as error:
        reason = error.strerror or error
        raise UserError(f"{config.host} is not an address of this machine: {reason}.") from error
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(_BACKLOG)
    except OSError as error:
        listening.close()
        raise UserError(
            f"{config.host} port {config.port} cannot be used ({error.strerror or error}): choose another"
            " with --host or --port."
        ) from error
    return listening


def check_certificate(config: TeleopConfig) -> None:
    """Check that the certificate and its key can be used. Raises UserError if they cannot."""
    if config.certfile is None or config.keyfile is None:
        return
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(config.certfile, config.keyfile)
    except (OSError, ssl.SSLError) as error:
        raise UserError(
            f"{config.certfile} and {config.keyfile} are not a certificate and key for TLS"
            f" ({error.strerror or error})."
        ) from error


def _without_own_port(origin: str) -> str:
    """As browsers write it: without the port that is the scheme's own."""
    scheme = origin.partition(":")[0]
    return origin.removesuffix(_OWN_PORTS[scheme])


def _is_anywhere(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_unspecified
    except ValueError:
        return host == ""
