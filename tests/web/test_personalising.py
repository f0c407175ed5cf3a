"""A person is asked over the page's socket, without a browser; and what may go wrong on the way."""

import asyncio
import json
import shutil
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from latentarm.alignment.profile import TRIAL, keep_trial, profile_names, trial_folder
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.jobs.personalise import PersonaliseJob, PersonalisePlan
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import ChooseProfile
from latentarm.web.protocol.page_messages import parse_message
from latentarm.web.protocol.personalise_messages import (
    AnswerQuestion,
    BeginPersonalise,
    LeaveQuestion,
    Personalise,
    PressPersonalise,
    ShownMotion,
)
from latentarm.web.server import personalising
from latentarm.web.server.personalising import Personalising

from .conftest import wait_for

BEGIN = {"type": "personalise", "name": "ada", "questions": 3}


@pytest.fixture
def run(trained, tmp_path):
    """A run of the test's own."""
    return Path(shutil.copytree(trained, tmp_path / "run"))


# --- the job alone ---


def plan(run, questions):
    return PersonalisePlan(run, "ada", questions, None, None, trial_folder(run))


@pytest.fixture
def job(run):
    job = PersonaliseJob(plan(run, 6))
    yield job
    job.end()


def question(job, after):
    """The next question after the one of this id."""

    def found():
        state = job.look()
        return state if state.phase == "asking" and state.question > after else None

    return wait_for(found)


def answer(to, u):
    return AnswerQuestion(type="answer", question=to, u=u)


def ended(job):
    return wait_for(lambda: job.look() if job.look().phase in ("learned", "refused", "failed") else None)


def pushed(u):
    """To every motion the same answer."""
    return lambda motion: u


def rightwards(motion):
    """What a person pushes for whom right is along y of the base, and up along -x: 0.4 m/s at most."""
    (x, y, _), (to_x, to_y, _) = motion.tools[0][0], motion.tools[0][-1]
    u = np.clip(np.array([to_y - y, x - to_x]) / (0.4 * motion.duration_s), -1.0, 1.0)
    return tuple(u.tolist())


def answered(job, how, after=0):
    """The state at the end, when a person answers every question by how they see the motion."""
    while (state := job.look()).phase not in ("learned", "refused", "failed"):
        if state.phase == "asking" and state.question > after:
            after = state.question
            job.reply(answer(after, how(state.motion)))
        time.sleep(0.002)
    return state


@pytest.mark.slow
def test_a_person_answers_skips_goes_back_and_is_learned_from(job, run):
    first = question(job, 0)
    assert (first.number, first.of, first.back) == (1, 6, False)
    assert first.motion.duration_s == 0.5
    assert len(first.motion.frames[0]) == 8
    assert len(first.motion.tools) == 1
    job.reply(answer(first.question, rightwards(first.motion)))
    assert job.look().phase == "thinking"
    job.reply(answer(first.question, (1.0, 1.0)))  # the same answer twice counts once

    second = question(job, first.question)
    assert (second.number, second.back) == (2, True)
    job.reply(LeaveQuestion(type="skip_question", question=second.question))
    third = question(job, second.question)
    assert (third.number, third.motion != second.motion) == (2, True)
    job.reply(LeaveQuestion(type="question_before", question=third.question))
    again = question(job, third.question)
    assert again.motion == second.motion
    job.reply(answer(again.question, rightwards(again.motion)))

    learned = answered(job, rightwards, again.question)
    assert learned.phase == "learned", learned.why
    assert learned.answers == 6
    assert learned.error < 0.3 < learned.error_without, "answers are met that it was not learned from"
    about = json.loads((trial_folder(run) / "config.json").read_text())
    assert (about["name"], about["person"]) == ("ada", "person")
    assert np.array(about["answers"]["u"][:2]) == pytest.approx(
        np.array([rightwards(one.motion) for one in (first, again)])
    )


