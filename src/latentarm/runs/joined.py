"""Datasets that are trained on together, kept as one in the run's folder."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import is_missing
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.joining import join
from latentarm.demonstrations.timing import check_one_rate
from latentarm.runs.folder import fingerprint

JOINED: Final = "demonstrations"
"""Folder of a run that holds the datasets that it was trained on, where these were several."""


def joined_dataset(datasets: Sequence[Path], run: Path) -> Path:
    """The one dataset to train on: the one that is named, or all that are named as one in the run's folder.

    Args:
        datasets: folders.
        run: the run's folder.

    Raises:
        UserError: none is named, they do not fit each other, or the run's folder holds other ones.
    """
    if not datasets:
        raise UserError("No dataset is named: say which with --demonstrations.")
    if len(datasets) == 1:
        return datasets[0]
    joined = join({str(one): read_dataset(one) for one in datasets})
    check_one_rate(joined, [str(index) for index in range(len(joined.episodes))], str(run / JOINED))
    # A training that was broken off has written it already.
    if is_missing(run / JOINED) or fingerprint(read_dataset(run / JOINED)) != fingerprint(joined):
        write_dataset(joined, run / JOINED)
    return run / JOINED
