"""Applied loads: the forces at points that [[load]], [[pressure]] and [[fill]] of a case come to.

Pressures that are linear in height become forces at the points of a quadrature that is exact for them: their sum and
their moments are those of the integral.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.assembly.exposure import SurfacePiece, Surfaces
from dem_cli.case.wording import show
from dem_cli.errors import CaseError, CaseProblem, KeyPath
from dem_cli.geometry import surface_pieces
from dem_cli.model.model import Model
from dem_cli.model.places import undeformed
from dem_cli.model.scales import smallest_edge

if TYPE_CHECKING:
    from dem_cli.case.load_tables import Fill, Load, Pressure
    from dem_cli.case.schema import Case

LOOKS_UP = 1e-9  # vertical component of the normal of a face from which on it does
POINT = 1e-6  # of the shortest edge: half the width of what a load at a point or along a line acts on
ON_IT = 0.01  # of the same: a load so far below the top of a block is on it (rounded coordinates)
BESIDE = 1e-3  # of a load: so much of it may lie over no block


class AppliedLoad(NamedTuple):
    """The forces that one table of a case comes to."""

    path: KeyPath  # of the table
    dead: bool
    blocks: np.ndarray  # on which they act, (n,)
    points: np.ndarray  # where, undeformed [m], (n, d)
    forces: np.ndarray  # [N], (n, d)
    weights: np.ndarray  # what of them is weight that the load of pattern "mass" shares in [N], (n,)
    area: float = 0.0  # of the surface that a pressure acts on [m²]

    @property
    def resultant(self) -> np.ndarray:
        """Sum of the forces [N], (d,)."""
        return self.forces.sum(axis=0)

    @property
    def centre(self) -> np.ndarray:
        """Mean of the points, weighted by their forces: of a plane face that of its line of action [m], (d,)."""
        sizes = np.linalg.norm(self.forces, axis=1)
        return self.points.mean(axis=0) if sizes.sum() == 0.0 else sizes @ self.points / sizes.sum()


class SoilStress(NamedTuple):
    """A state of stress that is linear in depth: of earth, of a fluid, or the same everywhere."""

    at_level: float  # vertical stress there [Pa]
    per_depth: float  # [Pa/m]
    level: float | None  # height of the surface [m]; None: it has none
    sideways: float = 1.0  # horizontal over vertical stress [-]
    from_below: bool = True  # faces that look down feel the vertical stress
    wall_friction: float = 0.0  # shear downwards over horizontal stress on upright faces [-]

    def vertical(self, points: np.ndarray) -> np.ndarray:
        """Vertical stress at points (n, d) [Pa], (n,)."""
        depth = 0.0 if self.level is None else self.level - points[:, -1]
        return self.at_level + self.per_depth * depth * np.ones(len(points))

    def traction(self, normal: np.ndarray) -> np.ndarray:
        """Force per area of a face with that outward normal (d,), at a vertical stress of 1 [-], (d,)."""
        found = -self.sideways * normal
        found[-1] = -normal[-1] if self.from_below else -max(normal[-1], 0.0)
        found[-1] -= self.sideways * self.wall_friction * np.hypot.reduce(normal[:-1])
        return found


def applied_loads(case: Case, model: Model) -> list[AppliedLoad]:
    """All loads of a case, table by table. Raises CaseError where one acts on nothing."""
    surfaces = Surfaces(model) if _need_surfaces(case) else None
    found, problems = list[AppliedLoad](), list[CaseProblem]()
    for key, resolve in (("load", _load), ("pressure", _pressure), ("fill", _fill)):
        for i, table in enumerate(getattr(case, key)):
            try:
                found.append(resolve(case, model, surfaces, (key, i), table))
            except CaseError as error:
                problems += error.problems
    if problems:
        raise CaseError(problems)
    return found


def _need_surfaces(case: Case) -> bool:
    return bool(case.pressure or case.fill) or any(load.falls or load.at is not None for load in case.load)


def _nothing(path: KeyPath, key: str, message: str) -> CaseError:
    return CaseError([CaseProblem((*path, key), message)])


def _load(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Load) -> AppliedLoad:
    """Forces on one block, shared by several, or on what lies under them."""
    chosen = model.chosen(table.selected, False)
    if table.falls or (table.at is not None and len(chosen) > 1):
        return _falling(model, surfaces, path, table)
    points = model.centroids[chosen] if table.at is None else np.array([table.at])
    shares = np.ones(len(chosen)) if table.each else model.masses[chosen] / model.masses[chosen].sum()
    if len(chosen) == 1:
        shares = np.ones(1)
    forces = shares[:, np.newaxis] * np.array(table.force)
    return AppliedLoad(path, table.kind == "dead", chosen, points, forces, np.zeros(len(chosen)))


def _falling(model: Model, surfaces: Surfaces | None, path: KeyPath, table: Load) -> AppliedLoad:
    """A load at a point or along a line, on the faces that lie highest under it."""
    assert surfaces is not None  # _need_surfaces
    key = "at" if table.line is None else "line"
    ends = np.array([table.at, table.at] if table.line is None else table.line)
    blocks = model.chosen(table.selected) if table.selected is not None else np.arange(model.n_blocks)
    edge = smallest_edge(model)
    small, top = POINT * edge, float(ends[:, -1].max()) + ON_IT * edge
    under = _under(surfaces, blocks, top, _strip(ends, small))
    if not under:
        where = "block" if table.selected is None else table.said
        raise _nothing(path, key, f"there is no {where} under {show(table.at or table.line)}")
    if table.spread:
        points, areas, _ = _quadrature(under)
        depth = float((ends.mean(axis=0)[-1] - points[:, -1]) @ areas / areas.sum())
        under = _under(surfaces, blocks, top, _strip(ends, small, table.spread * max(depth, 0.0)))
    points, areas, numbers = _quadrature(under)
    length = float(np.hypot.reduce((ends[1] - ends[0])[:-1]))
    force = np.array(table.force if table.line is None else table.force_per_length)
    if table.line is not None:
        over = areas.sum() / (2.0 * small) ** (model.dimension - 2) / length if not table.spread else 1.0
        if over < 1.0 - BESIDE:
            message = f"{(1.0 - over) * length:.3g} m of it lie over no block; shorten it, or give spread"
            raise _nothing(path, key, message)
        force = force * float(np.linalg.norm(ends[1] - ends[0]))
    shares = areas / areas.sum()
    blocks = np.array([under[k].block for k in numbers])
    return AppliedLoad(path, table.kind == "dead", blocks, points, np.outer(shares, force), np.zeros(len(blocks)))


def _strip(ends: np.ndarray, small: float, wider: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Upright half-spaces around a point or line (2, d), to each side by `wider`, across it by `small` at least [m]."""
    flat = ends[:, :-1]
    way = flat[1] - flat[0]
    length = np.hypot.reduce(way)
    along = way / length if length > 0.0 else np.eye(len(way))[0]
    axes = [along] if len(way) == 1 else [along, np.array([-along[1], along[0]])]
    normals, offsets = [], []
    for k, axis in enumerate(axes):
        reach = max(wider, small if length == 0.0 or k else 0.0)
        heights = flat @ axis
        normals += [np.append(axis, 0.0), np.append(-axis, 0.0)]
        offsets += [heights.max() + reach, reach - heights.min()]
    return np.array(normals), np.array(offsets)