@pytest.mark.slow
def test_ten_times_the_same_answer_is_not_announced_as_learned(run):
    job = PersonaliseJob(plan(run, 10))
    refused = answered(job, pushed((0.0, -0.5)))
    assert (refused.phase, refused.why.code) == ("refused", "answers_alike")
    assert not trial_folder(run).exists()
    assert not job.under_way
    job.end()


@pytest.mark.slow
def test_answers_that_agree_with_the_directions_of_now_change_nothing(run):
    first = PersonaliseJob(plan(run, 6))
    assert answered(first, rightwards).phase == "learned"
    first.end()
    keep_trial(run, "bob")
    again = PersonaliseJob(replace(plan(run, 6), profile="bob"))
    refused = answered(again, rightwards)
    assert (refused.phase, refused.why.code) == ("refused", "answers_agree")
    assert refused.error_without < 0.3
    assert not trial_folder(run).exists()
    again.end()


@pytest.mark.slow
def test_whoever_knows_nothing_is_told_so(run):
    job = PersonaliseJob(plan(run, 1))
    asked_last = 0
    while job.look().phase != "failed":
        if job.look().phase == "asking" and job.look().question > asked_last:
            asked_last = job.look().question
            job.reply(LeaveQuestion(type="skip_question", question=asked_last))
        time.sleep(0.002)
    assert "No question was answered" in job.look().why.text
    assert not trial_folder(run).exists()
    job.end()


@pytest.mark.slow
def test_a_job_that_dies_says_so(job):
    question(job, 0)
    job._job._process.kill()
    failed = ended(job)
    assert failed.phase == "failed"
    assert failed.why.text.endswith("try again.")
    assert failed.motion is None


@pytest.mark.slow
def test_a_run_that_cannot_be_asked_about_says_why(run):
    (run / "model.safetensors").write_bytes(b"none")
    job = PersonaliseJob(plan(run, 2))
    failed = ended(job)
    assert failed.phase == "failed"
    assert "model.safetensors" in failed.why.text
    job.end()


# --- what the server makes of it, without jobs that take long ---


class Control:
    """Takes orders."""

    def __init__(self):
        self.orders = []
        self.stops = []

    def order(self, order):
        self.orders.append(order)
        return True

    def stop(self, reason):
        self.stops.append(reason)


class Report:
    """All that is looked at of a report."""

    def __init__(self, phase="disengaged", profile=None):
        self.phase = phase
        self.profile = profile


class Desk:
    """Personalising with everything around it pretended."""

    def __init__(self, run):
        spec = SimpleNamespace(run=run, seated=lambda seat: seat)
        self.loaded = SimpleNamespace(spec=spec, latent_dim=2)
        self.report = Report()
        self.control = Control()
        self.personalising = Personalising(self, self.control)

    @property
    def at_rest(self):
        return self.report.phase in ("disengaged", "neutral_needed")

    def take(self, message):
        self.personalising.take(message)
        return self.personalising.look()


@pytest.fixture
def desk(run):
    return Desk(run)


def begin(name="ada"):
    return BeginPersonalise(type="personalise", name=name, questions=1)


@pytest.mark.parametrize("name", ["", "  ", TRIAL, "x" * 65, "a\nb", "\u202egnp", "..."])
def test_a_name_that_is_none_begins_nothing(desk, name):
    state = desk.take(begin(name))
    assert state.phase == "failed"
    assert "name" in state.why.text
    assert desk.personalising.standstill is None


def test_a_name_that_is_taken_begins_nothing(desk, run):
    (run / "profiles" / "ada").mkdir(parents=True)
    assert desk.take(begin()).why.code == "profile_exists"


def test_without_a_run_at_rest_nobody_is_asked(desk):
    desk.report = Report("ready")
    assert desk.take(begin()).why.code == "stop_first"
    desk.report = Report()
    desk.loaded.latent_dim = 3
    assert desk.take(begin()).why.code == "too_many_axes"
    desk.loaded.spec.run = None
    assert desk.take(begin()).why.code == "no_run"


class Instant:
    """A job that has learned at once."""

    def __init__(self, plan):
        self.plan = plan
        plan.out.mkdir(parents=True)
        (plan.out / "config.json").write_text("{}")
        self.state = Personalise(phase="learned", name=plan.name, answers=plan.questions)
        self.under_way = False

    def look(self):
        return self.state

    def end(self):
        pass


