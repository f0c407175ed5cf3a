"""The figures that docs/tasks.md states are those of the tasks."""

import re

import numpy as np
import pytest

from documentation import ROOT
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.eating import dessert, entree
from latentarm.tasks.eating.stabbing import LIFTED_M as STABBED_M
from latentarm.tasks.eating.table import MARSHMALLOW
from latentarm.tasks.predicates import Lifted, Poured, Pressed, Spilled, Swept
from latentarm.tasks.serving.cup_steps import LIFTED_M as TAKEN_M
from latentarm.tasks.steps import FINE_M, FINE_RAD, PATIENCE_S
from latentarm_research.drives.demonstrate import GRASP_N
from latentarm_research.drives.drive import REARM_S
from latentarm_research.metrics.ending import STUCK_S

PAGE = (ROOT / "docs/tasks.md").read_text()
FIGURE = re.compile(r"(\d+(?:\.\d+)?) ?(cm|mm|N|%|°|rad|s)(?!\w)")
ROW = re.compile(r"^\| `(\w+)` \|(.+)\|$", re.MULTILINE)
SHARES = {0.25: "more than a quarter", 0.5: "half"}

VARIED = {
    "entree": {(100 * entree.SPREAD_M, "cm"), (entree.TURN_RAD, "rad")},
    "dessert": {(100 * dessert.SPREAD_M, "cm")},
}


def stated(text):
    """Every number that has a unit."""
    return {(float(number), unit) for number, unit in FIGURE.findall(text)}


def figures_of(condition, kind=""):
    """The figures of a condition that ends a step, or of a failure."""
    match condition:
        case Lifted():
            return {(100 * (STABBED_M if kind == "stabbed" else TAKEN_M), "cm")}
        case Poured():
            return {(100 * condition.share, "%")}
        case Swept():
            return {(100 * condition.length_m, "cm")}
        case Pressed():
            return {(condition.most_n, "N")}
        case _:
            return set()


def section(heading):
    return PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]


def rounded(figures):
    return {(round(number, 6), unit) for number, unit in figures}


@pytest.mark.parametrize("name", SCENE_TASKS)
def test_a_row_of_the_table_says_what_the_task_says(name):
    task = make_scene_task(name)
    steps, wrong, time, varies = dict(ROW.findall(PAGE))[name].split("|")
    begun = [task.begin(choice, np.random.default_rng(0)) for choice in range(len(task.choices))]
    done = [figures_of(step.done, step.kind) for one in begun for step in one.steps]
    failures = [fails for one in begun for fails in one.failures]
    assert stated(steps) <= rounded(set.union(*done))
    assert stated(wrong) <= set.union(*(figures_of(fails) for fails in failures))
    assert stated(time) == {(task.time_limit_s, "s")}
    assert stated(varies) <= rounded(VARIED.get(name, set()))
    spilled = {SHARES[fails.share] for fails in failures if isinstance(fails, Spilled)}
    assert {words for words in SHARES.values() if words in wrong} == spilled


def test_what_holds_food_and_what_parts_it_is_as_the_page_says():
    foods = (MARSHMALLOW, entree.TOFU)
    bond = entree.cut_between()
    way = bond.depth_m / (2 * entree.HALF_M[2])
    assert stated(section("What holds what")) == rounded(
        {
            (GRASP_N, "N"),
            (SafetyConfig().gripper_force, "N"),
            *((food.pierce_n, "N") for food in foods),
            *((food.grip_n, "N") for food in foods),
            *((1000 * food.depth_m, "mm") for food in foods),
            (float(np.rad2deg(bond.angle_rad)), "°"),
            (100 * way, "%"),
            (100 * dessert.SWEEP_M, "cm"),
        }
    )


def test_a_drive_ends_and_a_stopped_arm_goes_on_when_the_page_says():
    prose = "\n".join(line for line in section("How a task is done").splitlines() if line[:1] != "|")
    fine = {(1000 * FINE_M, "mm"), (FINE_RAD, "rad")}
    assert stated(prose) == {(STUCK_S, "s"), (REARM_S, "s"), (PATIENCE_S, "s"), *fine}
