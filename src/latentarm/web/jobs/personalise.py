"""Asking a person on the page, and learning from their answers, in a child process."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Final, final

import numpy as np
from pydantic import Field, TypeAdapter

from latentarm.alignment.contract import Seat
from latentarm.runs.person import Kind, Question, Reply, Respondent
from latentarm.web.jobs.job import Job, Wire
from latentarm.web.protocol import personalise_messages as messages
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.personalise_messages import Personalise, QuestionReply, ShownMotion
from latentarm.web.protocol.scene import pose_of

_FRAMES: Final = 16  # poses along a motion; pages interpolate
_STILL_M: Final = 5e-4  # a tool that moves less is not shown

_REPLIES: Final[TypeAdapter[QuestionReply]] = TypeAdapter(
    Annotated[QuestionReply, Field(discriminator="type")]
)


@final
@dataclass(frozen=True)
class PersonalisePlan:
    """The person to ask, and the run to ask about."""

    run: Path
    name: str  # the person's
    questions: int  # maximum number of answers
    profile: str | None  # the directions that they have: whose alignment, or
    seat: Seat | None  # the frame of the stick for this seat
    out: Path  # the profile's folder, which does not exist yet


@final
class PersonaliseJob:
    """A person being asked, for the page's server."""

    def __init__(self, plan: PersonalisePlan) -> None:
        self._job = Job(ask_and_learn, (plan,), Personalise, "asking")
        self._state = Personalise(phase="preparing", name=plan.name, of=plan.questions)

    @property
    def under_way(self) -> bool:
        return self._state.phase not in ("learned", "refused", "failed")

    def look(self) -> Personalise:
        if not self.under_way:
            return self._state
        alive = self._job.alive  # read before its messages: a child that has ended sends no more
        for state in self._job.heard():
            self._state = state
        if not alive and self.under_way:
            failure = self._job.failure or Notice(code="work_broke_off")
            self._change(phase="failed", motion=None, why=failure)
        return self._state

    def reply(self, reply: QuestionReply) -> None:
        """Pass a reply on, if it belongs to the current question."""
        asked = self._state.phase == "asking" and reply.question == self._state.question
        # If the child does not accept it, the question stays for the person to answer again.
        if asked and self._job.say(reply):
            self._change(phase="thinking", motion=None, share=0.0)

    def end(self) -> None:
        """End it; waits two seconds at most."""
        self._job.end()

    def _change(self, **fields: object) -> None:
        self._state = self._state.model_copy(update=fields)


@final
class PersonOnPage(Respondent):
    """A person who sees motions on a page and answers there, through the parent process."""

    kind: ClassVar[Kind] = "person"

    def __init__(self, wire: Wire, plan: PersonalisePlan) -> None:
        self._wire = wire
        self._behind = 0
        self._state = Personalise(phase="preparing", name=plan.name, of=plan.questions)

    def say(self, **fields: object) -> None:
        self._state = self._state.model_copy(update=fields)
        self._wire.say(self._state)

    def answer(self, question: Question) -> Reply:
        """Wait for the page's answer, without a time limit."""
        self.say(
            phase="asking",
            question=self._state.question + 1,
            number=question.number,
            of=question.total,
            back=self._behind > 0,
            motion=shown_motion(question),
        )
        match self._wire.hear(_REPLIES):
            case messages.LeaveQuestion(type="question_before"):
                self._behind = max(self._behind - 1, 0)
                return "back"
            case messages.LeaveQuestion():
                self._behind += 1
                return None
            case messages.AnswerQuestion(u=u):
                self._behind += 1
                named = np.array(u)[: question.axes]
                return np.pad(named, (0, question.axes - len(named)))


def ask_and_learn(wire: Wire, plan: PersonalisePlan) -> None:
    """The child's work; what is no better than before is not saved.

    Raises UserError if the run cannot be aligned, nothing was answered, or the profile cannot be written.
    """
    # They take a second to load: in this process alone.
    from latentarm.alignment.profile import load_profile
    from latentarm.alignment.queries import StoppingRule
    from latentarm.assistance.controllers.latent import alignment_of
    from latentarm.runs.aligning import alignable, learn
    from latentarm.runs.questions import ask

    before = None if plan.profile is None else load_profile(plan.run, plan.profile)
    known = alignable(plan.run, 0 if before is None else before.seed_index)
    present = alignment_of(plan.run, before, known.scene.decoder, known.scene.chain, plan.seat)
    person = PersonOnPage(wire, plan)
    answers = ask(known.scene, person, plan.questions, lambda text: None, StoppingRule())
    person.say(phase="learning", motion=None)
    learned = learn(known, answers, plan.name, person.kind, present)
    judged = learned.judgement
    if judged.refusal is None:
        learned.save(plan.out)
    person.say(
        phase="learned" if judged.refusal is None else "refused",
        answers=len(answers),
        error=judged.learned,
        error_without=judged.present,
        share=1.0,
        why=None if judged.refusal is None else Notice(code=judged.refusal),
    )


def shown_motion(question: Question) -> ShownMotion:
    """A question's motion for a page to show, interpolated between its first and last state."""
    motion, chain = question.motion, question.chain
    share = np.linspace(0.0, 1.0, _FRAMES)[:, None]
    states = (1.0 - share) * motion.start[0] + share * motion.end[0]
    links = chain.link_transforms(states)
    poses = [pose_of(np.concatenate([np.eye(4)[None], one])) for one in links]
    ways = [chain.forward(states, tool).position for tool in range(len(chain.tools))]
    moving = [way for way in ways if np.linalg.norm(way[-1] - way[0]) > _STILL_M] or ways[:1]
    return ShownMotion(
        duration_s=motion.duration_s,
        frames=tuple(tuple(tuple(pose) for pose in np.round(frame, 4).tolist()) for frame in poses),
        tools=tuple(tuple((x, y, z) for x, y, z in np.round(way, 4).tolist()) for way in moving),
    )