class Asking(Instant):
    """A job that waits for an answer."""

    def __init__(self, plan):
        super().__init__(plan)
        self.state = Personalise(phase="asking", name=plan.name)
        self.under_way = True


@pytest.fixture
def learned(desk, monkeypatch):
    """Ada was asked while bob's alignment was in use, and what was learned waits to be kept."""
    monkeypatch.setattr(personalising, "PersonaliseJob", Instant)
    desk.report = Report(profile="bob")
    assert desk.take(begin()).phase == "learned"
    return desk


TRY = PressPersonalise(type="try_alignment")
KEEP = PressPersonalise(type="keep_alignment")
DISCARD = PressPersonalise(type="discard_alignment")
CANCEL = PressPersonalise(type="cancel_personalise")


def test_what_was_learned_is_tried_and_kept(learned, run):
    learned.take(TRY)
    assert learned.control.orders == [ChooseProfile(name=TRIAL)]
    learned.report = Report("moving", TRIAL)
    assert learned.take(KEEP).why.code == "stop_first"
    learned.report = Report("disengaged", TRIAL)
    assert learned.take(KEEP).phase == "kept"
    assert learned.control.orders[1:] == [ChooseProfile(name="ada")]
    assert profile_names(run) == ("ada",)
    assert not trial_folder(run).exists()


def test_what_is_discarded_is_gone_and_all_is_as_before(learned, run):
    learned.take(TRY)
    assert learned.take(DISCARD) is None
    assert learned.control.orders[1:] == [ChooseProfile(name="bob")]
    assert profile_names(run) == ()
    assert not trial_folder(run).exists()


def test_a_name_taken_meanwhile_loses_nothing(learned, run):
    other = run / "profiles" / "ada"
    other.mkdir()
    (other / "config.json").write_text("{}")
    state = learned.take(KEEP)
    assert state.phase == "learned"
    assert "already exists" in state.why.text
    assert trial_folder(run).exists()


def test_another_run_has_no_use_for_it(learned, run, tmp_path):

    async def change():
        learned.loaded.spec.run = tmp_path / "other"
        assert learned.personalising.look() is None
        await learned.personalising.close()

    asyncio.run(change())
    assert not trial_folder(run).exists()


def test_nobody_drives_while_somebody_is_asked_and_an_end_leaves_nothing(desk, run, monkeypatch):
    monkeypatch.setattr(personalising, "PersonaliseJob", Asking)

    async def cancel():
        desk.take(begin())
        assert desk.control.stops, "an Enable that is on its way counts for nothing"
        assert desk.personalising.standstill.code == "asking"
        assert desk.take(begin("bob")).name == "ada", "one at a time"
        assert desk.take(CANCEL) is None
        await desk.personalising.close()

    asyncio.run(cancel())
    assert desk.personalising.standstill is None
    assert not trial_folder(run).exists()


class Refused(Instant):
    """A job that has learned nothing better."""

    def __init__(self, plan):
        super().__init__(plan)
        self.state = Personalise(phase="refused", name=plan.name, why=Notice(code="answers_unclear"))


def test_what_was_refused_cannot_be_tried_or_kept(desk, run, monkeypatch):
    monkeypatch.setattr(personalising, "PersonaliseJob", Refused)

    async def refuse():
        assert desk.take(begin()).phase == "refused"
        for message in (TRY, KEEP, DISCARD):
            assert desk.take(message).phase == "refused"
        assert desk.personalising.standstill is None
        assert desk.take(CANCEL) is None
        await desk.personalising.close()

    asyncio.run(refuse())
    assert desk.control.orders == []
    assert profile_names(run) == ()


def test_new_directions_are_judged_beside_those_from_before_a_trial(learned):
    assert learned.personalising._job.plan.profile == "bob"
    learned.take(TRY)
    learned.report = Report("disengaged", TRIAL)
    learned.take(begin("ada2").model_copy(update={"seat": "behind"}))
    assert learned.personalising._job.plan.profile == "bob"
    assert learned.personalising._job.plan.seat == "behind"


