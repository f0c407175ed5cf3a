"""A person's first hour: import, inspect, train, evaluate, drive, record, train on that."""

import json
from collections.abc import Callable
from pathlib import Path
from unittest.mock import Mock

import pytest

from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.models.catalogue import DEFAULT_MODEL
from result_rows import rows_in

Run = Callable[..., tuple[int, str, str]]


def figures(text: str) -> dict[str, float | None]:
    """Means by measure; fails unless the text is one JSON document of rows."""
    return {row["measure"]: row["mean"] for row in json.loads(text)}


def test_from_a_recording_to_a_driven_arm(run: Run, workplace: Path, recording: Path) -> None:
    code, out, _ = run("import", recording, "eat")
    assert code == 0
    assert "7 episodes of 7 joints" in out

    code, out, _ = run("inspect", "eat", "--json")
    assert code == 0
    assert figures(out)["episodes"] == 7
    assert Path("eat-figures/joints.png").stat().st_size > 10_000

    command = ("train", "--demonstrations", "eat", "--model", "cae", "--seeds", 2, "--epochs", 2)
    code, out, err = run(*command, "--hidden", 8, "--json")
    assert code == 0
    assert figures(out)["validation_loss"] is not None
    assert "latentarm evaluate runs/eat-cae" in err

    code, out, _ = run("evaluate", "runs/eat-cae", "--json", "--folds", 0)
    assert code == 0
    printed = figures(out)
    expected = {
        "error_percent_of_pca",
        "noise_free_error_percent_of_pca",
        "search_error_percent_of_pca",
        "search_noise_free_error_percent_of_pca",
        "controllability_m",
        "r2",
        "r2_axis_0",
        "r2_axis_1",
        "disentanglement_deg",
        "drift",
        "reversal",
        "reversal_2_s",
        "motion_turn",
    }
    assert expected <= printed.keys()
    assert {row.measure: row.mean for row in rows_in(Path("runs/eat-cae/metrics.json"))} == printed
    assert {path.name for path in Path("runs/eat-cae").glob("*.png")} == {
        "consistency.png",
        "latent_axes.png",
    }

    code, out, _ = run("drive", "runs/eat-cae", "--jobs", 1, "--drives", 1, "--time-limit-s", 0.5, "--json")
    assert figures(out).keys() >= {
        "success_rate",
        "time_s",
        "input_magnitude",
        "mode_switches",
        "path_length",
    }
    assert code == (0 if figures(out)["success_rate"] else 1)

    # With two sticks a drive is over soonest.
    sticks = ("--controller", "two_sticks", "--jobs", 1, "--drives", 1)
    code, out, _ = run("drive", *sticks, "--record", "driven", "--out", "recorded", "--json")
    assert code == 0
    driven = read_dataset(Path("driven"))
    assert len(driven.episodes) == 3
    assert {"input.u", "latent.z", "action.human"} <= driven.episodes[0].extras.keys()
    assert run("inspect", "driven")[0] == 0


def test_training_with_belief_needs_goals_and_says_so(run: Run, eat: Path) -> None:
    code, _, err = run("train", "--demonstrations", "eat", "--context", "state_belief")
    assert code == 2
    assert "goals" in err


def test_a_finished_run_is_not_overwritten(run: Run, eat: Path) -> None:
    command = ("train", "--demonstrations", "eat", "--model", "pca", "--out", "mine")
    assert run(*command)[0] == 0
    before = Path("mine/model.safetensors").read_bytes()
    code, _, err = run(*command)
    assert code == 2
    assert "holds a run already" in err
    assert Path("mine/model.safetensors").read_bytes() == before


def test_the_same_seed_gives_the_same_figures(run: Run, eat: Path) -> None:
    outs = []
    train = ("train", "--demonstrations", "eat", "--model", "scl", "--seeds", 1, "--epochs", 1, "--seed", 1)
    train += ("--hidden", 8)
    for name in ("one", "two"):
        run(*train, "--out", name)
        outs.append(run("evaluate", name, "--json", "--folds", 0)[1])
    assert figures(outs[0]) == figures(outs[1])


