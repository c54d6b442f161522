"""Convert [[pressure]] and [[fill]] of a case, the pressure of water, earth or wind, to forces at points.

Pressures that are linear in height become forces at the points of a quadrature that is exact for them: their sum and
their moments are those of the integral.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import surface_pieces
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.errors import KeyPath
from dem_cli.masonry.assembly.exposure import SurfacePiece, Surfaces
from dem_cli.masonry.assembly.point_forces import LOOKS_UP, POINT, AppliedLoad, acts_on_nothing

if TYPE_CHECKING:
    from dem_cli.case.load_tables import Fill, Pressure
    from dem_cli.case.schema import Case


class SoilStress(NamedTuple):
    """Stress state linear in depth: of earth, of a fluid, or uniform."""

    at_level: float  # vertical stress there [Pa]
    per_depth: float  # [Pa/m]
    level: float | None  # height of the surface [m]; None: it has none
    sideways: float = 1.0  # horizontal over vertical stress [-]
    from_below: bool = True  # faces that look down feel the vertical stress
    wall_friction: float = 0.0  # shear downwards over horizontal stress on upright faces [-]

    def vertical(self, points: np.ndarray) -> np.ndarray:
        """Compute the vertical stress at points (n, d) [Pa], (n,)."""
        depth = 0.0 if self.level is None else self.level - points[:, -1]
        return self.at_level + self.per_depth * depth * np.ones(len(points))

    def traction(self, normal: np.ndarray) -> np.ndarray:
        """Compute the traction on a face with outward normal (d,) at a vertical stress of 1 [-], (d,)."""
        found = -self.sideways * normal
        found[-1] = -normal[-1] if self.from_below else -max(normal[-1], 0.0)
        found[-1] -= self.sideways * self.wall_friction * np.hypot.reduce(normal[:-1])
        return found


def pressure(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Pressure) -> AppliedLoad:
    """Compute the point forces of a pressure on the exposed faces with the required orientation."""
    assert surfaces is not None  # applied_loads
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
        raise acts_on_nothing(path, key, f"no face of {table.said} that nothing covers {seen}, within "
                       f"{table.within_deg:g}°")  # fmt: skip
    stress, of_level = _stress(case, table)
    low, high = table.levels or (-np.inf, np.inf)
    found = _stressed(model, path, pieces, stress, (low, min(high, np.inf if stress.level is None else stress.level)))
    if found is None:
        levels = [piece.corners[:, -1] for piece in pieces]
        between = f"{min(map(np.min, levels)):.6g} and {max(map(np.max, levels)):.6g} m"
        named = of_level if table.levels is None else "levels"
        raise acts_on_nothing(path, named, f"nothing is pressed: the faces lie between {between}")
    return found._replace(dead=table.kind == "dead")


def _stress(case: Case, table: Pressure) -> tuple[SoilStress, str]:
    """Return the stress state of a [[pressure]] table, and the key that sets its upper level."""
    if table.fluid is not None:
        return SoilStress(0.0, table.fluid.density * case.gravity, table.fluid.level), "fluid"
    if table.earth is not None:
        earth = table.earth
        friction = float(functions.tan(np.radians(earth.wall_friction_deg)))
        per_depth = earth.density * case.gravity
        return SoilStress(earth.surcharge, per_depth, earth.level, earth.sideways, False, friction), "earth"
    return SoilStress(table.uniform or 0.0, 0.0, None), "levels"


def fill(case: Case, model: Model, surfaces: Surfaces | None, path: KeyPath, table: Fill) -> AppliedLoad:
    """Compute the weight of fill on faces that look up, and its thrust on inclined and upright ones."""
    assert surfaces is not None  # applied_loads
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
        raise acts_on_nothing(path, "level", message)
    weights = np.where(table.inertia, -found.forces[:, -1], 0.0)
    return found._replace(weights=weights)


def _extent(model: Model, blocks: np.ndarray, table: Fill) -> tuple[tuple[np.ndarray, np.ndarray], float]:
    """Return the upright half-spaces that bound the fill, and the length that counts as zero beside it [m].

    Given, or the convex hull of the blocks as seen from above: it turns with them.
    """
    upright = np.eye(model.dimension)[:-1]
    corners = undeformed(model)[np.isin(model.vertex_blocks, blocks)][:, :-1]
    sides = np.array(table.sides or np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1))
    span = float(np.ptp(sides, axis=1).max())
    if table.sides or model.dimension == 2:
        normals, offsets = np.concatenate([upright, -upright]), np.concatenate([sides[:, 1], -sides[:, 0]])
    else:
        from scipy.spatial import ConvexHull

        planes = ConvexHull(corners).equations
        normals, offsets = product(planes[:, :-1], upright), -planes[:, -1]
        span = float(np.linalg.norm(corners - corners.mean(axis=0), axis=1).max())  # however they are turned in plan
    return (normals, offsets), POINT * span


def _stressed(
    model: Model, path: KeyPath, pieces: Sequence[SurfacePiece], stress: SoilStress, levels: tuple[float, float]
) -> AppliedLoad | None:
    """Integrate a stress state over pieces of faces between two heights; None where there is none."""
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
