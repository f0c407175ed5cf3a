import numpy as np
import pytest

from figure_faults import faults
from latentarm.core.errors import UserError
from latentarm.core.figure_style import COLUMN_MM, MM_PER_INCH, save_figure
from latentarm.evaluation.effects import axis_effects, axis_grid, held_paths
from latentarm.evaluation.figures import AWAY_M, latent_effect_figure, properties_figure

GRID = axis_grid(7)


def texts_of(figure):
    return [text for text in figure.findobj(lambda artist: hasattr(artist, "get_text")) if text.get_text()]


def assert_nothing_is_cut_off(figure):
    assert faults(figure) == []


@pytest.fixture(params=[1, 2, 3])
def effects(request, linear_decoder, gantry):
    rng = np.random.default_rng(0)
    decoder = linear_decoder(rng.normal(size=(3, request.param)))
    return axis_effects([decoder], rng.normal(size=(25, 3)), GRID, gantry, step_s=0.1)[0]


def test_the_properties_figure_says_r_squared_for_every_axis(effects):
    figure = properties_figure(effects, GRID, "cvae")
    words = [text.get_text() for text in texts_of(figure)]
    assert words.count("$R^2$ = 1.00") == len(effects)
    assert figure.get_size_inches()[0] * MM_PER_INCH == pytest.approx(COLUMN_MM)
    assert_nothing_is_cut_off(figure)


def test_held_paths_follow_the_decoder_step_by_step(turning_decoder, gantry):
    path = held_paths(turning_decoder(2.0), np.zeros((1, 2)), np.array([[1.0, 0.0]]), gantry, 0.5, 2)
    expected = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5 + 0.5 * np.cos(1.0), 0.5 * np.sin(1.0), 0.0]]
    np.testing.assert_allclose(path[0, 0], expected, atol=1e-12)


@pytest.mark.parametrize("dim", [1, 2])
def test_the_latent_effect_is_drawn_for_both_ends_of_every_axis(dim, linear_decoder, gantry):
    states = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [2.0, 0.0, 1.0]])
    decoder = linear_decoder(0.4 * np.eye(3)[:, [0, 2]][:, :dim])
    figure = latent_effect_figure(decoder, states, gantry, 0.1, "scl", demonstrated=states)
    words = [text.get_text() for text in texts_of(figure)]
    for axis in range(1, dim + 1):
        assert f"$z_{axis} = +1$" in words
        assert f"$z_{axis} = -1$" in words
    assert {"x (m)", "z (m)"} <= set(words)  # y, in which nothing moves, is looked along
    assert_nothing_is_cut_off(figure)


def test_the_way_back_is_drawn_from_all_around_every_start(linear_decoder, gantry):
    class Straight:
        def leads(self, context, offset):
            here = context[..., :3] + offset
            return here, here - 0.5 * offset

    states = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5]])
    decoder = linear_decoder(0.4 * np.eye(3)[:, [0, 2]])
    figure = latent_effect_figure(decoder, states, gantry, 0.1, "scl", way_back=Straight())
    arrows = [text for text in figure.axes[0].texts if text.arrow_patch is not None]
    here, there = (np.array([getattr(one, name) for one in arrows]) for name in ("xyann", "xy"))
    starts = np.tile(states[:, [0, 2]], (len(arrows) // 2, 1))
    np.testing.assert_allclose(np.linalg.norm(here - starts, axis=1), AWAY_M)
    np.testing.assert_allclose(there - starts, 0.5 * (here - starts))
    assert f"way back from {100 * AWAY_M:g} cm away" in [text.get_text() for text in texts_of(figure)]
    assert_nothing_is_cut_off(figure)


def test_a_figure_is_written_whole_or_not_at_all(effects, tmp_path):
    figure = properties_figure(effects, GRID, "cae")
    save_figure(figure, tmp_path / "figures" / "properties.png")
    assert (tmp_path / "figures" / "properties.png").read_bytes().startswith(b"\x89PNG")
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    with pytest.raises(UserError, match="cannot be written"):
        save_figure(figure, blocked / "properties.png")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["figures", "file"]
