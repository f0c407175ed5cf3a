"""A marshmallow stabbed, drawn through icing and dipped in rice: the paper's *Dessert*, in physics."""

from dataclasses import replace
from functools import partial
from typing import Final, final

import numpy as np

from latentarm.robots.scene.containers import bowl, packed
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Grains, Interior, Part, Thing
from latentarm.tasks.eating.fork_task import OFF_M, ForkTask, fallen
from latentarm.tasks.eating.stabbing import above, carried_over, stab
from latentarm.tasks.eating.table import MARSHMALLOW_HALF_M, STAND_M, at, marshmallow, plate
from latentarm.tasks.predicates import CarriedOver, Placed, Spilled, Swept, Within
from latentarm.tasks.scene_task import Beginning
from latentarm.tasks.steps import TaskStep, Waypoint

MIDDLE_M: Final = (0.50, 0.0)  # x and y of the marshmallow's plate
ICING_M: Final = (0.47, -0.21)  # of the icing, on the right
RICE_M: Final = (0.47, 0.21)  # of the rice, on the left
OWN_M: Final = (0.62, 0.0)  # of the person's own plate
SMALL_M: Final = 0.06  # radius of the two plates
SPREAD_M: Final = 0.02  # largest offset of the marshmallow along each axis
ICING_DEEP_M: Final = 0.035  # height of the icing over its dish; it gives way to everything
ICING_RADIUS_M: Final = 0.06
SWEEP_M: Final = 0.04  # way of the marshmallow through the icing
SCOOP_RAD: Final = 0.5  # tilt of the fork while it scoops
RICE: Final = 40  # grains of rice
RICE_RADIUS_M: Final = 0.005
SPILLED: Final = 0.5  # largest share of spilled rice
BOWL_RADIUS_M: Final = 0.045
BOWL_HEIGHT_M: Final = 0.035
WET: Final = Interior(ICING_RADIUS_M, 0.0, ICING_DEEP_M)  # the icing, in the frame of its dish
_ICING: Final = (0.93, 0.60, 0.70, 0.5)  # translucent
MARSHMALLOW: Final = "marshmallow"
NAMES: Final = (MARSHMALLOW, "icing", "rice bowl", "own plate")  # relevant things, in the order of need


@final
class Dessert(ForkTask):
    """Stab a marshmallow, scoop it through icing, dip it in rice, and set it down on the own plate."""

    name = "dessert"
    choices = (MARSHMALLOW,)
    time_limit_s = 180.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """The marshmallow at random near the middle of its plate."""
        x, y = np.array(MIDDLE_M) + rng.uniform(-SPREAD_M, SPREAD_M, 2)
        made = bowl(BOWL_RADIUS_M, BOWL_HEIGHT_M)
        dish = Thing("rice bowl", made.parts, 0.5, at(*RICE_M, STAND_M), fixed=True, interior=made.interior)
        rice = Grains(
            "rice",
            RICE_RADIUS_M,
            2e-4,
            packed(replace(made.interior, radius_m=BOWL_RADIUS_M), dish.pose, RICE, RICE_RADIUS_M),
            colour=(0.97, 0.96, 0.92, 1.0),
        )
        things = (
            plate("plate", *MIDDLE_M, SMALL_M),
            plate("own plate", *OWN_M, SMALL_M),
            icing("icing", *ICING_M),
            dish,
            marshmallow(MARSHMALLOW, float(x), float(y), rng.uniform(-np.pi, np.pi)),
        )
        scene = Scene(things, (rice,))
        room = dish.room
        return Beginning(
            state=self.start(rng),
            scene=scene,
            steps=_steps(room),
            failures=(*fallen(MARSHMALLOW), Spilled("rice", OFF_M, (("rice bowl", room),), SPILLED)),
            goals=self.goals(scene.thing(name) for name in NAMES),
            objects=NAMES,
            text="dip the marshmallow in icing and rice",
        )


def icing(name: str, x: float, y: float) -> Thing:
    """Icing on a plate, with its frame in the middle of the plate's top. Only the plate is solid."""
    size, middle = (WET.radius_m, (WET.top_m - WET.bottom_m) / 2), (WET.top_m + WET.bottom_m) / 2
    soft = Part("cylinder", size, (0.0, 0.0, middle), colour=_ICING)
    return replace(plate(name, x, y, ICING_RADIUS_M), soft=(soft,))


def _steps(rice: Interior) -> tuple[TaskStep, ...]:
    # Nearer to the base the tilted fork brings the arm to its limits.
    enter, leave = -0.025, 0.045
    swept = Swept(MARSHMALLOW, "icing", WET, SWEEP_M)
    low = MARSHMALLOW_HALF_M + 0.006
    over_it = partial(carried_over, food=MARSHMALLOW)
    through = (
        Waypoint(partial(over_it, thing="icing", height_m=0.07, tilt_rad=SCOOP_RAD, out_m=enter)),
        Waypoint(partial(over_it, thing="icing", height_m=low, tilt_rad=SCOOP_RAD, out_m=enter), speed=0.6),
        Waypoint(
            partial(over_it, thing="icing", height_m=low, tilt_rad=SCOOP_RAD, out_m=leave),
            speed=0.6,
            until=swept,
        ),
        Waypoint(partial(over_it, thing="icing", height_m=0.08, tilt_rad=SCOOP_RAD, out_m=leave)),
    )
    into = (
        Waypoint(partial(over_it, thing="rice bowl", height_m=0.09)),
        Waypoint(partial(over_it, thing="rice bowl", height_m=0.018), speed=0.4, wait_s=0.3),
    )
    # Drawn sideways out of the icing, the marshmallow would be scraped off on the dish.
    out = (through[-1], Waypoint(partial(over_it, thing="icing", height_m=0.10)))
    high = Waypoint(partial(over_it, thing="own plate", height_m=0.09))
    down = Waypoint(
        partial(over_it, thing="own plate", height_m=MARSHMALLOW_HALF_M + 0.006), wait_s=0.5, speed=0.5
    )
    centre = np.array([*OWN_M, STAND_M + MARSHMALLOW_HALF_M])
    laid = Placed(MARSHMALLOW, centre, np.array([0.8 * SMALL_M, 0.8 * SMALL_M, 0.015]), let_go=False)
    iced = CarriedOver(MARSHMALLOW, "icing", ICING_RADIUS_M)
    with_it = partial(TaskStep, holds=MARSHMALLOW)
    dipped = Interior(rice.radius_m, rice.bottom_m, rice.bottom_m + 0.025)
    over_rice, over_plate = (CarriedOver(MARSHMALLOW, over, 0.03) for over in ("rice bowl", "own plate"))
    return (
        above(MARSHMALLOW),
        stab(MARSHMALLOW),
        with_it("above", "icing", "over the icing", iced, through[:1]),
        with_it("scooped", "icing", "drawn through the icing", swept, through),
        with_it("above", "rice bowl", "over the rice", over_rice, (*out, *into[:1])),
        with_it("dipped", "rice bowl", "dipped in rice", Within(MARSHMALLOW, "rice bowl", dipped), into),
        with_it("above", "own plate", "over the own plate", over_plate, (*into[:1], high)),
        with_it("placed", "own plate", "set down", laid, (high, down)),
    )
