"""Runs of HARMONIC, made in its layout: the data itself is not part of the tests."""

import shutil

import numpy as np
import pytest
import yaml

from latentarm.core.errors import UserError
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.importers.harmonic import JOINTS, MORSELS, read_harmonic
from latentarm.demonstrations.importers.importing import import_demonstrations
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.robots.catalogue import load_robot

START_S = 1_530_000_000.0
SAMPLES = 40
SIDE = np.array([[0.0, -1.0, 0.0, 0.1], [1.0, 0.0, 0.0, -0.5], [0.0, 0.0, 1.0, 0.02], [0.0, 0.0, 0.0, 1.0]])


def table(path, columns):
    header = ",".join(columns)
    np.savetxt(path, np.column_stack(list(columns.values())), "%.9f", ",", header=header, comments="")


def make_run(folder, goal=1, success=True, morsels=None, start_s=START_S):
    text, stats = folder / "text_data", folder / "stats"
    text.mkdir(parents=True)
    stats.mkdir()
    time_s = start_s + 0.1 * np.arange(SAMPLES)
    share = np.linspace(0.0, 1.0, SAMPLES)
    names = (*JOINTS, "mico_joint_finger_1", "mico_joint_finger_2")
    columns = {"timestamp": time_s}
    for number, name in enumerate(names):
        columns[f"{name}_pos"] = 0.1 * number + share
        columns[f"{name}_vel"] = np.full(SAMPLES, 0.25)
        columns[f"{name}_eff"] = np.full(SAMPLES, float(number))
    table(text / "joint_positions.csv", columns)
    belief = np.column_stack([0.5 - 0.5 * share, 0.5 * share, np.full(SAMPLES, 0.5)])[::4]
    said_s = time_s[::4] + 0.05
    table(
        text / "assistance_info.csv", {"timestamp": said_s} | {f"p_goal_{i}": belief[:, i] for i in range(3)}
    )
    stick = {f"axes_{axis}": np.full(2, value) for axis, value in (("x", 0.3), ("y", -0.7), ("z", 0.0))}
    table(text / "ada_joy.csv", {"timestamp": time_s[[0, -1]]} | stick | {"buttons_0": [0, 1]})
    poses = {name: SIDE.tolist() for name in MORSELS}
    said = poses | {"stated_goal": goal, "goal_success": success, "any_success": True} | (morsels or {})
    (text / "morsel.yaml").write_text(yaml.safe_dump(said))
    ends = [["start_time", float(time_s[5])], ["end_time", float(time_s[-3])], ["participant", 101]]
    (stats / "run_info.yaml").write_text(yaml.safe_dump(ends))
    return folder


@pytest.fixture
def run(tmp_path):
    return make_run(tmp_path / "p101" / "run" / "001")


class TestWhole:
    def test_a_run_is_an_episode_of_six_joints_with_all_that_was_said(self, run):
        data = import_demonstrations(run)
        (episode,) = data.episodes
        assert (data.joint_names, data.robot, data.objects) == (JOINTS, "mico", MORSELS)
        assert data.rate_hz == pytest.approx(10.0)
        # From the run's start to its end, both included.
        assert episode.state.shape == (SAMPLES - 7, 6)
        assert episode.timestamp[[0, -1]] == pytest.approx([0.0, 0.1 * (SAMPLES - 8)], abs=1e-6)
        assert episode.state[0] == pytest.approx(0.1 * np.arange(6) + 5 / (SAMPLES - 1), abs=1e-6)
        assert episode.extras["observation.velocity"] == pytest.approx(0.25)
        assert episode.extras["observation.effort"][0] == pytest.approx(np.arange(6))
        assert episode.extras["input.u"] == pytest.approx(np.tile([0.3, -0.7], (SAMPLES - 7, 1)))
        assert episode.task == "the fork over morsel 1"
        assert episode.action is None

    def test_the_belief_is_what_was_said_last(self, run):
        belief = import_demonstrations(run).episodes[0].extras["belief"]
        assert belief.sum(axis=1) == pytest.approx(np.ones(len(belief)))
        # The first sample kept is the sixth; the belief was said 0.05 s after the first, the fifth, ...
        assert belief[0, 1] == pytest.approx(0.5 * 4 / (SAMPLES - 1), abs=1e-6)
        assert belief[3, 1] == pytest.approx(0.5 * 4 / (SAMPLES - 1), abs=1e-6)
        assert belief[4, 1] == pytest.approx(0.5 * 8 / (SAMPLES - 1), abs=1e-6)

    def test_morsels_are_things_with_poses(self, run):
        poses = import_demonstrations(run).episodes[0].extras["observation.environment_state"]
        quarter = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
        assert poses[0].reshape(3, 7) == pytest.approx(np.tile([0.1, -0.5, 0.02, *quarter], (3, 1)))

    @pytest.mark.parametrize("success", [True, False])
    def test_success_is_at_the_last_sample(self, tmp_path, success):
        extras = import_demonstrations(make_run(tmp_path / "001", success=success)).episodes[0].extras
        assert extras["next.success"].sum() == extras["next.success"][-1, 0] == success
        assert extras["next.any_success"][-1, 0] == 1.0

    def test_all_runs_of_a_folder_in_order_without_those_that_miss_a_morsel(self, run, tmp_path):
        make_run(tmp_path / "p102" / "run" / "001", goal=2)
        make_run(tmp_path / "p102" / "run" / "002", morsels={"morsel2": None})
        data = import_demonstrations(tmp_path)
        assert [episode.task[-1] for episode in data.episodes] == ["1", "2"]
        assert data.import_record["runs"] == "2; 1 without the pose of a morsel left out"
        write_dataset(data, tmp_path / "dataset")
        assert len(read_dataset(tmp_path / "dataset").episodes) == 2

    def test_rate_and_task_as_told(self, run):
        data = import_demonstrations(run, options=ImportOptions(rate_hz=10.1, instruction="eat"))
        assert (data.rate_hz, data.episodes[0].task) == (10.1, "eat")

    def test_it_is_not_taken_for_another_arm(self, run):
        with pytest.raises(UserError, match="recorded on 'mico', and the robot is panda"):
            import_demonstrations(run, load_robot("panda"))


