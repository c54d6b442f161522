"""Range of admissible failure loads of rigid blocks with Coulomb joints that do not dilate, by linear programs.

Written apart from dem_cli: blocks, joints and loads are read from the tables of a case with the tests' own tools.

Above the *associated* load no forces inside the friction cones are in equilibrium, whatever the history (static
theorem; Livesley 1978). Below the *lowest* load nothing collapses: let c = μ N_min of each joint, N_min its least
normal force in any equilibrium inside the cones at loads of an interval [lo, hi]. A mechanism that slides without
dilation at a load λ there takes Σ μ N |slip| ≥ Σ c |slip|; where forces with |T| ≤ c balance lo and some λ', virtual
work of these forces in the mechanism leaves no such λ between lo and λ' (as Radenkovic 1961 for plane friction). So
the load is known wherever both are the same, as of columns and of most arches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from casefiles import blocks_of
from oracle.limit_lp import Interface, bodies_area_and_centroid, edges_outward, interfaces
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, vstack
from scipy.sparse.csgraph import connected_components

Tables = dict[str, Any]
INTERVALS = 12  # of the load that are tried at most, halved where nothing is gained
EFFORT = 50_000  # linear programs of a structure × its joints, at most: some seconds
LEAST_GAIN = 0.02  # of an interval: less is none


@dataclass(frozen=True)
class LoadedBodies:
    """Blocks of a case as polygons, with their loads; a row per block where nothing else is said."""

    names: list[str]
    polygons: list[np.ndarray]  # of all parts
    bodies: np.ndarray  # block of each part
    fixed: np.ndarray
    centroids: np.ndarray
    weights: np.ndarray  # [N]
    dead: np.ndarray  # fx, fy, moment beside the weight
    live: np.ndarray
    materials: list[str]
    tables: Tables

    @classmethod
    def of(cls, tables: Tables) -> LoadedBodies:
        """The blocks of the tables of a case."""
        blocks = blocks_of(tables)
        polygons = [part for block in blocks for part in block[1]]
        owners = np.repeat(np.arange(len(blocks)), [len(block[1]) for block in blocks])
        areas, centroids = bodies_area_and_centroid(polygons, owners)
        density = [tables["materials"][block[2]]["density"] for block in blocks]
        weights = areas * density * [block[3] for block in blocks] * tables.get("gravity", 9.81)
        names = [block[0] for block in blocks]
        loads = {"dead": np.zeros((len(blocks), 3)), "live": np.zeros((len(blocks), 3))}
        for load in tables.get("load", []):
            i, force = names.index(load["block"]), load["force"]
            x, y = np.array(load.get("at", centroids[i])) - centroids[i]
            loads[load.get("kind", "dead")][i] += [*force, x * force[1] - y * force[0]]
        analysis = tables.get("analysis", {})
        if analysis.get("pattern", "mass") != "live":
            direction = np.array(analysis.get("direction", [1.0, 0.0]))
            direction = direction / np.hypot(*direction)
            loads["live"] = np.column_stack([weights[:, None] * direction, np.zeros(len(blocks))])
        fixed = np.array([block[4] for block in blocks])
        materials = [block[2] for block in blocks]
        return cls(names, polygons, owners, fixed, centroids, weights, loads["dead"], loads["live"], materials, tables)

    def friction(self, joint: Interface) -> float:
        """Friction coefficient between two blocks."""
        pair = {self.materials[joint.a], self.materials[joint.b]}
        named = [one["joint"] for one in self.tables.get("interface", []) if set(one["between"]) == pair]
        table = self.tables["joints"][named[-1] if named else next(iter(self.tables["joints"]))]
        return float(table.get("friction", np.tan(np.radians(table.get("friction_angle_deg", 0.0)))))

    def inside(self, i: int, rng: np.random.Generator) -> list[float]:
        """A point of a block, between its middle and its face."""
        corners = self.polygons[int(np.flatnonzero(self.bodies == i)[0])]
        shares = rng.dirichlet(np.ones(len(corners)))
        return [float(x) for x in 0.3 * corners.mean(axis=0) + 0.7 * (shares @ corners)]


def associated_load(bodies: LoadedBodies) -> float:
    """Upper bound of every failure load; nan: does not stand, inf: no load makes it fail."""
    return AdmissibleLoads(bodies, joints_of(bodies)).largest()


def joints_of(bodies: LoadedBodies) -> list[Interface]:
    """Faces that touch along a length, and corners that touch a face at a point: both ends are there."""
    found = interfaces(bodies.polygons, bodies.bodies)
    reach = 1e-6 * float(np.ptp(np.vstack(bodies.polygons), axis=0).max())
    boxes = np.array([[*p.min(axis=0), *(-p.max(axis=0))] for p in bodies.polygons])
    for i, polygon in enumerate(bodies.polygons):
        near = (boxes[:, :2] <= -boxes[i, 2:] + reach).all(axis=1) & (boxes[:, 2:] <= -boxes[i, :2] + reach).all(axis=1)
        for j in np.flatnonzero(near & (bodies.bodies != bodies.bodies[i])):
            a, b = int(bodies.bodies[i]), int(bodies.bodies[j])
            for start, end, normal in edges_outward(polygon):
                spot = corner_on(start, end, normal, bodies.polygons[j], reach)
                if spot is not None:
                    found.append(Interface(a, b, np.array([spot, spot]), normal))
    return [one for one in found if not (bodies.fixed[one.a] and bodies.fixed[one.b])]


def corner_on(
    start: np.ndarray, end: np.ndarray, normal: np.ndarray, other: np.ndarray, reach: float
) -> np.ndarray | None:
    """The corner at which another polygon stands on an edge, away from the ends of it; None: there is no such one."""
    heights = (other - start) @ normal
    lowest = int(heights.argmin())
    if abs(heights[lowest]) > reach or (heights <= reach).sum() != 1:
        return None
    place, length = (other[lowest] - start) @ (end - start), (end - start) @ (end - start)
    slack = reach * np.sqrt(length)
    return other[lowest] if slack < place < length - slack else None


def lowest_load(bodies: LoadedBodies, associated: float) -> float | None:
    """A load below which nothing collapses, of structures side by side the lowest of all; None: none was proved."""
    lowest = associated
    for part in connected(bodies):
        reached = AdmissibleLoads(*part).lowest(associated)
        if reached is None:
            return None
        lowest = min(lowest, reached)
    return lowest


def connected(bodies: LoadedBodies) -> list[tuple[LoadedBodies, list[Interface]]]:
    """Structures that share nothing but fixed blocks: each as the same bodies with all others fixed, and its joints."""
    joints = joints_of(bodies)
    free = [[one.a, one.b] for one in joints if not bodies.fixed[[one.a, one.b]].any()]
    ends = np.array(free, dtype=int).reshape(-1, 2)
    n = len(bodies.names)
    _, label = connected_components(csr_matrix((np.ones(len(ends)), ends.T), shape=(n, n)), directed=False)
    found = []
    for group in np.unique(label[~bodies.fixed]):
        fixed = bodies.fixed | (label != group)
        touching = [one for one in joints if not (fixed[one.a] and fixed[one.b])]
        found.append((replace(bodies, fixed=fixed), touching))
    return found


class AdmissibleLoads:
    """Linear programs over N at both ends of each joint and T along it, N ≥ 0; then the load multiplier."""

    def __init__(self, bodies: LoadedBodies, joints: Sequence[Interface]) -> None:
        self.joints = joints
        self.friction = np.array([bodies.friction(joint) for joint in self.joints])
        self.balance, self.right = equilibrium(bodies, self.joints)
        n = len(self.joints)
        rows, ends = np.arange(n), 3 * np.arange(n)[:, None] + [0, 1]
        slope = csr_matrix((np.repeat(self.friction, 2), (np.repeat(rows, 2), ends.ravel())), shape=(n, 3 * n + 1))
        shear = csr_matrix((np.ones(n), (rows, 3 * rows + 2)), shape=(n, 3 * n + 1))
        self.cones = vstack([shear - slope, -shear - slope]).tocsr()  # ± T − μ N ≤ 0
        self.programs = 0

    def largest(self) -> float:
        """The largest load inside the friction cones; nan: none at load zero, inf: any load."""
        free = np.full(len(self.joints), np.inf)
        if self.solve(np.zeros(3 * len(free) + 1), self.bounds(free, 0.0, 0.0), cones=True).status != 0:
            return float("nan")
        cost = np.zeros(3 * len(free) + 1)
        cost[-1] = -1.0
        found = self.solve(cost, self.bounds(free, 0.0, np.inf), cones=True)
        return float(found.x[-1]) if found.status == 0 else float("inf")

    def lowest(self, associated: float, accuracy: float = 1e-3) -> float | None:
        """A load below which nothing collapses, None: none was proved; sought to `accuracy` of the associated one."""
        low, high = 0.0, associated
        for _ in range(INTERVALS):
            effort = (self.programs + len(self.joints)) * len(self.joints)
            if associated - low <= accuracy * associated or effort > EFFORT:
                break
            strengths = self.friction * self.least_normals(low, high)
            reached = self.reach(strengths, low, high)
            if reached is None or reached - low < LEAST_GAIN * (high - low):
                if high - low <= accuracy * associated:
                    break
                high = low + 0.5 * (high - low) if reached is None else low + 0.25 * (high - low)
                continue
            low, high = reached, associated
        return low if low > 0.0 else None

    def least_normals(self, low: float, high: float) -> np.ndarray:
        """Least normal force of each joint in any equilibrium inside the cones at such loads [mean weights], (n,)."""
        n = len(self.joints)
        bounds = self.bounds(np.full(n, np.inf), low, high)
        least = np.zeros(n)
        for k in range(n):
            cost = np.zeros(3 * n + 1)
            cost[3 * k : 3 * k + 2] = 1.0
            found = self.solve(cost, bounds, cones=True)
            least[k] = max(found.fun - 1e-7, 0.0) if found.status == 0 else 0.0
        return least

    def reach(self, strengths: np.ndarray, low: float, high: float) -> float | None:
        """The largest load up to `high` in equilibrium with |T| ≤ strengths, where `low` is as well; else None."""
        cost = np.zeros(3 * len(self.joints) + 1)
        cost[-1] = 1.0
        bounds = self.bounds(strengths, low, high)
        least = self.solve(cost, bounds)
        if least.status != 0 or least.fun > low + 1e-9 * max(high, 1.0):
            return None
        most = self.solve(-cost, bounds)
        return -float(most.fun) if most.status == 0 else None

    def bounds(self, strengths: np.ndarray, low: float, high: float) -> np.ndarray:
        """Of all unknowns, (3 n + 1, 2)."""
        rows = np.stack([np.zeros_like(strengths), np.zeros_like(strengths), -strengths], axis=1)
        tops = np.stack([np.full_like(strengths, np.inf), np.full_like(strengths, np.inf), strengths], axis=1)
        return np.vstack([np.column_stack([rows.ravel(), tops.ravel()]), [[low, high]]])

    def solve(self, cost: np.ndarray, bounds: np.ndarray, cones: bool = False) -> Any:
        """One linear program; with the friction cones or without."""
        self.programs += 1
        more = {"A_ub": self.cones, "b_ub": np.zeros(self.cones.shape[0])} if cones else {}
        return linprog(cost, A_eq=self.balance, b_eq=self.right, bounds=bounds, method="highs", **more)


def equilibrium(bodies: LoadedBodies, joints: Sequence[Interface]) -> tuple[csr_matrix, np.ndarray]:
    """Matrix and right side: forces, moments of each free block in mean weights, (3 n_free, 3 n_joints + 1)."""
    free = np.cumsum(~bodies.fixed) - 1
    weight = float(bodies.weights[~bodies.fixed].mean())
    length = float(np.sqrt(np.mean([np.ptp(polygon, axis=0).prod() for polygon in bodies.polygons])))
    scale = np.array([1.0, 1.0, length])
    matrix = np.zeros((int((~bodies.fixed).sum()), 3, 3 * len(joints) + 1))
    for k, joint in enumerate(joints):
        along = np.array([-joint.normal[1], joint.normal[0]])
        forces = [(joint.ends[0], joint.normal), (joint.ends[1], joint.normal), (joint.ends[0], along)]
        for block, sign in ((joint.a, -1.0), (joint.b, 1.0)):
            if not bodies.fixed[block]:
                wrenches = [wrench(force, end - bodies.centroids[block]) for end, force in forces]
                matrix[free[block], :, 3 * k : 3 * k + 3] = sign * np.column_stack(wrenches) / scale[:, None]
    dead = bodies.dead - bodies.weights[:, None] * [0.0, 1.0, 0.0]
    matrix[:, :, -1] = (bodies.live / scale / weight)[~bodies.fixed]
    return csr_matrix(matrix.reshape(-1, matrix.shape[-1])), -(dead / scale / weight)[~bodies.fixed].ravel()


def wrench(force: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """A force and its moment."""
    return np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