def _under(
    surfaces: Surfaces, blocks: np.ndarray, top: float, strip: tuple[np.ndarray, np.ndarray]
) -> list[SurfacePiece]:
    """What of the faces of some blocks lies highest below a height [m], within upright half-spaces."""
    normals = np.vstack([strip[0], np.eye(strip[0].shape[1])[-1]])
    offsets = np.append(strip[1], top)
    looking_up = (surfaces.normals[:, -1] > LOOKS_UP) & surfaces.near(normals, offsets)
    cut = [
        piece._replace(corners=surface_pieces.inside(piece.corners, normals, offsets), least=0.0)
        for piece in surfaces.exposed(blocks, looking_up)
    ]
    return surfaces.open_above([piece for piece in cut if surface_pieces.measure(piece.corners) > 0.0], top, blocks)


def _quadrature(pieces: Sequence[SurfacePiece]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, d), the area of each as seen from above (n,), and the number of its piece (n,)."""
    found = [surface_pieces.quadrature(piece.corners) for piece in pieces]
    areas = [weights * piece.normal[-1] for piece, (_, weights) in zip(pieces, found, strict=True)]
    numbers = np.repeat(np.arange(len(pieces)), [len(weights) for weights in areas])
    return np.concatenate([points for points, _ in found]), np.concatenate(areas), numbers


def _pressure(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Pressure) -> AppliedLoad:
    """Forces of a pressure on exposed faces that look the way it says."""
    assert surfaces is not None  # _need_surfaces
    looking, key = np.ones(len(surfaces.normals), bool), "face" if table.facing is None else "facing"
    if table.face != "all":
        wanted = table.direction(model.dimension)
        towards = np.array(table.facing) - surfaces.middles if wanted is None else np.array([wanted])
        lengths = np.linalg.norm(towards, axis=1)
        cosines = (surfaces.normals * towards).sum(axis=1) / np.where(lengths > 0.0, lengths, 1.0)
        looking = cosines >= np.cos(np.radians(table.within_deg)) - LOOKS_UP
    pieces = surfaces.exposed(model.chosen(table.selected, False), looking)
    if not pieces:
        seen = "looks there" if table.facing is not None else f"looks towards {show(table.face)}"
        raise _nothing(path, key, f"no face of {table.said} that nothing covers {seen}, within "
                       f"{table.within_deg:g}°")  # fmt: skip
    stress, of_level = _stress(case, table)
    low, high = table.levels or (-np.inf, np.inf)
    found = _stressed(model, path, pieces, stress, (low, min(high, np.inf if stress.level is None else stress.level)))
    if found is None:
        levels = [piece.corners[:, -1] for piece in pieces]
        between = f"{min(map(np.min, levels)):.6g} and {max(map(np.max, levels)):.6g} m"
        named = of_level if table.levels is None else "levels"
        raise _nothing(path, named, f"nothing is pressed: the faces lie between {between}")
    return found._replace(dead=table.kind == "dead")


def _stress(case: Case, table: Pressure) -> tuple[SoilStress, str]:
    """The state of stress of a pressure, and the key that says how high it reaches."""
    if table.fluid is not None:
        return SoilStress(0.0, table.fluid.density * case.gravity, table.fluid.level), "fluid"
    if table.earth is not None:
        earth = table.earth
        friction = float(np.tan(np.radians(earth.wall_friction_deg)))
        per_depth = earth.density * case.gravity
        return SoilStress(earth.surcharge, per_depth, earth.level, earth.sideways, False, friction), "earth"
    return SoilStress(table.uniform or 0.0, 0.0, None), "levels"


def _fill(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Fill) -> AppliedLoad:
    """Weight of earth on faces that look up, and its thrust on inclined and upright ones."""
    assert surfaces is not None  # _need_surfaces
    blocks = model.chosen(table.selected, False)
    looking = surfaces.normals[:, -1] > (-LOOKS_UP if table.sideways else LOOKS_UP)
    inner, small = _extent(model, blocks, table)
    pieces = []
    for piece in surfaces.exposed(blocks, looking & surfaces.near(inner[0], inner[1] - small)):
        steep = piece.normal[-1] <= LOOKS_UP
        step = small * piece.normal if steep else 0.0  # whether there is fill before an upright face
        cut = surface_pieces.inside(piece.corners + step, *inner)
        if surface_pieces.measure(cut) > piece.least:
            pieces.append(piece._replace(corners=cut - step))
    pieces = surfaces.open_above(pieces, table.level, np.arange(model.n_blocks))
    stress = SoilStress(0.0, table.density * case.gravity, table.level, table.sideways, False)
    found = _stressed(model, path, pieces, stress, (-np.inf, table.level))
    if found is None:
        message = f"{show(table.level)} is not allowed: below it no face of {table.said} looks up"
        raise _nothing(path, "level", message)
    weights = np.where(table.inertia, -found.forces[:, -1], 0.0)
    return found._replace(weights=weights)


def _extent(model: Model, blocks: np.ndarray, table: Fill) -> tuple[tuple[np.ndarray, np.ndarray], float]:
    """Upright half-spaces that fill lies in, and what is small beside it [m].

    Given, or the convex hull of the blocks as seen from above: it turns with them.
    """
    upright = np.eye(model.dimension)[:-1]
    corners = undeformed(model)[np.isin(model.vertex_blocks, blocks)][:, :-1]
    sides = np.array(table.sides or np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1))
    if table.sides or model.dimension == 2:
        normals, offsets = np.concatenate([upright, -upright]), np.concatenate([sides[:, 1], -sides[:, 0]])
    else:
        from scipy.spatial import ConvexHull

        planes = ConvexHull(corners).equations
        normals, offsets = planes[:, :-1] @ upright, -planes[:, -1]
    return (normals, offsets), POINT * float(np.ptp(sides, axis=1).max())


def _stressed(
    model: Model, path: KeyPath, pieces: Sequence[SurfacePiece], stress: SoilStress, levels: tuple[float, float]
) -> AppliedLoad | None:
    """Forces of a state of stress on pieces of faces between two heights; None where there is nothing."""
    up = np.eye(model.dimension)[-1]
    normals = np.array([-up, up])[np.isfinite(levels)]
    offsets = np.array([-levels[0], levels[1]])[np.isfinite(levels)]
    blocks, points, forces, area = [], list[np.ndarray](), list[np.ndarray](), 0.0
    for piece in pieces:
        corners = surface_pieces.inside(piece.corners, normals, offsets)
        if surface_pieces.measure(corners) <= piece.least:
            continue
        depth = model.thickness[piece.block]
        places, weights = surface_pieces.quadrature(corners)
        area += depth * float(weights.sum())
        points.append(places)
        forces.append(np.outer(depth * weights * stress.vertical(places), stress.traction(piece.normal)))
        blocks += [piece.block] * len(places)
    if not blocks:
        return None
    return AppliedLoad(
        path, True, np.array(blocks), np.concatenate(points), np.concatenate(forces), np.zeros(len(blocks)), area
    )