def rewritten(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


class TestMalformed:
    @pytest.mark.parametrize(
        "name",
        [
            "text_data/assistance_info.csv",
            "text_data/ada_joy.csv",
            "text_data/morsel.yaml",
            "stats/run_info.yaml",
        ],
    )
    def test_a_missing_file_is_named(self, run, name):
        (run / name).unlink()
        with pytest.raises(UserError, match=name.split("/")[1]):
            import_demonstrations(run)

    @pytest.mark.parametrize(
        ("name", "old", "new", "said"),
        [
            ("text_data/joint_positions.csv", "mico_joint_3_pos", "elbow", "one column 'mico_joint_3_pos'"),
            ("text_data/joint_positions.csv", "0.250000000", "fast", "line 2, .*'fast' is not a number"),
            ("text_data/joint_positions.csv", "0.250000000", "1,2", "line 2 is ragged"),
            ("text_data/assistance_info.csv", "p_goal_2", "p_goal_1", "one column 'p_goal_1'"),
            ("text_data/ada_joy.csv", "1530000000.0", "1630000000.0", "timestamps fall"),
            ("text_data/morsel.yaml", "stated_goal: 1", "stated_goal: 3", "stated_goal"),
            ("text_data/morsel.yaml", "goal_success: true", "goal_success: 7", "goal_success"),
            ("text_data/morsel.yaml", "- 0.02", "- .inf", "stands for a pose"),
            ("text_data/morsel.yaml", "- -1.0", "- 5.0", "stands for a pose"),
            ("text_data/morsel.yaml", "any_success", "&a [*a]", "morsel.yaml"),
            ("stats/run_info.yaml", "start_time", "start_time\n  - 1", "pairs"),
            ("stats/run_info.yaml", "1530000000.5", "soon", "start_time is 'soon'"),
            ("stats/run_info.yaml", "1530000000.5", "2e9", "no two samples"),
        ],
    )
    def test_a_malformed_file_is_one_sentence(self, run, name, old, new, said):
        rewritten(run / name, old, new)
        with pytest.raises(UserError, match=said) as caught:
            import_demonstrations(run)
        assert str(run) in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_repeated_times_are_refused(self, run):
        path = run / "text_data/joint_positions.csv"
        lines = path.read_text().splitlines()
        path.write_text("\n".join([*lines[:11], lines[10], *lines[11:]]))
        with pytest.raises(UserError, match="repeats"):
            import_demonstrations(run)

    def test_an_empty_table_is_refused(self, run):
        path = run / "text_data/ada_joy.csv"
        path.write_text(path.read_text().splitlines()[0])
        with pytest.raises(UserError, match="no line after its header"):
            import_demonstrations(run)

    def test_no_run_with_all_morsels(self, tmp_path):
        run = make_run(tmp_path / "001", morsels={"morsel0": None})
        with pytest.raises(UserError, match="no run has the poses"):
            read_harmonic([run], ImportOptions())

    def test_any_other_folder_is_still_taken_for_a_lerobot_dataset(self, run, tmp_path):
        shutil.rmtree(run / "text_data")
        with pytest.raises(UserError, match=r"info\.json"):
            import_demonstrations(tmp_path)
