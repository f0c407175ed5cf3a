"""The order of questions, and what a person may do instead of answering."""

import numpy as np
import pytest

from latentarm.alignment.demonstrated import shown
from latentarm.alignment.queries import StoppingRule
from latentarm.core.errors import UserError
from latentarm.models.pca.training import PCA
from latentarm.runs.person import Respondent
from latentarm.runs.questions import AlignmentProblem, ask
from latentarm.tasks.table_top import TableTop

NEVER = StoppingRule(share=0.0, patience=100)


class Scripted(Respondent):
    """Says one thing after the other, and remembers what it was asked."""

    kind = "person"

    def __init__(self, *replies):
        self.replies = list(replies)
        self.asked = []

    def answer(self, question):
        self.asked.append(question)
        return self.replies.pop(0)


@pytest.fixture(scope="module")
def scene():
    task = TableTop()
    demonstrations = task.demonstrate(4, np.random.default_rng(0))
    chain, rng = task.robot.chain, np.random.default_rng(1)
    motions = shown(demonstrations, "state", chain, rng)
    return AlignmentProblem(PCA(latent_dim=2).fit(demonstrations).decoder(), chain, motions)


def asked(scene, *replies, count=2):
    person = Scripted(*(reply if reply in (None, "back") else np.full(2, reply) for reply in replies))
    answers = ask(scene, person, count, lambda text: None, NEVER)
    assert person.replies == []
    return answers, [question.motion.start[0] for question in person.asked], person.asked


def test_what_nobody_would_know_is_left_out(scene):
    answers, starts, questions = asked(scene, 0.1, None, 0.2)
    assert answers.u[:, 0].tolist() == [0.1, 0.2]
    np.testing.assert_array_equal(answers.motions.start, [starts[0], starts[2]])
    assert [question.number for question in questions] == [1, 2, 2]


def test_back_asks_the_same_again_and_forgets_what_was_said(scene):
    answers, starts, questions = asked(scene, 0.1, "back", 0.3, 0.2)
    assert answers.u[:, 0].tolist() == [0.3, 0.2]
    np.testing.assert_array_equal(starts[2], starts[0])
    np.testing.assert_array_equal(starts[3], starts[1])
    assert [question.number for question in questions] == [1, 2, 1, 2]


def test_back_also_returns_to_what_was_skipped(scene):
    answers, starts, _ = asked(scene, None, "back", 0.1, 0.2)
    np.testing.assert_array_equal(starts[2], starts[0])
    np.testing.assert_array_equal(answers.motions.start[0], starts[0])


def test_back_from_the_first_question_leads_nowhere(scene):
    answers, starts, _ = asked(scene, "back", 0.1, count=1)
    np.testing.assert_array_equal(starts[1], starts[0])
    assert len(answers) == 1


def test_going_back_past_what_was_known_after_an_answer(scene):
    answers, _, questions = asked(scene, 0.1, 0.2, 0.3, "back", "back", 0.5, 0.6, 0.7, count=4)
    assert [question.number for question in questions] == [1, 2, 3, 4, 3, 2, 3, 4]
    assert answers.u[:, 0].tolist() == [0.1, 0.5, 0.6, 0.7]


def test_whoever_answers_nothing_teaches_nothing(scene):
    with pytest.raises(UserError, match="No question was answered"):
        asked(scene, *[None] * len(scene.candidates))
