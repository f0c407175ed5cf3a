"""Reading untrusted JSON: every read names the type and size that the value must have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.documents import read_object


@final
@dataclass(frozen=True)
class Section:
    """A JSON object in a file."""

    where: str
    values: Mapping[str, Any]

    @staticmethod
    def of_file(path: Path, limit: int) -> "Section":
        """The object of a JSON file of at most ``limit`` bytes; UserError as in `read_object`."""
        return Section(str(path), read_object(path, limit))

    def section(self, key: str) -> "Section":
        """The object under a key."""
        value = self._get(key)
        if not isinstance(value, dict):
            raise self._wrong(key, "an object with named fields")
        return Section(f"{self.where}, '{key}'", cast(dict[str, Any], value))

    def text(self, key: str) -> str:
        """The string under a key."""
        value = self._get(key)
        if not isinstance(value, str):
            raise self._wrong(key, "a text")
        return value

    def choice(self, key: str, allowed: Sequence[str]) -> str:
        """The string under a key, one of those allowed."""
        value = self.text(key)
        if value not in allowed:
            raise self._wrong(key, f"one of {', '.join(allowed)}")
        return value

    def integer(self, key: str, least: int) -> int:
        """The whole number under a key."""
        value = self._get(key)
        if not _is_integer(value, least):
            raise self._wrong(key, f"a whole number of at least {least}")
        return value

    def truth(self, key: str) -> bool:
        """True or false, as it stands under a key."""
        value = self._get(key)
        if not isinstance(value, bool):
            raise self._wrong(key, "true or false")
        return value

    def number(self, key: str) -> float:
        """The number under a key; NaN for null, which stands for a missing figure."""
        return float(self.array(key, (), gaps=True))

    def integers(
        self, key: str, least: int, *, length: int | None = None, longest: int | None = None
    ) -> list[int]:
        """The list of whole numbers under a key, of the given length or at most the given one."""
        entries = self.entries(key)
        of_length = "" if length is None else f", {length} of them"
        if not all(_is_integer(entry, least) for entry in entries) or length not in (None, len(entries)):
            raise self._wrong(key, f"a list of whole numbers of at least {least}{of_length}")
        if longest is not None and len(entries) > longest:
            raise self._wrong(key, f"a list of at most {longest} whole numbers")
        return entries

    def entries(self, key: str) -> list[Any]:
        """The list under a key."""
        value = self._get(key)
        if not isinstance(value, list):
            raise self._wrong(key, "a list")
        return cast(list[Any], value)

    def texts(self, key: str) -> list[str]:
        """The list of texts under a key."""
        entries = self.entries(key)
        if not all(isinstance(entry, str) for entry in entries):
            raise self._wrong(key, "a list of texts")
        return entries

    def array(self, key: str, shape: tuple[int | None, ...], *, gaps: bool = False) -> FloatArray:
        """The nested list of numbers under a key; None in ``shape`` allows any length.

        With ``gaps``, null stands for a missing figure and is read as NaN.
        """
        value = self._get(key)
        try:
            array = np.array(value, dtype=np.float64)
        except (ValueError, TypeError, OverflowError) as error:
            raise self._wrong(key, "a list of numbers") from error
        if array.size == 0 and shape[0] is None:
            array = array.reshape(0, *(length or 0 for length in shape[1:]))
        fits = array.ndim == len(shape) and all(
            length in (None, actual) for length, actual in zip(shape, array.shape, strict=True)
        )
        if not fits or np.isinf(array).any() or (not gaps and np.isnan(array).any()):
            raise self._wrong(
                key, f"a list of finite numbers of shape {[length or 'any' for length in shape]}"
            )
        return array

    def plain(self) -> dict[str, Any]:
        """All values as they are, for a reader that checks each itself."""
        return dict(self.values)

    def _get(self, key: str) -> Any:
        if key not in self.values:
            raise UserError(f"{self.where} has no '{key}': it was not written by latentarm, or not whole.")
        return self.values[key]

    def _wrong(self, key: str, wanted: str) -> UserError:
        return UserError(f"{self.where}: '{key}' must be {wanted}.")


def _is_integer(value: object, least: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and least <= value < 2**31
