from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session", autouse=True)
def no_browser() -> Iterator[None]:
    """Studies print no PDF: a browser takes seconds for each."""
    from latentarm_research.studies import page as printing

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(printing, "find_browser", lambda: None)
        yield
