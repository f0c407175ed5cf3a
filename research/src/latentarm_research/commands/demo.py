"""`latentarm demo`: the main job on embedded defaults."""

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import say, show
from latentarm.runs.checks import check_count, check_seed
from latentarm.runs.options import Json, Seed


@dataclass(frozen=True)
class DemoOptions:
    """Options of `latentarm demo`. Raises a `UserError` where a figure is out of its range."""

    out: Annotated[Path, arg(metavar="DIR", help="Folder for datasets, runs, table and figures.")] = Path(
        "demo"
    )
    drives: Annotated[
        int,
        arg(
            help="Simulated drives of the greedy person for each marshmallow and condition; the other people"
            " drive a third as often."
        ),
    ] = 3
    seed: Seed = 0
    jobs: Annotated[
        int, arg(help="Processes that demonstrate and drive side by side; -1 is one per core.")
    ] = -1
    json: Json = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_count("drives for each marshmallow", self.drives)

    @property
    def others(self) -> int:
        """Drives for each marshmallow of everybody but the greedy person: a third of theirs, at least one."""
        return -(-self.drives // 3)

    @property
    def bars(self) -> bool:
        """Whether to show progress bars."""
        return not self.json and sys.stderr.isatty()


def demo(options: DemoOptions) -> int:
    """Learn latent actions and stab marshmallows with a 7-DoF Panda in physics, against mode switching.

    In a terminal it ends with the page of `latentarm teleop`. For example: latentarm demo --out demo
    """
    from latentarm.web.arm_process.drive_setup import Spec
    from latentarm.web.server.app import serve
    from latentarm.web.server.config import TeleopConfig
    from latentarm_research.commands.demo_run import ARM, MODELS, run_demo

    out, json = options.out, options.json
    shown = run_demo(options)
    write_options(out, "demo")
    show(shown.rows, json)
    for sentence in shown.said:
        say(sentence, json)
    say(f"Table, figures, datasets and runs are in {out}/ (begin with {out}/results.md).", json)
    run = out / "runs" / MODELS[0]
    if json or not (sys.stdin.isatty() and sys.stdout.isatty()):
        say(f"To drive the arm yourself: latentarm teleop {run}", json)
        return 0
    spec = Spec(run, out=out / "teleop", arm=ARM)
    serve(TeleopConfig(spec, port=0), partial(say, json=json))
    return 0
