"""Streams of randomness: one per use, so that none depends on another's draws."""

import numpy as np


def sequence(seed: int, task: str, *use: int) -> np.random.SeedSequence:
    """Where one use of a task's randomness begins; the same whatever other tasks there are."""
    return np.random.SeedSequence([seed, int.from_bytes(task.encode()), *use])


def integer(source: np.random.SeedSequence) -> int:
    """A seed for code that takes integers, with room above it for the seeds of many models."""
    return int(source.generate_state(1)[0]) >> 2


def generator(seed: int, task: str, *use: int) -> np.random.Generator:
    """A generator for one use, see `sequence`."""
    return np.random.default_rng(sequence(seed, task, *use))