# These few demonstrations teach no way back, and the demo says so.
@pytest.mark.filterwarnings("ignore:.*to learn a way back")
def test_demo_writes_a_page_with_figures(workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from latentarm.tasks.eating.marshmallows import Marshmallows
    from latentarm_research.commands import demo_run
    from latentarm_research.commands.demo import DemoOptions
    from latentarm_research.commands.demo_run import Sizes, run_demo
    from latentarm_research.commands.drive_options import DriveOptions
    from latentarm_research.commands.drive_run import drive_run
    from latentarm_research.drives import following

    # Models of one epoch get nowhere; a demonstration takes 5 to 6 s.
    monkeypatch.setattr(following, "STUCK_S", 0.05)
    monkeypatch.setattr(Marshmallows, "time_limit_s", 6.5)
    monkeypatch.setattr(demo_run, "HIDDEN", (8, 8))
    monkeypatch.setattr(demo_run, "DRIVERS", drivers := ("greedy", "unsteady"))
    config = DemoOptions(Path("demo"), drives=1, jobs=1, json=True)
    sizes = Sizes(episodes=4, seeds=1, epochs={DEFAULT_MODEL: 1, "cvae": 1})
    shown = run_demo(config, sizes)
    models = {DEFAULT_MODEL, "cvae"}
    alone = {(None, "end_effector"), *((model, "latent") for model in models)}
    helped = {(model, "latent_assist") for model in models}
    others = {
        (model, f"{condition}, {person}")
        for model, condition in ((DEFAULT_MODEL, "latent"), (None, "end_effector"))
        for person in drivers
        if person != "greedy"
    }
    assert {(row.model, row.condition) for row in shown.rows} == alone | helped | others
    page = Path("demo/results.md").read_text()
    assert "simulated operator" in page
    assert shown.said[0].startswith("The fork holds the marshmallow in ")
    assert shown.said[0] in page
    for person in drivers:
        assert f"## The {person} operator" in page
    for figure in ("task.png", "paths.png", "inputs.png"):
        assert figure in page
        assert (Path("demo") / figure).stat().st_size > 10_000
    # The run is driven at the task that it learned, in physics.
    monkeypatch.setattr(Marshmallows, "time_limit_s", 0.5)
    run = Path(f"demo/runs/{DEFAULT_MODEL}")
    driven = drive_run(DriveOptions(run, drives=1, record=Path("stabbed"), out=Path("again")))
    assert {row.task for row in driven.rows} == {"marshmallows"}
    entries = json.loads(Path("again/drives.json").read_text())["drives"]
    assert [entry["choice_name"] for entry in entries] == list(Marshmallows().choices)
    assert Path("again/paths.png").exists()
    recorded = read_dataset(Path("stabbed"))
    assert len(recorded.episodes) == len(entries)
    assert recorded.objects == Marshmallows().choices
    assert {one.extras[ENVIRONMENT].shape for one in recorded.episodes} == {
        (len(one.state), 7 * len(recorded.objects)) for one in recorded.episodes
    }
    # A second time: the earlier demo makes room.
    monkeypatch.setattr(demo_run, "demonstrate", Mock(side_effect=InterruptedError))
    with pytest.raises(InterruptedError):
        run_demo(config, sizes)
    assert {path.name for path in Path("demo").iterdir()} == {"config.json", "runs"}
    assert not list(Path("demo/runs").iterdir())


def test_a_collapsed_latent_dimension_is_said(run: Run, eat: Path, recwarn: pytest.WarningsRecorder) -> None:
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        command = ("train", "--demonstrations", "eat", "--model", "vae", "--kl-weight", 50, "--epochs", 1)
        code, _, err = run(*command)
    assert code == 0
    assert "latentarm: warning: " in err
    assert "collapsed" in err
    assert "Warning:" not in err
    config = json.loads(Path("runs/eat-vae/config.json").read_text())
    assert config["warnings"]


def test_a_decoder_that_sees_the_belief_is_trained_and_driven(run: Run, table: Path) -> None:
    command = ("train", "--demonstrations", "table", "--model", "scl", "--epochs", 1, "--seeds", 1)
    assert run(*command, "--context", "state_belief", "--hidden", 8)[0] == 0
    assert run("evaluate", "runs/table-scl", "--folds", 0)[0] == 0
    code, out, _ = run("drive", "runs/table-scl", "--jobs", 1, "--drives", 1, "--time-limit-s", 1, "--json")
    assert code in (0, 1)
    # The controller worked: an input was given and the tool moved.
    assert (figures(out)["path_length"] or 0.0) > 0.01


def test_help_is_as_the_person_sets_it_and_is_recorded(run: Run, table: Path) -> None:
    run("train", "--demonstrations", "table", "--model", "pca")
    drive = (
        "drive",
        "runs/table-pca",
        "--controller",
        "latent_assist",
        "--jobs",
        1,
        "--drives",
        1,
        "--time-limit-s",
        1,
    )
    helped = ("--belief", "boltzmann", "--arbitration", "confidence", "--alpha", 0.4)
    code, out, _ = run(*drive, *helped, "--record", "helped", "--out", "confidence", "--json")
    assert code in (0, 1)
    assert (figures(out)["path_length"] or 0.0) > 0
    said = json.loads(Path("confidence/drives.json").read_text())["about"]
    assert (said["belief"], said["arbitration"], said["alpha"]["most"]) == ("boltzmann", "confidence", 0.4)
    for episode in read_dataset(Path("helped")).episodes:
        alpha, bound = episode.extras["assist.alpha"][:, 0], episode.extras["assist.bound"][:, 0]
        assert alpha.max() <= 0.4 + 1e-6
        assert (bound[alpha > 0] > 0).all()
        assert (bound[alpha == 0] == -1).all()
    run(*drive, "--out", "usual")
    said = json.loads(Path("usual/drives.json").read_text())["about"]
    assert (said["belief"], said["arbitration"], said["alpha"]["value"]) == ("boltzmann", "fixed", 0.15)
