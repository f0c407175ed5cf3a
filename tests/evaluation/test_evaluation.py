"""The whole evaluation, of models known in closed form and of trained ones on real demonstrations."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.evaluation.approach import SolverConfig
from latentarm.evaluation.controllability import ReachConfig
from latentarm.evaluation.evaluation import EvaluationConfig, measure
from latentarm.evaluation.summary import Subject
from latentarm.robots.planar import planar

SMALL = EvaluationConfig(
    reach=ReachConfig(pairs=20, separation_s=1.0, solver=SolverConfig(time_s=2.0)), latents=200
)
POUR = Path(__file__).parents[3] / "shared" / "demonstrations" / "panda_pour_coffee.npz"
BASIS = np.linalg.qr(np.random.default_rng(5).normal(size=(5, 3)))[0]


@dataclass(frozen=True)
class PlaneModel:
    """Actions within a plane of joint space: z are the coordinates in it, one speed per seed."""

    decode_basis: tuple[np.ndarray, ...]
    linear: object
    latent_dim: int = 2
    context: str = "state"
    actions: str = "displacement"
    window: int = 3
    state_noise_rad: float = 0.01
    learns_encoder: bool = False

    def encode(self, context, action):
        return np.stack([action @ np.linalg.pinv(basis).T for basis in self.decode_basis])

    def decoder(self, seed=0):
        return self.linear(self.decode_basis[seed])


@pytest.fixture(scope="module")
def robot():
    return planar(5)


@pytest.fixture(scope="module")
def plane_demonstrations(robot):
    """Motions within the plane of the first two columns of BASIS, and a little along the third."""
    time = np.arange(40) / 10.0
    episodes = []
    for phase in range(4):
        along = np.stack(
            [np.sin(time + phase), np.cos(1.3 * time + phase), 0.1 * np.sin(2 * time - phase)], axis=-1
        )
        episodes.append(Episode(state=robot.home + 0.3 * along @ BASIS.T, timestamp=time))
    return Demonstrations(tuple(episodes), rate_hz=10.0, joint_names=robot.joint_names)


def figures_of(model, demonstrations, robot, held_out=(3,)):
    figures = measure(model, demonstrations, held_out, robot, rng=np.random.default_rng(0), config=SMALL)
    rows = figures.rows(Subject("evaluate", task="plane", model="scl"))
    return {row.measure: row for row in rows}


def test_a_linear_model_has_the_figures_that_theory_gives_it(plane_demonstrations, robot, linear_decoder):
    model = PlaneModel((BASIS[:, :2], 2.0 * BASIS[:, :2]), linear_decoder)
    rows = figures_of(model, plane_demonstrations, robot)
    assert rows["drift"].mean == 0.0
    assert rows["reversal"].mean == pytest.approx(0.0, abs=1e-12)
    # The plane is nearly the one that PCA finds, so it can hardly do better or worse than that.
    assert rows["search_error_percent_of_pca"].mean == pytest.approx(100.0, abs=10.0)
    noise_free = rows["search_noise_free_error_percent_of_pca"].mean
    assert noise_free == pytest.approx(rows["search_error_percent_of_pca"].mean)
    assert rows["error_percent_of_pca"].mean is None  # it has no encoder network
    assert rows["error_percent_of_pca"].n == 0
    assert rows["reversal_2_s"].mean == pytest.approx(0.0, abs=1e-12)
    assert rows["state_change"].mean == 0.0
    assert rows["controllability_m"].mean < 0.2 * rows["start_distance_m"].mean
    assert 0.0 <= rows["disentanglement_deg"].mean <= 90.0


def test_a_model_that_holds_every_direction_has_no_error(plane_demonstrations, robot, linear_decoder):
    rows = figures_of(PlaneModel((BASIS,), linear_decoder, latent_dim=3), plane_demonstrations, robot)
    assert rows["search_error"].mean == pytest.approx(0.0, abs=1e-20)
    assert rows["search_error"].sd is None
    assert rows["search_error"].n == 1
    assert {"r2_axis_0", "r2_axis_1", "r2_axis_2"} <= rows.keys()


def test_every_row_says_what_it_is_of_and_can_be_filed(plane_demonstrations, robot, linear_decoder):
    model = PlaneModel((BASIS[:, :1], -BASIS[:, :1], BASIS[:, 1:2]), linear_decoder, latent_dim=1)
    rows = figures_of(model, plane_demonstrations, robot)
    assert {(row.study, row.task, row.model) for row in rows.values()} == {("evaluate", "plane", "scl")}
    assert rows["disentanglement_deg"].mean is None  # one axis makes no angle
    assert {
        row.n
        for row in rows.values()
        if row.measure not in ("disentanglement_deg", "start_distance_m") and row.mean is not None
    } == {3}
    units = {"drift": "1", "controllability_m": "m", "search_error_percent_of_pca": "%", "error": "rad^2/s^2"}
    assert {measure: rows[measure].unit for measure in units} == units


def test_the_noisy_error_is_measured_under_the_training_noise(plane_demonstrations, robot, formula_decoder):
    @dataclass(frozen=True)
    class LedByTheState:
        """Holds every action, but adds to it what the state says, noise and all."""

        latent_dim: int = 5
        context: str = "state"
        actions: str = "displacement"
        window: int = 3
        state_noise_rad: float = 0.3
        learns_encoder: bool = True

        def encode(self, context, action):
            return action[None]

        def decoder(self, seed=0):
            return formula_decoder(5, lambda z, context: z + (context - robot.home))

    rows = figures_of(LedByTheState(), plane_demonstrations, robot)
    assert rows["error_percent_of_pca"].mean is None  # PCA with as many components has no error
    assert rows["error"].mean - rows["noise_free_error"].mean == pytest.approx(0.3**2, rel=0.25)


def test_an_unknown_episode_cannot_be_held_out(plane_demonstrations, robot, linear_decoder):
    model = PlaneModel((BASIS[:, :2],), linear_decoder)
    with pytest.raises(UserError, match="no episode 9"):
        figures_of(model, plane_demonstrations, robot, held_out=[9])
    with pytest.raises(UserError, match="hold out at least one"):
        figures_of(model, plane_demonstrations, robot, held_out=[])
    with pytest.raises(UserError, match="leave at least one"):
        figures_of(model, plane_demonstrations, robot, held_out=[0, 1, 2, 3])


@pytest.mark.skipif(not POUR.exists(), reason="the real demonstrations are not beside this checkout")
def test_real_demonstrations_show_what_the_models_are_known_for(tmp_path):
    from latentarm.demonstrations.importers.importing import import_demonstrations
    from latentarm.models.estimators import MODELS
    from latentarm.robots.panda import panda

    robot = panda()
    demonstrations = import_demonstrations(POUR, robot)
    config = EvaluationConfig(reach=ReachConfig(pairs=20), latents=200)
    figures = {}
    for name, epochs in (("pca", 1), ("scl", 3), ("cae", 3)):
        model = MODELS[name](latent_dim=2, seeds=2, epochs=epochs, state_noise_rad=0.01)
        model.fit(demonstrations, validation=[12, 13, 14])
        rng = np.random.default_rng(0)
        measured = measure(model, demonstrations, [12, 13, 14], robot, rng=rng, config=config)
        rows = measured.rows(Subject("evaluate", model=name))
        figures[name] = {row.measure: row.mean for row in rows}
    assert figures["pca"]["search_error_percent_of_pca"] == pytest.approx(100.0, abs=2.0)
    assert figures["pca"]["error_percent_of_pca"] is figures["scl"]["error_percent_of_pca"] is None
    assert figures["scl"]["search_error_percent_of_pca"] < 60.0
    assert figures["cae"]["search_error_percent_of_pca"] < figures["cae"]["error_percent_of_pca"] < 60.0
    assert figures["scl"]["drift"] == pytest.approx(0.0, abs=1e-12)
    assert figures["cae"]["drift"] > 0.2
    assert figures["scl"]["reversal"] < 0.3 < figures["cae"]["reversal"]
    assert figures["cae"]["controllability_m"] < 0.04
