"""Steering by learned latent actions."""

from dataclasses import replace
from pathlib import Path
from typing import final

from latentarm.alignment.contract import Alignment, Seat, identity
from latentarm.alignment.frame import StickFrame
from latentarm.alignment.frame_file import load_frame
from latentarm.alignment.profile import Profile, load_profile
from latentarm.assistance.controllers.contract import Controller
from latentarm.core.context import BELIEF, GRIPPER, ContextLayout, context_vector
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_WIDTH
from latentarm.models.decoder import Decoder
from latentarm.models.saving import load_decoder
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.robot import Robot


@final
class LatentController(Controller):
    """The person's input is a latent action, decoded in context: ``a_h = phi(f(u, c), c)``.

    Args:
        decoder: a trained decoder; it says which features its context consists of.
        alignment: from inputs to latent actions.

    Raises:
        UserError: the decoder learned of the gripper only whether it was toggled, which no arm measures.
    """

    def __init__(self, decoder: Decoder, alignment: Alignment = identity) -> None:
        source = decoder.layout.gripper
        if source not in ("", GRIPPER_WIDTH, ACTION_GRIPPER):
            raise UserError(
                f"The model learned the gripper from {source}, which no arm tells: import the recordings"
                f" again, with --robot, and train on that, or leave {GRIPPER} out of the context."
            )
        self._sees_target = source == ACTION_GRIPPER
        self._decoder = decoder
        self._features = decoder.layout.features
        self._alignment = alignment

    @property
    def modes(self) -> tuple[str, ...]:
        """One mode: latent actions need no switching."""
        return ("latent",)

    @property
    def input_dim(self) -> int:
        return self._decoder.latent_dim

    @property
    def objects(self) -> tuple[str, ...]:
        """The things that the decoder was trained with, in its order."""
        return self._decoder.layout.objects

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        return self._alignment(u, self._vector(context))

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """The decoder of equation 1.

        Raises:
            UserError: the decoder was trained for another arm or another number of goals.
        """
        return self._decoder.decode(z, self._vector(context))

    def speed_bound(self, context: Context, mode: int) -> float | None:
        """The bound of the decoder's enclosure; None with a person's alignment, whose z may leave [-1, 1]^d.

        Raises:
            UserError: the decoder was trained for another arm or another number of goals.
        """
        if self._alignment is not identity and not isinstance(self._alignment, StickFrame):
            return None
        enclosure = self._decoder.enclose(self._vector(context))
        return None if enclosure is None else float(enclosure.largest())

    def _vector(self, context: Context) -> FloatArray:
        """The context as the decoder was trained on it, (..., c)."""
        if self._sees_target:
            context = replace(context, gripper=context.gripper_target)
        vector = context_vector(context, self._features)
        if vector.shape[-1] != self._decoder.context_dim:
            raise UserError(_misfit(self._decoder.layout, context))
        return vector


def latent_controller(run: Path, profile: str | None, robot: Robot, seat: Seat | None) -> LatentController:
    """A controller by the latent actions of a run.

    A person's profile stands between input and latent action. Without one, the run's `StickFrame` turns the
    stick for a person in this seat; z = u without a seat, and where the run keeps no frame.

    Raises:
        UserError: the run has no such profile, its model is broken, or it is for another arm.
    """
    person = None if profile is None else load_profile(run, profile)
    decoder = load_decoder(run, 0 if person is None else person.seed_index)
    if decoder.action_dim != robot.dof:
        raise UserError(
            f"{run} was trained for {decoder.action_dim} joints and the robot {robot.name} has {robot.dof}."
        )
    return LatentController(decoder, alignment_of(run, person, decoder, robot.chain, seat))


def alignment_of(
    run: Path, person: Profile | None, decoder: Decoder, chain: Chain, seat: Seat | None
) -> Alignment:
    """The alignment that `latent_controller` uses; raises UserError as it does."""
    if person is not None:
        return person.alignment(decoder, chain)
    frame = None if seat is None else load_frame(run, 0, seat, chain)
    return frame or identity


def _misfit(layout: ContextLayout, context: Context) -> str:
    """The message for a context of other sizes than those in training."""
    parts = [f"{layout.joints} joints"]
    if BELIEF in layout.features:
        parts.append(f"{layout.goals} goals")
    if GRIPPER in layout.features:
        parts.append("a gripper")
    if layout.objects:
        parts.append(f"{len(layout.objects)} things ({', '.join(layout.objects)})")
    return (
        f"The model was trained with {', '.join(parts)}, and here are {context.state.shape[-1]} joints,"
        f" {len(context.belief)} goals, {len(context.gripper)} grippers and {len(context.objects)} things:"
        " use a model trained for this arm, these goals and these things."
    )
