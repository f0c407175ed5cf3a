"""Manual Align, the affine map of answers."""

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm_research.alignment.affine import fit_affine


def test_an_affine_preference_is_found(linear_model, columns):
    rng = np.random.default_rng(0)
    matrix, offset = np.array([[0.2, -0.9], [0.7, 0.3]]), np.array([0.05, -0.1])
    u, start = rng.uniform(-1, 1, (6, 2)), rng.uniform(-0.1, 0.1, (6, 3))
    motions = Motions(start, start + 0.5 * (u @ matrix.T + offset) @ columns, 0.5)
    found = fit_affine(linear_model, Answers(motions, u))
    np.testing.assert_allclose(found(u, start), u @ matrix.T + offset, atol=1e-9)
    assert found(np.zeros((3, 6, 2)), start).shape == (3, 6, 2)


def test_too_few_answers_give_a_small_map_that_meets_them(linear_model, columns):
    start = np.zeros((1, 3))
    answers = Answers(Motions(start, start + 0.5 * columns[:1], 0.5), np.array([[0.0, 1.0]]))
    found = fit_affine(linear_model, answers)
    np.testing.assert_allclose(found(answers.u, start), [[1.0, 0.0]], atol=1e-9)
