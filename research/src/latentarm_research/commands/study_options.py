"""Options of the commands that run studies."""

from dataclasses import dataclass
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.runs.options import Jobs, Json, Seed

Backend = Annotated[
    Literal["joblib", "ray", "dask"],
    arg(
        help="Processes of this machine, or a cluster: that of RAY_ADDRESS or DASK_SCHEDULER_ADDRESS,"
        " or else a new one here."
    ),
]


@dataclass(frozen=True)
class StudyOptions:
    """Options of every study."""

    seed: Seed = 0
    jobs: Jobs = -1
    backend: Backend = "joblib"
    json: Json = False
