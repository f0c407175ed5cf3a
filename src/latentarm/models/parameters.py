"""Types of parameters with their ranges, and checks against them."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Final, get_type_hints

import numpy as np
from pydantic import AfterValidator, Field, TypeAdapter, ValidationError

from latentarm.core.context import feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

LARGEST: Final = 2**31 - 1  # the largest whole-numbered parameter or seed
Count = Annotated[int, Field(ge=1, le=LARGEST)]
Seed = Annotated[int, Field(ge=0, le=LARGEST)]
Seeds = Annotated[int, Field(ge=1, le=1000)]  # models trained side by side; memory grows with them
Units = tuple[Annotated[int, Field(ge=1, le=4096)], ...]  # of each hidden layer
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Features = Annotated[str | tuple[str, ...], AfterValidator(feature_names)]  # of a context, by name


@cache
def _types(model: "type[DataclassInstance]") -> dict[str, TypeAdapter[Any]]:
    hints = get_type_hints(model, include_extras=True)
    return {one.name: TypeAdapter(hints[one.name]) for one in fields(model) if one.init}


def check_parameters(model: "type[DataclassInstance]", parameters: Mapping[str, object]) -> None:
    """Check a model's parameters against the types of its fields, also for models of plug-ins.

    Raises UserError where a value has the wrong type or lies outside its range.
    """
    types = _types(model)
    for name, value in parameters.items():
        try:
            types[name].validate_python(value, strict=True)
        except ValidationError as error:
            wanted = error.errors()[0]["msg"].replace("Input should be", "it must be")
            raise UserError(f"The model parameter {name} is {value!r}; {wanted}.") from error
        except UserError as error:
            raise UserError(f"The model parameter {name} is {value!r}: {error}") from error
    first, seeds = parameters.get("seed"), parameters.get("seeds")
    if isinstance(first, int) and isinstance(seeds, int) and first + seeds - 1 > LARGEST:
        raise UserError(f"{seeds} seeds from {first} on end beyond {LARGEST}: choose a smaller first seed.")


def check_validation(validation: Sequence[int], episodes: int) -> None:
    """Check that validation episodes exist and leave others to train on; UserError where they do not."""
    for index in validation:
        if not 0 <= index < episodes:
            raise UserError(
                f"Episode {index} is to be a validation episode, but the dataset's {episodes} end at"
                f" {episodes - 1}."
            )
    held = len(set(validation))
    if not 0 < held < episodes:
        raise UserError(
            f"{held} of {episodes} episodes are for validation: at least one must be, and one must be left to"
            " train on."
        )


def check_rows(
    name: str, values: FloatArray, columns: int, *, seeds: int = 0, rows: int | None = None
) -> None:
    """Check an array of shape (N, columns), or (seeds, N, columns) where ``seeds`` is given.

    ``rows`` is N where another array fixes it. Raises UserError where the shape is wrong or a value is not
    finite.
    """
    stacked = values.ndim == 3 and seeds > 0 and values.shape[0] == seeds
    fits = (values.ndim == 2 or stacked) and values.shape[-1] == columns and rows in (None, values.shape[-2])
    if not fits:
        wanted = f"({'N' if rows is None else rows}, {columns})"
        stack = f" or ({seeds}, {'N' if rows is None else rows}, {columns})" if seeds else ""
        raise UserError(f"{name} has shape {values.shape}; this model wants {wanted}{stack}.")
    if not np.isfinite(values).all():
        place = [int(index) for index in np.argwhere(~np.isfinite(values))[0]]
        raise UserError(f"{name} holds a NaN or an infinity at {place}.")
