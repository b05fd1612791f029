"""Checks the proof of a bound or of infeasibility: multipliers in, the least value of the Lagrangian out.

The unknowns are positions of base and feet, angles, and forces of the feet in contact. The equations (ends, rest in
stance, Newton, moments) are kept; every inequality is replaced by its multiplier. What is left is one linear system.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from surefoot.verify.footholds.file import Array, FootholdFile
from surefoot.verify.footholds.legs import half_space
from surefoot.verify.footholds.rows import Surface, jacobians, nominal, references, start_surface, surfaces, windows
from surefoot.verify.footholds.weighing import Tally, place_in, rounded


class Lagrangian:
    """The cost and the equations of a plan's problem.

    Args:
        plan: whose values are used; its motion is not.
    """

    def __init__(self, plan: FootholdFile) -> None:
        self.plan = plan
        self.ground: list[Surface] = surfaces(plan)
        self.base_reference, self.angle_reference, self.turns = references(plan)
        size = len(plan.contacts)
        self.base = np.arange(3 * size).reshape(size, 3)
        self.angle = self.base + 3 * size
        self.feet = np.arange(6 * size, 18 * size).reshape(size, 4, 3)
        held = int(plan.contacts.sum())
        self.force = np.full((size, 4, 3), -1)
        self.force[plan.contacts] = np.arange(18 * size, 18 * size + 3 * held).reshape(held, 3)
        self.count = 18 * size + 3 * held
        self.hessian, self.linear, self.constant = self._cost()
        equations, right = self._equations()
        self.right = right
        self.equations = equations
        self.solver = splu(sp.bmat([[self.hessian, equations.T], [equations, None]], format="csc"))
        self.normal = splu(sp.csc_matrix(equations @ equations.T))
        self.centre = self.solver.solve(np.concatenate([-self.linear, right]))[: self.count]
        self.centre_cost = self.value(self.centre)

    def value(self, unknowns: Array) -> float:
        """Return the cost of given unknowns."""
        return float(unknowns @ (self.hessian @ unknowns) / 2 + self.linear @ unknowns + self.constant)

    def least(self, tilt: Tally, shift: Tally) -> float:
        """Return the least value of cost + tilt @ unknowns + shift below the equations; minus infinity if it is none.

        Only the part of the tilt along the equations moves the minimum away from the centre. It is split off first,
        as rays are huge across the equations and next to nothing along them.
        """
        along = tilt.sum.copy()
        for _ in range(3):
            along = along - self.equations.T @ self.normal.solve(self.equations @ along)
        away = self.solver.solve(np.concatenate([-along, np.zeros(len(self.right))]))[: self.count]
        found = self.centre_cost + float(tilt.sum @ self.centre) + float(shift.sum[0]) + float(along @ away) / 2
        found -= rounded(float(shift.size[0] + tilt.size @ (1.0 + np.abs(self.centre))))
        return found if np.isfinite(found) else -np.inf

    def _second(self) -> sp.csr_matrix:
        """Return second differences over samples, for what is at rest at sample 0; row 0 is empty."""
        size = len(self.plan.contacts)
        matrix = sp.lil_matrix((size, size))
        for i in range(1, size):
            matrix[i, i] = 1.0
            matrix[i, i - 1] = -2.0 if i > 1 else -1.0
            if i > 1:
                matrix[i, i - 2] = 1.0
        return sp.csr_matrix(matrix) / self.plan.number("step_s") ** 2

    def _newton(self) -> sp.csr_matrix:
        """Return the matrix that adds up the forces at every sample and axis, over the mass."""
        size = len(self.plan.contacts)
        i, j = np.nonzero(self.plan.contacts)
        rows = (3 * i[:, None] + np.arange(3)).ravel()
        columns = self.force[i, j].ravel()
        mass = float(self.plan.values["robot"]["mass_kg"])
        return sp.csr_matrix((np.full(len(rows), 1.0 / mass), (rows, columns)), shape=(3 * size, self.count))

    def _cost(self) -> tuple[sp.csc_matrix, Array, float]:
        weights = {name: float(w) for name, w in self.plan.values["weights"].items()}
        size = len(self.plan.contacts)
        feet = self.base_reference[:, None] + np.einsum("iab,jb->ija", self.turns, nominal(self.plan))
        second = self._second()
        angle_rate = self._spread(second, self.angle)
        foot_rate = sp.vstack([self._spread(second, self.feet[:, j]) for j in range(4)])
        down = np.tile([0.0, 0.0, -self.plan.number("gravity_mps2")], size)
        identity = sp.identity(self.count, format="csr")
        blocks: list[tuple[float, Any, Array]] = [
            (weights["position"], identity[self.base.ravel()], self.base_reference.ravel()),
            (weights["orientation"], identity[self.angle.ravel()], self.angle_reference.ravel()),
            (weights["foot"], identity[self.feet.ravel()], feet.ravel()),
            (weights["acceleration"], self._newton(), -down),
            (weights["angular_acceleration"], angle_rate, np.zeros(3 * size)),
            (weights["foot_acceleration"], foot_rate, np.zeros(12 * size)),
            (weights["force"], identity[18 * size :], np.zeros(self.count - 18 * size)),
        ]
        hessian = sp.csc_matrix((self.count, self.count))
        linear, constant = np.zeros(self.count), 0.0
        for weight, matrix, target in blocks:
            hessian = hessian + 2 * weight * (matrix.T @ matrix)
            linear -= 2 * weight * (matrix.T @ target)
            constant += weight * float(target @ target)
        return sp.csc_matrix(hessian), linear, constant

    def _spread(self, second: sp.csr_matrix, index: np.ndarray) -> sp.csr_matrix:
        """Return second differences of a quantity of shape (N, 3) over all unknowns, rows by sample and axis."""
        entries = second.tocoo()
        rows = (3 * entries.row[:, None] + np.arange(3)).ravel()
        columns = index[entries.col].ravel()
        return sp.csr_matrix((np.repeat(entries.data, 3), (rows, columns)), shape=(index.size, self.count))

    def _equations(self) -> tuple[sp.csr_matrix, Array]:
        plan, values = self.plan, self.plan.values
        identity = sp.identity(self.count, format="csr")
        size = len(plan.contacts)
        blocks, right = [], []

        def pin(index: np.ndarray, value: Any) -> None:
            blocks.append(identity[np.asarray(index).ravel()])
            right.append(np.asarray(value, dtype=float).ravel())

        for index, key in ((self.base, "position_m"), (self.angle, "rpy_rad")):
            pin(index[0], values["start"][key])
            pin(index[-1], values["goal"][key])
            pin(index[-2], values["goal"][key])
        pin(self.feet[0], values["start"]["feet_m"])
        i, j = np.nonzero(plan.contacts[1:])
        blocks.append(identity[self.feet[i + 1, j].ravel()] - identity[self.feet[i, j].ravel()])
        right.append(np.zeros(3 * len(i)))
        newton = self._spread(self._second(), self.base) - self._newton()
        blocks.append(newton[3:])
        right.append(np.tile([0.0, 0.0, -plan.number("gravity_mps2")], size - 1))
        if values["options"]["moment_balance"]:
            matrix = self._moments()
            blocks.append(matrix)
            right.append(np.zeros(matrix.shape[0]))
        return sp.vstack(blocks, format="csr"), np.concatenate(right)

    def _moments(self) -> sp.csr_matrix:
        inertia = np.diag(np.array(self.plan.values["robot"]["inertia_kgm2"], dtype=float))
        second = self._spread(self._second(), self.angle)
        size = len(self.plan.contacts)
        spin = sp.block_diag([turn @ inertia @ turn.T for turn in self.turns], format="csr") @ second
        arms = np.einsum("iab,jb->ija", self.turns, nominal(self.plan))
        matrix = sp.lil_matrix((3 * size, self.count))
        for i, j in np.argwhere(self.plan.contacts):
            x, y, z = arms[i, j]
            matrix[3 * i : 3 * i + 3, self.force[i, j]] = -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return sp.csr_matrix(spin + sp.csr_matrix(matrix))


def proved_bound(plan: FootholdFile) -> tuple[float, str]:
    """Return the bound that the file's proof really proves, and what is wrong with it (empty when nothing is)."""
    from surefoot.verify.footholds.reach import left_to_steps

    if plan.proof is None:
        return -np.inf, "there is no proof"
    left = left_to_steps(plan)
    if left is None:
        return np.inf, ""
    root = [tuple(int(r) for r in ids) for ids in plan.proof["root"]]
    regions = tuple(range(len(plan.values["free_regions"])))
    boxes = 4 * int(plan.values["options"]["collision_windows"]) if plan.values["options"]["collision"] else 0
    if len(root) != len(plan.steps) + boxes:
        return -np.inf, "the root is not one set for every footstep and window"
    for number, ids in enumerate(root):
        needed = left[number] if number < len(plan.steps) else regions
        if not set(needed) <= set(ids):
            return -np.inf, f"the root leaves out what footstep or window {number} may reach"
    leaves, problem = _leaves(plan.proof["tree"], root)
    if problem:
        return -np.inf, problem
    lagrangian = Lagrangian(plan)
    bound = np.inf
    for proof, choice in leaves:
        if not 0 <= proof < len(plan.proof["multipliers"]):
            return -np.inf, ""
        tilt, shift, problem = tilted(lagrangian, plan.proof["multipliers"][proof], plan.proof["turning"], choice)
        if problem:
            return -np.inf, problem
        bound = min(bound, lagrangian.least(tilt, shift))
    return bound, ""


