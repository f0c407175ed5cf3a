"""What LeRobot asks of every robot and teleoperator, and ours have no use for."""


class NothingToCalibrate:
    """Members of a device that knows its own range, as an arm's driver and the kernel's joystick do."""

    @property
    def is_calibrated(self) -> bool:
        """Always."""
        return True

    def calibrate(self) -> None:
        """Nothing."""

    def configure(self) -> None:
        """Nothing."""