def test_being_asked_again_replaces_what_was_tried(learned, run):
    learned.take(TRY)
    learned.report = Report("disengaged", TRIAL)
    (trial_folder(run) / "old").touch()
    assert learned.take(begin("ada2")).name == "ada2"
    assert learned.control.orders[1:] == [ChooseProfile(name="bob")]
    assert not (trial_folder(run) / "old").exists()


# --- over the socket ---


@pytest.mark.slow
def test_only_the_driver_is_asked_and_nobody_drives_meanwhile(run, tmp_path, serve):
    with serve(Spec(run, out=tmp_path / "out")) as site, site.page() as ada, site.page("Bob") as bob:
        bob.send(**BEGIN)
        time.sleep(0.5)
        assert bob.learning["personalise"] is None
        ada.send(**BEGIN)
        wait_for(lambda: bob.learning["personalise"])
        assert bob.learning["personalise"]["name"] == "ada"
        bob.wait(lambda state: (state["note"] or {}).get("code") == "asking")
        ada.u = [0.0, 0.0]
        before = ada.state
        time.sleep(0.1)
        ada.send(type="enable")
        time.sleep(0.6)
        assert ada.state["phase"] == "disengaged"
        assert np.array_equal(before["tool"], ada.state["tool"])
        for message in ({"type": "cancel_personalise"}, {"type": "skip_question", "question": 1}):
            bob.send(**message)
        time.sleep(0.5)
        assert bob.learning["personalise"] is not None
        # The person's page is closed and opened again: the same is asked.
        wait_for(lambda: bob.learning["personalise"]["phase"] == "asking")
        ada.send(type="release")
        bob.send(type="ask_to_drive")
        bob.wait(lambda state: state["you"])
        motion = bob.learning["personalise"]["motion"]
        with site.page("Ada again") as back:
            wait_for(lambda: back.learning)
            assert back.learning["personalise"]["motion"] == motion
        bob.send(type="cancel_personalise")
        wait_for(lambda: bob.learning["personalise"] is None)
        bob.enable()


@pytest.mark.slow
def test_the_server_removes_what_was_not_kept(run, tmp_path, serve):
    with serve(Spec(run, out=tmp_path / "out")) as site, site.page() as ada:
        ada.send(**{**BEGIN, "questions": 6})
        asked = 0
        while (state := ada.learning["personalise"]) is None or state["phase"] != "learned":
            if state is not None and state["phase"] == "asking" and state["question"] > asked:
                asked = state["question"]
                u = rightwards(ShownMotion.model_validate_json(json.dumps(state["motion"])))
                ada.send(type="answer", question=asked, u=u)
            assert state is None or state["phase"] not in ("refused", "failed"), state["why"]
            time.sleep(0.02)
        ada.send(type="try_alignment")
        ada.wait(lambda state: state["profile"] == TRIAL)
        assert trial_folder(run).exists()
        assert ada.learning["profiles"] == []
    assert not trial_folder(run).exists()


# --- the schema ---


@pytest.mark.parametrize(
    "wrong",
    [
        {**BEGIN, "questions": 0},
        {**BEGIN, "questions": 31},
        {**BEGIN, "questions": "3"},
        {**BEGIN, "name": None},
        {**BEGIN, "name": "x" * 201},
        {**BEGIN, "run": "/etc"},
        {"type": "answer", "question": 1, "u": [1.5]},
        {"type": "answer", "question": 1, "u": []},
        {"type": "answer", "question": 1, "u": [None]},
        {"type": "answer", "question": -1, "u": [0.5]},
        {"type": "answer", "u": [0.5]},
        {"type": "skip_question", "question": 1, "u": [0.5]},
        {"type": "keep_alignment", "name": "bob"},
        {"type": "try_alignment", "name": "bob"},
    ],
)
def test_what_is_no_message_is_refused(wrong):
    with pytest.raises(ValueError):
        parse_message(json.dumps(wrong))
