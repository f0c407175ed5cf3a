"""What the comparison draws at random."""

from enum import IntEnum


class Stream(IntEnum):
    """What randomness is for: each use has a stream of its own, the same for every model and noise."""

    FOLDS = 0
    NETWORKS = 1
    TRAINING_NOISE = 2
    TEST_NOISE = 3
    DRIVES = 4
