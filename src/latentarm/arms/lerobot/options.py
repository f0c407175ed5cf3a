"""Options in the address of a LeRobot arm: ``lerobot://TYPE?port=...&calibration=...``."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Self, final

from latentarm.arms.address import ArmAddress
from latentarm.core.errors import UserError


@final
@dataclass(frozen=True)
class Options:
    """The place of an arm, and LeRobot's names for it."""

    kind: str  # LeRobot's type of the robot, such as ``so101_follower``
    port: str  # serial port of its bus
    name: str  # LeRobot's id of the robot, the name of its calibration file
    folder: str | None  # of the calibration file; None for LeRobot's own

    @classmethod
    def of(cls, address: ArmAddress) -> Self:
        """Parse an address."""
        given = address.only("port", "id", "calibration")
        example = f"--arm lerobot://{address.host}?port=/dev/ttyACM0&calibration=FILE.json"
        if address.port is not None:
            raise UserError(f"LeRobot's arms have no network port: write {example}.")
        if not given.get("port"):
            raise UserError(f"--arm lerobot://{address.host} does not say the serial port: write {example}.")
        if ("id" in given) == ("calibration" in given):
            raise UserError(
                f"--arm lerobot://{address.host} needs the calibration, either by its file or by the id that"
                f" lerobot-calibrate was given: write {example}, or id=NAME instead."
            )
        if "id" in given:
            return cls(address.host, given["port"], given["id"], None)
        file = Path(given["calibration"])
        if file.suffix != ".json" or not file.is_file():
            raise UserError(
                f"{file} is no calibration file: lerobot-calibrate writes one that ends in .json."
            )
        return cls(address.host, given["port"], file.stem, str(file.parent.resolve()))

    def message(self) -> dict[str, object]:
        """Plain values, by name."""
        return asdict(self)
