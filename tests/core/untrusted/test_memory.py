"""A file that unpacks to far more than it holds is refused before the machine notices."""

import resource
import sys
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.untrusted.memory import ALLOWANCE, bounded_memory

linux = pytest.mark.skipif(
    not Path("/proc/self/status").exists() or sys.platform != "linux", reason="only Linux bounds a process"
)


@linux
def test_an_allocation_beyond_the_bound_is_one_sentence() -> None:
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with (
        pytest.raises(UserError, match="the file takes more than 256 MiB of memory"),
        bounded_memory("the file", 100),
    ):
        # Far beyond the bound: what other tests left behind may be freed meanwhile, and counts in its favour.
        np.empty(8 * ALLOWANCE, dtype=np.uint8)
    assert resource.getrlimit(resource.RLIMIT_DATA) == before


@linux
def test_the_least_bound_holds_and_each_is_lifted() -> None:
    before = resource.getrlimit(resource.RLIMIT_DATA)
    outer = bounded_memory("outer", 0)
    outer.__enter__()
    least = resource.getrlimit(resource.RLIMIT_DATA)
    with bounded_memory("inner", 1 << 30):
        assert resource.getrlimit(resource.RLIMIT_DATA) == least
    assert resource.getrlimit(resource.RLIMIT_DATA) == least
    outer.__exit__(None, None, None)
    assert resource.getrlimit(resource.RLIMIT_DATA) == before


def test_a_failed_allocation_is_one_sentence_everywhere() -> None:
    with pytest.raises(UserError, match="out of proportion to its 3 bytes"), bounded_memory("the file", 3):
        raise MemoryError
