"""Arms that a person can move by hand, to show a motion."""

from abc import ABC, abstractmethod

from latentarm.arms.real import RealArm


class GuidableArm(RealArm, ABC):
    """A real arm that carries its own weight while a person moves it by hand.

    `guide` asks a disabled arm for that. While `status` says *guided*, the arm goes only where it is pushed,
    though it may sag under a load that it does not know of. `disable` and `close` end it, and so do an
    emergency stop, a fault and a lost connection: the arm then holds its position, and `status` says *guided*
    until it does. It ignores what it is sent by `send`.
    """

    @abstractmethod
    def guide(self) -> None:
        """Ask a disabled arm to be moved by hand; `status` says when it can be.

        Nothing happens in any other phase. Asked twice, it is asked once.

        Raises:
            UserError: it cannot be asked for from here; the sentence says what to do at the arm.
        """
