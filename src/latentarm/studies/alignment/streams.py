"""What randomness is for: each use has a stream of its own, so that none hangs on another's draws."""

from enum import IntEnum


class Stream(IntEnum):
    """The uses of randomness."""

    TRAINING = 0
    TEST = 1
    NETWORKS = 2
    STATE_NOISE = 3
    SHOWN = 4
    TEST_MOTIONS = 5
    UNLABELLED = 6
    QUESTIONS = 7
    ANSWERS = 8
    CANDIDATES = 9
    CANDIDATE_ANSWERS = 10
    ENSEMBLES = 11