def _leaves(tree: list[Any], root: list[tuple[int, ...]]) -> tuple[list[tuple[int, list[tuple[int, ...]]]], str]:
    """Return the leaves of the tree, each with what is left in it; a split has to leave nothing out."""
    leaves, pending, seen = [], [(0, root)], 0
    while pending:
        place, left = pending.pop()
        seen += 1
        if seen > len(tree):
            return [], "the tree is no tree"
        node = tree[place]
        if "children" not in node:
            leaves.append((int(node["leaf"]), left))
            continue
        (split,) = place_in([node["split"]], len(left))
        parts = [tuple(int(r) for r in child["left"]) for child in node["children"]]
        if not set(left[split]) <= {r for part in parts for r in part}:
            return [], f"the split of node {place} leaves something out"
        for part, child in zip(parts, node["children"], strict=True):
            pending.append((int(child["node"]), [*left[:split], part, *left[split + 1 :]]))
    return leaves, ""


def tilted(
    lagrangian: Lagrangian, kept: dict[str, Any], turning: list[Any], choice: list[tuple[int, ...]]
) -> tuple[Tally, Tally, str]:
    """Return what multipliers add to the cost: a linear form, a constant, and what is wrong with them."""
    weigher = _Weigher(lagrangian, choice)
    weigher.bodily(kept, turning)
    weigher.footholds(kept.get("region", []))
    weigher.forces(kept.get("friction", []), kept.get("torque", []))
    return weigher.tilt, weigher.shift, weigher.problem


