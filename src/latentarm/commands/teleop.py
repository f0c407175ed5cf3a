"""`latentarm teleop`: the web page."""

import json as json_format
from functools import partial
from pathlib import Path
from typing import Annotated, Final

from tyro.conf import Positional, UseAppendAction, arg

from latentarm.arms.address import is_address
from latentarm.commands.configuration import write_options
from latentarm.commands.doctor import lines_of
from latentarm.commands.options import AnyArm, JointSpeed, LimitsFile, LinkSpeed, Seated, ZonesFile
from latentarm.commands.output import draws_blocks, say
from latentarm.core.machine import examine_machine
from latentarm.runs.options import EndEffector, Json, Seed, TaskName

_LOOK_S: Final = 0.5  # pauses of this computer are measured for so long before a real arm is driven, s


def teleop(
    run: Annotated[
        Positional[Path | None],
        arg(metavar="RUN", help="A trained run; without one, the end-effector is driven."),
    ] = None,
    host: Annotated[
        str, arg(help="The address to serve; from other machines people need a link that works once.")
    ] = "127.0.0.1",
    port: Annotated[int, arg(help="Port; 0 takes any free one.")] = 8460,
    profile: Annotated[str | None, arg(metavar="NAME", help="Profile made by `latentarm align`.")] = None,
    seat: Seated = None,
    certfile: Annotated[Path | None, arg(metavar="PEM", help="Certificate for TLS.")] = None,
    keyfile: Annotated[Path | None, arg(metavar="PEM", help="Its private key.")] = None,
    public_url: Annotated[
        str | None,
        arg(
            metavar="URL",
            help="The address that people open where a proxy serves the page, such as https://arm.example;"
            " see `latentarm guide deploy`.",
        ),
    ] = None,
    arm: AnyArm = None,
    robot: Annotated[
        str | None,
        arg(
            help="A robot's name or the path of an MJCF or URDF file; by default that of the run or, for a"
            " simulated arm, of the task."
        ),
    ] = None,
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    zones: ZonesFile = None,
    joint_speed: JointSpeed = None,
    link_speed: LinkSpeed = None,
    task: Annotated[
        TaskName | None,
        arg(help="What the arm is driven at; the run's own task, or a table, where none is named."),
    ] = None,
    seed: Seed = 0,
    out: Annotated[Path, arg(metavar="DIR", help="Folder for what is recorded.")] = Path("teleop"),
    most_gb: Annotated[
        float, arg(metavar="GB", help="End the recording when its journal reaches this size.")
    ] = 4.0,
    keep_free_gb: Annotated[
        float, arg(metavar="GB", help="End the recording when less than this is free on the disk.")
    ] = 0.5,
    camera: Annotated[
        UseAppendAction[tuple[str, ...]],
        arg(
            metavar="NAME=ADDRESS",
            help="A camera for the page, up to 4: front=/dev/video0, side=rtsp://HOST/PATH, a video file, or"
            " testsrc, a test pattern.",
        ),
    ] = (),
    incidents: Annotated[
        bool, arg(help="Keep what the arm was told in the last hours in incidents/ of --out (512 MB).")
    ] = True,
    shadow: Annotated[
        bool,
        arg(help="Read a real arm and send it nothing: commands are only computed, drawn and recorded."),
    ] = False,
    objects: Annotated[
        UseAppendAction[tuple[str, ...]],
        arg(
            metavar="SOURCE",
            help="Where things are: http:PORT takes what a detector posts, touch what a person shows with the"
            " tool, the default for a real arm; see `latentarm guide objects`. Several are joined.",
        ),
    ] = (),
    idle_minutes: Annotated[
        float, arg(metavar="MIN", help="Disable the arm when nobody has given an input for so long.")
    ] = 2.0,
    lock_setup: Annotated[
        bool,
        arg(help="Nobody changes anything in Settings, teaches or personalises; people keep their settings."),
    ] = False,
    pin: Annotated[bool, arg(help="People may protect their records by a PIN.")] = False,
    json: Json = False,
) -> int:
    """Drive an arm from a web page, simulated or real: stick, buttons, keyboard, gamepad or switches.

    Prints the page's address; Ctrl-C ends it. For example: latentarm teleop runs/pour-cae
    """
    from latentarm.cameras.sources import kept, parse_cameras
    from latentarm.commands.zone_check import zones_for
    from latentarm.core.journal_limits import JournalLimits
    from latentarm.web.arm_process.drive_setup import Spec
    from latentarm.web.arm_process.idle_limit import idle_s_of
    from latentarm.web.arm_process.initial_state import RobotOptions
    from latentarm.web.arm_process.speed_limits import Speeds
    from latentarm.web.server.app import serve
    from latentarm.web.server.config import TeleopConfig

    cameras = parse_cameras(camera)

    def ready(address: str) -> None:
        write_options(out, "teleop", camera=kept(camera))
        if json:
            print(json_format.dumps({"address": address}), flush=True)

    room = JournalLimits.of_gigabytes(most_gb, keep_free_gb)
    named = RobotOptions(robot, end_effector, limits)
    speeds = Speeds.asked(joint_speed, link_speed)
    stated = zones_for(zones, speeds)
    spec = Spec(
        run,
        profile,
        seed,
        out,
        room,
        arm,
        task,
        robot=named,
        zones=stated.slow,
        keep_out=stated.keep_out,
        gripped=stated.gripped,
        speeds=speeds,
        incidents=incidents,
        seat=seat,
        shadow=shadow,
        idle_s=idle_s_of(idle_minutes),
        objects=tuple(objects),
    )
    if arm is not None and is_address(arm):
        found = [one for one in examine_machine(out, room.least_free_bytes, _LOOK_S) if one.level != "good"]
        for line in lines_of(found):
            say(f"This computer: {line}", json)
    config = TeleopConfig(spec, host, port, certfile, keyfile, pin, cameras, lock_setup, public_url)
    serve(config, partial(say, json=json), ready, draws=draws_blocks())
    return 0
