"""Options of the commands that make and measure runs, each declared once: for Python and the command line."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from tyro.conf import Positional, arg

from latentarm.assistance.catalogue import BELIEFS
from latentarm.core.context import FeatureName
from latentarm.models.catalogue import DEFAULT_MODEL, KINDS
from latentarm.runs.checks import check_seed
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS, TASKS

# The choices are the names in a catalogue, plug-ins included.
if TYPE_CHECKING:
    BeliefName = str
    ModelName = str
    TaskName = str
else:
    BeliefName = Literal[tuple(BELIEFS)]
    ModelName = Literal[tuple(KINDS)]
    TaskName = Literal[(*TASKS, *SCENE_TASKS, HELD_OUT)]

Json = Annotated[bool, arg(help="Print one JSON document on standard output and nothing else there.")]
Seed = Annotated[int, arg(help="Seed of all randomness.")]
Jobs = Annotated[int, arg(help="Processes that measure side by side; -1 is one per core.")]
EndEffector = Annotated[
    str | None, arg(help="Site, body or link of the model file that is the end-effector.", metavar="NAME")
]
MovedDataset = Annotated[
    Path | None, arg(metavar="DST", help="Where the run's dataset is now, if it was moved and is needed.")
]


@dataclass(frozen=True)
class TrainOptions:
    """Options of `latentarm train`; those named like a parameter of the model are that parameter.

    Raises UserError where the seed is out of its range.
    """

    demonstrations: Annotated[
        tuple[Path, ...],
        arg(
            metavar="DST ...",
            help="Folders of native datasets; several of one robot are joined in the run's folder.",
        ),
    ]
    model: Annotated[ModelName, arg(help="The latent action model.")] = DEFAULT_MODEL
    latent_dim: Annotated[int, arg(help="d, the number of axes of the person's interface.")] = 2
    context: Annotated[
        tuple[FeatureName | Literal["state", "state_belief"], ...] | None,
        arg(
            metavar="FEATURE ...",
            help="What the decoder sees, in order, the joints first: joints, belief, gripper, objects,"
            " objects_in_tool. state and state_belief stand for joints and joints belief. By default joints,"
            " and objects_in_tool too where every episode says where things are and they were moved.",
        ),
    ] = None
    seeds: Annotated[int, arg(help="Models trained side by side, from different seeds.")] = 5
    seed: Seed = 0
    window: Annotated[int, arg(help="An action leads to a state at most this many samples away.")] = 5
    state_noise_rad: Annotated[float, arg(help="SD of noise on the state that the decoder sees, rad.")] = 0.01
    held_out: Annotated[float, arg(help="Share of the episodes kept for evaluation.")] = 0.2
    epochs: Annotated[
        int | None, arg(help="At most this many passes over the pairs; the model's own number by default.")
    ] = None
    hidden: Annotated[
        tuple[int, ...] | None,
        arg(
            metavar="UNITS ...", help="Units of each hidden layer, such as 30 30; the model's own by default."
        ),
    ] = None
    batch_size: Annotated[
        int | None, arg(help="Pairs per step, at most; the model's own number by default.")
    ] = None
    kl_weight: Annotated[
        float | None, arg(help="lambda of equations 7 and 8, for vae and cvae; below 1.")
    ] = None
    goal_entropy: Annotated[
        float,
        arg(
            help="lambda_2 of equation 16: how much it counts that every goal stays open, with the context"
            " joints belief; 0 leaves it out, 5 lets people change their mind."
        ),
    ] = 0.0
    way_back_m: Annotated[
        float | None,
        arg(
            help="L, a way back to what was demonstrated: from this far off, a full push also leads back at"
            " the demonstrations' speed, m; 0 for none. By default 0.06 for the models that finish more with"
            " it, where the arm's model is known."
        ),
    ] = None
    device: Annotated[Literal["cpu", "cuda", "auto"], arg(help="Where to train.")] = "cpu"
    end_effector: EndEffector = None
    task: Annotated[
        TaskName | None, arg(help="What the run is driven at later; by the goals of the dataset by default.")
    ] = None
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder of the run; runs/<dataset>-<model> by default.")
    ] = None
    resume: Annotated[bool, arg(help="Continue an interrupted training.")] = False
    json: Json = False

    def __post_init__(self) -> None:
        check_seed(self.seed)

    @property
    def folder(self) -> Path:
        """The run's folder."""
        names = "-".join(one.resolve().name for one in self.demonstrations)
        return self.out or Path("runs") / f"{names}-{self.model}"

    @property
    def bars(self) -> bool:
        """Whether to show on standard error how many epochs are done."""
        return not self.json and sys.stderr.isatty()


@dataclass(frozen=True)
class EvaluateOptions:
    """Options of `latentarm evaluate`.

    Raises UserError where the seed is out of its range.
    """

    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")]
    folds: Annotated[
        int | None,
        arg(
            help="Refit with each episode held out once, in so many parts, the run's own split among them; 0"
            " measures that split alone. By default 5 with 20 episodes or fewer, else 0."
        ),
    ] = None
    explain: Annotated[bool, arg(help="Explain each measure.")] = False
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for metrics and figures; RUN by default.")
    ] = None
    demonstrations: MovedDataset = None
    seed: Seed = 0
    jobs: Jobs = -1
    json: Json = False

    def __post_init__(self) -> None:
        check_seed(self.seed)

    @property
    def folder(self) -> Path:
        """The folder for metrics and figures."""
        return self.out or self.run

    @property
    def bars(self) -> bool:
        """Whether to show on standard error how many folds are done."""
        return not self.json and sys.stderr.isatty()
