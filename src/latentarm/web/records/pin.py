"""The PIN of a person's record: only a salted hash is kept."""

import hashlib
import hmac
import secrets
from typing import Annotated, Final

from pydantic import Field

from latentarm.web.protocol.notice import Message

PIN: Final = r"^[0-9]{4,8}$"

_N, _R, _P = 2**14, 8, 1  # cost of a guess: 16 MiB and some 50 ms


class PinHash(Message):
    """The salt and scrypt's hash, in hexadecimal digits."""

    salt: Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
    hash: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


def hash_of(pin: str) -> PinHash:
    """The hash of a PIN with a new salt."""
    salt = secrets.token_bytes(16)
    return PinHash(salt=salt.hex(), hash=_scrypt(pin, salt).hex())


def fits(pin: str, kept: PinHash) -> bool:
    """Whether this is the PIN, in constant time."""
    return hmac.compare_digest(_scrypt(pin, bytes.fromhex(kept.salt)), bytes.fromhex(kept.hash))


def _scrypt(pin: str, salt: bytes) -> bytes:
    return hashlib.scrypt(pin.encode(), salt=salt, n=_N, r=_R, p=_P, dklen=32)
