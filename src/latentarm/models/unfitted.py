"""The error of using a model before it is fitted."""

from typing import final

from sklearn.exceptions import NotFittedError

from latentarm.errors import UserError


@final
class UnfittedError(UserError, NotFittedError):
    """A model is used before `fit`: bad input to us, and scikit-learn's own error to its tools."""