class _Weigher:
    def __init__(self, lagrangian: Lagrangian, choice: list[tuple[int, ...]]) -> None:
        self.lagrangian, self.plan, self.choice = lagrangian, lagrangian.plan, choice
        self.tilt, self.shift = Tally(lagrangian.count), Tally(1)
        self.size = len(self.plan.contacts)
        self.problem = ""

    def press(self, index: Any, factors: Any, multiplier: float, upper: float, lower: float) -> None:
        """Add a row factors @ unknowns within bounds; a negative multiplier presses on the lower one."""
        limit = upper if multiplier > 0 else lower
        if not np.isfinite(limit):
            self.problem = "a multiplier presses on a bound that is not there"
            return
        self.tilt.add(np.asarray(index), multiplier * np.asarray(factors, dtype=float))
        self.shift.add(0, -multiplier * limit)

    def bodily(self, kept: dict[str, Any], turning: list[Any]) -> None:
        g, plan, robot, options = self.lagrangian, self.plan, self.plan.values["robot"], self.plan.values["options"]
        middle, span = nominal(plan), np.array(robot["foot_reach_m"], dtype=float)
        for i, j, a, _, m in kept.get("reach", []):
            i, j, a = place_in((i, j, a), self.size, 4, 3)
            axis = g.turns[i][:, a]
            index = np.concatenate([g.feet[i, j], g.base[i]])
            self.press(index, np.concatenate([axis, -axis]), m, middle[j, a] + span[a], middle[j, a] - span[a])
        for i, j, k, _, m in kept.get("leg", []) if options.get("joint_reach") else []:
            i, j, k = place_in((i, j, k), self.size, 4, 4)
            normal, bound = half_space(plan, middle, j, k)
            index = np.concatenate([g.feet[i, j], g.base[i]])
            turned = g.turns[i] @ normal
            self.press(index, np.concatenate([turned, -turned]), m, bound, -np.inf)
        for i, number, side, _, m in kept.get("clearance", []):
            i, number, side = place_in((i, number, side), self.size, len(plan.steps), 2)
            step = plan.steps[number]
            quarter = (step.touch - step.lift) // 4
            ground = (step.lift - 1, step.touch)[side]
            if not step.lift + quarter <= i < step.touch - quarter:
                self.problem = "a multiplier of clearance stands where there is no such row"
                return
            pair = [g.feet[i, step.foot, 2], g.feet[ground, step.foot, 2]]
            self.press(pair, [1.0, -1.0], m, np.inf, float(options["clearance_m"]))
        for i, a, _, _, m in kept.get("support", []):
            i, a = place_in((i, a), self.size, 3)
            held = np.flatnonzero(plan.contacts[i])
            if len(held) < 3:
                self.problem = "a multiplier of support stands where there is no such row"
                return
            places = [g.base[i, a], *g.feet[i, held, a]]
            limit = float(options["com_support_m"])
            self.press(places, [1.0, *[-1.0 / len(held)] * len(held)], m, limit, -limit)
        for i, a, _, _, m in kept.get("tilt", []) if options["moment_balance"] else []:
            i, a = place_in((i, a), self.size, 3)
            middle_angle, most = g.angle_reference[i, a], float(options["tilt_max_rad"])
            self.press([g.angle[i, a]], [1.0], m, middle_angle + most, middle_angle - most)
        for i, number, row, region, m in kept.get("collision", []):
            counts = self.size, len(self.choice) - len(plan.steps), len(plan.values["free_regions"])
            i, number, region = place_in((i, number, region), *counts)
            self._free(i, number, int(row), region, m)
        rows = [(i, a, m) for i, a, m in turning] + [(i, a, m) for i, a, _, _, m in kept.get("base torque", [])]
        limit, dt = float(robot["base_torque_max_nm"]), plan.number("step_s")
        for i, a, m in rows:
            i, a = place_in((i, a), self.size, 3)
            if i == 0:
                continue
            turns = [g.angle[i, a], g.angle[i - 1, a], g.angle[max(i - 2, 0), a]]
            factors = np.array([1.0, -2.0, 1.0] if i > 1 else [1.0, -1.0, 0.0]) / dt**2
            self.press(turns, float(robot["inertia_kgm2"][a]) * factors, m, limit, -limit)

    def _free(self, i: int, number: int, row: int, region: int, m: float) -> None:
        parts = windows(self.plan)
        foot, window = divmod(number, len(parts))
        if self.choice[len(self.plan.steps) + number] != (region,) or i not in parts[window]:
            self.problem = "a multiplier of collision stands where that region is not the only one left"
            return
        given = self.plan.values["free_regions"][region]
        self.press(self.lagrangian.feet[i, foot], given["A"][row], m, float(given["b"][row]), -np.inf)

    def footholds(self, rows: list[Any]) -> None:
        for number, *vector in rows:
            (number,) = place_in([number], len(self.plan.steps))
            step, c = self.plan.steps[number], np.array(vector, dtype=float)
            corners = np.concatenate([self.lagrangian.ground[r].corners for r in self.choice[number]])
            self.tilt.add(self.lagrangian.feet[step.touch, step.foot], c)
            self.shift.add(0, -float((corners @ c).max()))

    def forces(self, friction: list[Any], torque: list[Any]) -> None:
        robot, plan = self.plan.values["robot"], self.plan
        arms = jacobians(plan)
        limits = np.array(robot["torque_max_nm"], dtype=float)
        most_n = max(float(np.linalg.norm(np.linalg.inv(arm), 2)) for arm in arms) * float(np.linalg.norm(limits))
        for i, j, a, _, m in torque:
            i, j, a = place_in((i, j, a), self.size, 4, 3)
            if not plan.contacts[i, j]:
                self.problem = "a multiplier of torque stands in swing"
                return
            self.press(self.lagrangian.force[i, j], arms[j][:, a], m, float(limits[a]), -float(limits[a]))
        for i, j, *vector in friction:
            (i, j), c = place_in((i, j), self.size, 4), np.array(vector, dtype=float)
            on = [k for k, step in enumerate(plan.steps) if step.foot == j and step.touch <= i < step.leave]
            ids = self.choice[on[0]] if on else (start_surface(plan, self.lagrangian.ground, j),)
            if not plan.contacts[i, j]:
                self.problem = "a multiplier of friction stands in swing"
                return
            worst = max(float((self.lagrangian.ground[r].rays() @ c).max()) for r in ids)
            self.tilt.add(self.lagrangian.force[i, j], c)
            self.shift.add(0, -max(worst, 0.0) * most_n)
