"""Stabbing and cutting food with tines, and their edge."""

from typing import Final, Literal, final

import mujoco
import numpy as np

from latentarm.arms.scene_model import SOLID, TINE, bond_name, rotation_of, stab_name, thing_body
from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Bond, Food, Part, Thing
from latentarm.robots.tines import TINES_BODY, Tines

CUT_WITHIN_M: Final = 0.01
"""An edge cuts a bond whose plane it is this near to, m; over the top and past the sides of it as well."""

_SPACING_M: Final = 0.001  # of the sampled points on tines
_CLEAR_M: Final = 0.003  # food collides with tines again this far out of it: more than they are thick
_EQUALITY: Final = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
_Way = Literal["whole", "entered", "held", "loose", "parting"]
"""How a food is with the tines.

- *whole*: they do not enter it.
- *entered*: they may, and it may come to be held.
- *held*: it is on them.
- *loose*: it was pulled off, and is held no more until they are out of it.
- *parting*: their edge goes through it.
"""


@final
class TinesInFood:
    """Applies the rules of tines and food to a scene, every few time steps.

    *Stab.* Food collides with tines until their contact presses along them with `Food.pierce_n`: then they go
    in, and no longer collide with it. Once one is `Food.depth_m` deep in it, counted along the tine, a weld
    holds it in place. The weld breaks when something pulls it off along the tines with more than
    `Food.grip_n`: its own weight and inertia, or a rim. Pressed on with more than `Food.pierce_n`, the tines
    go deeper, and still hold it. Food that was pulled off cannot be held again before all tines have left it,
    and then collides with them again. With everything else food collides all the time.

    *Cut.* An edge goes through two bonded foods without collision while it lies in the plane of their bond:
    turned out of it by no more than `Bond.angle_rad`, and its middle within `CUT_WITHIN_M` of the cut. The
    bond ends when an end of the edge is `Bond.depth_m` below the top of the first food, along its own
    vertical. An edge in any other position collides, and may stab.

    This changes the collision bits of food in the model, and the active welds in the data.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, tines: Tines, scene: Scene) -> None:
        self._model, self._data, self._tines = model, data, tines
        self._body = model.body(TINES_BODY).id
        self._tine_geoms = model.geom_bodyid == self._body
        depths = np.arange(0.0, tines.length_m, _SPACING_M)
        back = np.stack([np.zeros_like(depths), np.zeros_like(depths), -depths], axis=1)
        self._points = tines.tips[:, None] + back
        self._foods = [_Served(model, one, one.food) for one in scene.things if one.food and not one.fixed]
        by_name = {food.thing.name: food for food in self._foods}
        self._bonds = [_Joined(bond, scene, model, by_name) for bond in scene.bonds]

    @property
    def stabbed(self) -> frozenset[str]:
        """Names of the food on the tines."""
        return frozenset(food.thing.name for food in self._foods if food.way == "held")

    @property
    def bonds(self) -> frozenset[tuple[str, str]]:
        """Pairs of names that nothing has cut apart."""
        return frozenset((one.bond.first, one.bond.second) for one in self._bonds if not one.cut)

    def look(self) -> None:
        """Apply the rules."""
        data = self._data
        place, turn = data.xpos[self._body].copy(), data.xmat[self._body].reshape(3, 3).copy()
        for joined in self._bonds:
            if not joined.cut:
                self._part(joined, place, turn)
        for food in self._foods:
            if food.way == "whole":
                if self._pressed(food, turn[:, 2]) >= food.food.pierce_n:
                    self._let_in(food, "entered")
            else:
                self._inside(food, place, turn)

    def _inside(self, food: "_Served", place: FloatArray, turn: FloatArray) -> None:
        if food.way == "held":
            pull = self._pull(food, turn[:, 2])
            if pull > food.food.grip_n:
                self._data.eq_active[food.weld] = 0
                food.way = "loose"
            elif pull < -food.food.pierce_n:
                self._hold(food, place, turn)
            return
        points = (self._points @ turn.T + place - self._data.xpos[food.body]) @ self._data.xmat[
            food.body
        ].reshape(3, 3)
        within = food.contains(points, 0.0)
        if not within.any() and not food.contains(points, _CLEAR_M).any():
            if food.way != "parting" or not self._aligned(food, place, turn):
                self._model.geom_conaffinity[food.geoms] = SOLID | TINE
                food.way = "whole"
        elif food.way == "entered" and within.sum(axis=1).max() * _SPACING_M >= food.food.depth_m:
            self._hold(food, place, turn)

    def _part(self, joined: "_Joined", place: FloatArray, turn: FloatArray) -> None:
        if not joined.aligned(self._data, place, turn[:, 1]):
            return
        for food in joined.foods.values():
            if food.way == "whole":
                self._let_in(food, "parting")
        if joined.depth(self._data, place, turn[:, 1] * self._tines.edge_half_m) >= joined.bond.depth_m:
            self._data.eq_active[joined.weld] = 0
            joined.cut = True

    def _aligned(self, food: "_Served", place: FloatArray, turn: FloatArray) -> bool:
        return any(
            not one.cut and food.thing.name in one.foods and one.aligned(self._data, place, turn[:, 1])
            for one in self._bonds
        )

    def _let_in(self, food: "_Served", way: _Way) -> None:
        self._model.geom_conaffinity[food.geoms] = SOLID
        food.way = way

    def _hold(self, food: "_Served", place: FloatArray, turn: FloatArray) -> None:
        """Weld food to the tines in its present pose."""
        data, weld = self._data, food.weld
        quaternion = np.empty(4)
        relative = turn.T @ data.xmat[food.body].reshape(3, 3)
        mujoco.mju_mat2Quat(quaternion, relative.ravel())
        settings = self._model.eq_data[weld]
        settings[:3] = 0.0
        settings[3:6] = turn.T @ (data.xpos[food.body] - place)
        settings[6:10] = quaternion
        data.eq_active[weld] = 1
        food.way = "held"

    def _pressed(self, food: "_Served", along: FloatArray) -> float:
        """Force of tines on a food, along themselves, N."""
        if not self._data.ncon:
            return 0.0
        contact = self._data.contact
        geoms, address = contact.geom, contact.efc_address
        mine = self._tine_geoms[geoms].any(axis=1) & food.owns[geoms].any(axis=1) & (address >= 0)
        if not mine.any():
            return 0.0
        return float(self._data.efc_force[address[mine]] @ np.abs(contact.frame[mine, :3] @ along))

    def _pull(self, food: "_Served", along: FloatArray) -> float:
        """Force that pulls a held food off along the tines, N."""
        rows = np.flatnonzero((self._data.efc_type == _EQUALITY) & (self._data.efc_id == food.weld))
        # The first three rows are the force that the food exerts on the tines, in the base frame.
        return float(self._data.efc_force[rows[:3]] @ along) if len(rows) else 0.0


@final
class _Served:
    def __init__(self, model: mujoco.MjModel, thing: Thing, food: Food) -> None:
        self.thing, self.food = thing, food
        self.body = model.body(thing_body(thing.name)).id
        self.owns = model.geom_bodyid == self.body
        self.geoms: IntArray = np.flatnonzero(self.owns)
        self.weld = model.equality(stab_name(thing.name)).id
        self.way: _Way = "whole"

    def contains(self, points: FloatArray, margin_m: float) -> BoolArray:
        """Whether points (..., 3) in its frame are in it or this near."""
        inside = np.zeros(points.shape[:-1], dtype=np.bool_)
        for part in self.thing.parts:
            inside |= _within(part, points, margin_m)
        return inside


@final
class _Joined:
    def __init__(self, bond: Bond, scene: Scene, model: mujoco.MjModel, foods: dict[str, _Served]) -> None:
        self.bond = bond
        self.foods = {name: foods[name] for name in (bond.first, bond.second) if name in foods}
        self.weld = model.equality(bond_name(bond)).id
        self.cut = False
        self._body = model.body(thing_body(bond.first)).id
        self._normal, self._point = np.array(bond.normal), np.array(bond.point)
        corners = np.concatenate([_corners(part) for part in scene.thing(bond.first).parts])
        self._low, self._high = corners.min(axis=0) - CUT_WITHIN_M, corners.max(axis=0) + CUT_WITHIN_M
        self._top = float(corners[:, 2].max())
        self._sine = float(np.sin(bond.angle_rad))

    def aligned(self, data: mujoco.MjData, middle: FloatArray, across: FloatArray) -> bool:
        frame = data.xmat[self._body].reshape(3, 3)
        local = frame.T @ (middle - data.xpos[self._body])
        return bool(
            abs(self._normal @ (local - self._point)) <= CUT_WITHIN_M
            and abs(self._normal @ (frame.T @ across)) <= self._sine
            and (local >= self._low).all()
            and (local <= self._high).all()
        )

    def depth(self, data: mujoco.MjData, middle: FloatArray, half: FloatArray) -> float:
        """Depth of an edge's lower end below the top, m."""
        up = data.xmat[self._body].reshape(3, 3)[:, 2]
        lowest = up @ (middle - data.xpos[self._body]) - abs(up @ half)
        return self._top - float(lowest)


def _within(part: Part, points: FloatArray, margin_m: float) -> BoolArray:
    """Whether points (..., 3) of a thing's frame are in a part of it, or this near."""
    local = (points - part.position) @ rotation_of(np.array(part.quaternion))
    if part.shape == "box":
        return (np.abs(local) - part.size).max(axis=-1) <= margin_m
    if part.shape == "sphere":
        return np.linalg.norm(local, axis=-1) <= part.size[0] + margin_m
    radius, half = part.size
    radius += margin_m
    out, height = np.hypot(local[..., 0], local[..., 1]), np.abs(local[..., 2])
    if part.shape == "cylinder":
        return (out <= radius) & (height <= half + margin_m)
    return np.hypot(out, np.maximum(height - half, 0.0)) <= radius


def _corners(part: Part) -> FloatArray:
    """(8, 3), corners of the box around a part, in the thing's frame, m."""
    size = part.size
    if part.shape == "box":
        half = np.array(size)
    elif part.shape == "sphere":
        half = np.full(3, size[0])
    else:
        cap = size[0] if part.shape == "capsule" else 0.0
        half = np.array([size[0], size[0], size[1] + cap])
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return (signs * half) @ rotation_of(np.array(part.quaternion)).T + part.position
