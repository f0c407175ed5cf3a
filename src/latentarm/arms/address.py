"""Addresses of real arms: ``SCHEME://HOST[:PORT][?option=value&...]``."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final
from urllib.parse import parse_qsl, urlsplit

from latentarm.core.errors import UserError

MARK: Final = "://"  # marks the address of a real arm


@final
@dataclass(frozen=True)
class ArmAddress:
    """The address of a real arm."""

    scheme: str  # a driver's name in `latentarm.arms.catalogue.REAL_ARMS`
    host: str  # a host name, an IP address, or a path for some drivers
    port: int | None  # None for the driver's default
    options: Mapping[str, str]  # of the driver

    def only(self, *names: str) -> Mapping[str, str]:
        """The options, if the driver knows all of them by these names."""
        unknown = sorted(set(self.options) - set(names))
        if unknown:
            known = ", ".join(names) or "no options"
            raise UserError(f"--arm {self.scheme} does not know the option {unknown[0]}: it takes {known}.")
        return self.options


def is_address(name: str) -> bool:
    """Whether ``--arm`` names a real arm."""
    return MARK in name


def parse_address(text: str) -> ArmAddress:
    """Parse an address."""
    scheme, _, rest = text.partition(MARK)
    try:
        parts = urlsplit(f"//{rest}")  # in urllib a scheme has no underscore, as the name of a driver may
        host, port = parts.hostname or parts.path, parts.port
        options = parse_qsl(parts.query, keep_blank_values=True, strict_parsing=bool(parts.query))
    except ValueError as error:
        raise UserError(f"--arm {text} is not an address ({error}): write SCHEME://HOST:PORT.") from error
    if not scheme or not host or parts.username is not None or parts.fragment:
        raise UserError(f"--arm {text} is not an address: write SCHEME://HOST, such as franka://172.16.0.2.")
    if len(dict(options)) < len(options):
        raise UserError(f"--arm {text} gives an option twice.")
    return ArmAddress(scheme.lower(), host, port, dict(options))
