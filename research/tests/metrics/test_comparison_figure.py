from figure_faults import faults
from latentarm.core.types import Row
from latentarm_research.metrics.comparison_figure import comparison_figure


def texts_of(figure):
    return [text for text in figure.findobj(lambda artist: hasattr(artist, "get_text")) if text.get_text()]


def rows_of(models, **names):
    measures = [("error_percent_of_pca", "%"), ("controllability_m", "m"), ("r2_axis_0", "1"), ("drift", "1")]
    return [
        Row("compare", measure, unit, 0.5 + place, 0.1 * place or None, 5, model=model, **names)
        for place, model in enumerate(models)
        for measure, unit in measures
    ]


def test_the_comparison_names_every_model_and_shows_them_apart_without_colour():
    models = ["pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl", "a_new_model"]
    figure = comparison_figure(rows_of(models))
    words = {text.get_text() for text in texts_of(figure)}
    assert {"PCA", "cVAE", "SCL", "a_new_model"} <= words
    panel = figure.axes[0]
    markers = [container.lines[0].get_marker() for container in panel.containers]
    assert len(set(markers[:7])) == 7
    assert faults(figure) == []


def test_conditions_of_one_model_are_compared_too():
    rows = [
        row for condition in ("latent", "latent_assist") for row in rows_of(["cvae"], condition=condition)
    ]
    figure = comparison_figure([*rows, Row("drive", "drift", "1", None, None, 0, condition="end_effector")])
    words = {text.get_text() for text in texts_of(figure)}
    assert {"latent actions", "mode switching"} <= words
