import gc
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from matplotlib.figure import Figure

from canary import Canary
from figure_faults import faults

pytest_plugins = ("command_line",)

# On a busy machine a single example, or making one, may take long without anything being wrong. Fifty
# examples hit the laws well. `make test` draws the same ones everywhere: Hypothesis seeds each test with a
# digest of its source, and reads no database of failures. `make test-thorough` draws at random, thousands for
# motion and geometry; whatever it finds is kept as an `@example`.
SLOW = (HealthCheck.too_slow,)
settings.register_profile(
    "latentarm", max_examples=50, deadline=None, suppress_health_check=SLOW, derandomize=True
)
settings.register_profile(
    "random", max_examples=50, deadline=None, suppress_health_check=SLOW, print_blob=True
)
settings.register_profile("thorough", settings.get_profile("random"), max_examples=10_000)
settings.load_profile("latentarm")

LONGEST_FIRST = ("plugins", "studies", "models", "core", "cli", "docs", "drives", "control", "safety")
"""Folders whose files take longest: a worker that begins one last would keep the others waiting."""

REAL_TIME = ("arms", "web")
"""Folders whose tests may be marked ``clock``: they run afterwards, two at a time."""


RUNS = 4
"""A test in real time is run so many times at most, as long as it fails and the computer kept it waiting."""

CANARY = pytest.StashKey[Canary]()


@pytest.hookimpl(trylast=True)  # after the folders' own, which mark tests as `clock`
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    again = pytest.mark.flaky(reruns=RUNS - 1, condition=lambda: config.stash[CANARY].was_late())
    for item in items:
        if item.get_closest_marker("clock"):
            item.add_marker(again)
        if item.get_closest_marker("clock") and _folder(item) not in REAL_TIME:
            raise pytest.UsageError(
                f"{item.nodeid}: make test looks for `clock` only in tests/{' and tests/'.join(REAL_TIME)}."
            )
    rank = {name: index for index, name in enumerate(LONGEST_FIRST)}
    items.sort(key=lambda item: rank.get(_folder(item), len(rank)))


def _folder(item: pytest.Item) -> str:
    """The folder of a test within its distribution's tests."""
    return item.path.parts[item.path.parts.index("tests") + 1]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("clock"):
        stash = item.config.stash
        if CANARY not in stash:
            stash[CANARY] = Canary()
        stash[CANARY].begin()


def pytest_unconfigure(config: pytest.Config) -> None:
    if CANARY in config.stash:
        config.stash[CANARY].end()


def pytest_collection_finish() -> None:
    # Thousands of tests and every library stay until the end: no later collection need look through them.
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True, scope="session")
def well_drawn() -> Iterator[None]:
    """No test saves a figure with one of the faults that `figure_faults` looks for."""

    def save_and_look(figure: Figure, *where: object, **how: object) -> None:
        # Saved in the figure's own resolution, it is laid out once for both.
        save(figure, *where, **{**how, "dpi": figure.dpi})
        assert faults(figure, drawn=True) == []

    save = Figure.savefig
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", save_and_look)
        yield


@pytest.fixture(autouse=True, scope="session")
def drawn_alike() -> Iterator[None]:
    """Fixed seeds draw the same examples whatever ran before.

    Hypothesis also tries constants of our modules, of those that happen to be loaded. Random draws keep them.
    """
    with pytest.MonkeyPatch.context() as patch:
        if settings().derandomize:
            patch.setattr(providers, "_get_local_constants", providers.Constants, raising=False)
        yield


@pytest.fixture(autouse=True, scope="session")
def one_process() -> Iterator[None]:
    """One core for grids, so that ``--jobs -1`` starts no process: that takes seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LOKY_MAX_CPU_COUNT", "1")
        yield


@pytest.fixture
def double_precision(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Networks train in double precision.

    Some processors add in another order where matrices are stacked. In single precision that parts two
    trainings of one seed by up to 1e-3 after two epochs, in double precision by less than 1e-11.
    """
    import torch

    monkeypatch.setattr(torch.Tensor, "float", torch.Tensor.double)
    torch.set_default_dtype(torch.float64)
    yield
    torch.set_default_dtype(torch.float32)
