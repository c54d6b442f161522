"""Convert solids of a file to convex parts: closed, in metres and upright, with neighbours on common planes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from dem_cli.core.arithmetic.products import norm
from dem_cli.core.arithmetic.small_matrices import determinants, singular
from dem_cli.core.geometry import polygon, polyhedron
from dem_cli.core.geometry.common_planes import Snapped, on_common_planes
from dem_cli.core.geometry.crowding import crowd
from dem_cli.core.geometry.decomposition import convex_parts, is_simple
from dem_cli.core.geometry.facets import Facets, facets_of_outline, facets_of_surface
from dem_cli.core.geometry.solid_decomposition import Sides, convex_pieces, solid_volume
from dem_cli.input_limits import MOST_TOGETHER
from dem_cli.masonry.imports.contents import FileBody, FileProblem, check_corners
from dem_cli.masonry.imports.shells import shells_of

ROUNDED = 1e-6  # of the size of all: what files round off, put back by default
SINGLE = 2.0**-22  # of the largest coordinate: twice what single precision rounds off


class Reading(Protocol):
    """Options of reading a geometry file."""

    @property
    def up(self) -> str:
        """Vertical axis of the file, "z" or "y"."""

    @property
    def concave(self) -> str:
        """Treatment of concave solids: "refuse" or "decompose"."""

    @property
    def snap(self) -> float | None:
        """Largest distance of points that are merged [m]; None: the rounding of the file."""


class Solid(NamedTuple):
    """Solid of a file as convex parts in metres."""

    name: str
    layer: str
    fixed: bool
    parts: tuple[Any, ...]  # (n, 2) arrays, or polyhedra
    compound: bool = False  # part of one block with all others of its name


def solids_of(bodies: Sequence[FileBody], factor: float, how: Reading) -> tuple[list[Solid], list[str]]:
    """Convert all bodies to solids, in the order of the file, with notes on moved corners. Raises FileProblem."""
    _check_copies(bodies)
    owners: list[int] = []
    shapes: list[Any] = []
    for number, body in enumerate(bodies, 1):
        with_place = body._replace(points=_placed(body.points, factor, how.up))
        try:
            found = shells_of(with_place) if body.faces else [closed_outline(with_place.points)]
        except FileProblem as error:
            raise FileProblem(f"{called(body, number)}: {error}") from None
        for shape in found:
            check_corners(called(body, number), len(shape if isinstance(shape, np.ndarray) else shape.points))
        owners += [number] * len(found)
        shapes += found
    tolerance = rounding(bodies, factor) if how.snap is None else how.snap
    facets = [_facets(shape, tolerance) for shape in shapes]
    notes = []
    if tolerance > 0.0:
        snapped = on_common_planes(facets, _near(facets, tolerance), tolerance)
        for k, (each, points) in enumerate(zip(facets, snapped.points, strict=True)):
            try:
                facets[k] = _again(each, points)
            except FileProblem as error:
                what, over = called(bodies[owners[k] - 1], owners[k]), f"over {tolerance:.3g} m; give a smaller snap"
                raise FileProblem(f"{what}: {error} {over}") from None
        notes = _notes(snapped, tolerance)
    solids = []
    for number, each in zip(owners, facets, strict=True):
        body = bodies[number - 1]
        try:
            parts = _parts(each, how.concave == "decompose", tolerance)
        except ValueError as error:
            hint = "; a larger snap puts corners back onto planes" if "plane" in str(error) else ""
            raise FileProblem(f"{called(body, number)}: {error}{hint}") from None
        solids.append(Solid(body.name, body.layer, body.fixed, parts, body.compound))
    return solids, notes


def rounding(bodies: Sequence[FileBody], factor: float) -> float:
    """Estimate the rounding error of a file [m]: 1e-6 of the whole size, and the last digits of single precision."""
    places = np.concatenate([body.points for body in bodies])
    size = float(norm(np.ptp(places, axis=0)))
    single = bool((places == places.astype(np.float32)).all())
    return factor * max(ROUNDED * size, SINGLE * float(np.abs(places).max()) if single else 0.0)


def called(body: FileBody, number: int) -> str:
    """Name a body in a message, by its name or its place."""
    layer = f" on layer '{body.layer}'" if body.layer and not body.faces else ""
    if body.name:
        return f"'{body.name}'{layer}"
    kind = "outline" if not body.faces else "solid"
    x = body.points.mean(axis=0)
    return f"{kind} {number}{layer} around [{', '.join(f'{value:.4g}' for value in x)}]"


def _check_copies(bodies: Sequence[FileBody]) -> None:
    """Raise FileProblem where a hundred bodies have the same corners."""
    copies = Counter(body.points.tobytes() for body in bodies)
    corners, count = copies.most_common(1)[0]
    if count > MOST_TOGETHER:
        first = next(k for k, body in enumerate(bodies, 1) if body.points.tobytes() == corners)
        message = f"{called(bodies[first - 1], first)}: {count - 1:,} others have the same corners"
        raise FileProblem(f"{message}; at most {MOST_TOGETHER} lie in the same place")


def _placed(points: np.ndarray, factor: float, up: str) -> np.ndarray:
    """Scale points to metres and turn z upwards; a factor of 1 changes no bit."""
    found = points * factor if factor != 1.0 else points
    if up == "y" and points.shape[1] == 3:
        found = np.column_stack([found[:, 0], -found[:, 2], found[:, 1]])
    return found


def closed_outline(ring: np.ndarray) -> np.ndarray:
    """Return a closed outline counter-clockwise, each corner once. Raises FileProblem."""
    found = polygon.simplified(ring)
    least = polygon.ROUND_OFF * polygon.size(ring)
    if len(found) < 3 or singular(found - found.mean(axis=0))[1][1] <= least:
        raise FileProblem("its corners lie on one line: it has no area")
    found = found if polygon.signed_area(found) > 0.0 else found[::-1]
    if not is_simple(found):
        raise FileProblem("its outline crosses or touches itself")
    return found


def _facets(shape: Any, tolerance: float) -> Facets:
    if isinstance(shape, np.ndarray):
        return facets_of_outline(shape)
    gap = max(tolerance, polyhedron.COPLANAR * polyhedron.size(shape.points))
    return facets_of_surface(shape.points, shape.faces, gap)


def _again(facets: Facets, points: np.ndarray) -> Facets:
    """Rebuild the facets of a solid after its corners moved. Raises FileProblem where sides have no length left."""
    if points is facets.points or (points == facets.points).all():
        return facets
    if points.shape[1] == 2 and (points == np.roll(points, 1, axis=0)).all(axis=1).any():
        raise FileProblem("its corners fall together where faces are put onto one plane")
    if points.shape[1] == 2:
        return facets_of_outline(points)
    gap = polyhedron.COPLANAR * polyhedron.size(points)
    return facets_of_surface(points, facets.loops, gap)


def _near(facets: Sequence[Facets], reach: float) -> np.ndarray:
    """Find pairs of solids whose boxes come near each other, (n, 2)."""
    from dem_cli.core.contact.near_boxes import near_boxes

    corners = np.concatenate([each.points for each in facets])
    starts = np.concatenate([[0], np.cumsum([len(each.points) for each in facets])])
    if crowd(corners, starts) is not None:  # refused where all mistakes of shapes are
        return np.zeros((0, 2), np.int64)
    if corners.shape[1] == 2:
        corners = np.column_stack([corners, np.zeros(len(corners))])
    n = len(facets)
    return near_boxes(corners, starts, np.arange(n), np.zeros(n, bool), reach)


def _notes(snapped: Snapped, tolerance: float) -> list[str]:
    notes = []
    if snapped.moved:
        notes.append(
            f"{snapped.moved:,} corners moved onto common planes, by at most {snapped.farthest:.2g} m "
            f"(snap = {tolerance:.2g} m)"
        )
    if snapped.left:
        notes.append(f"{snapped.left:,} corners or faces would have had to move farther than that, and stay")
    return notes


def _parts(facets: Facets, decompose: bool, tolerance: float) -> tuple[Any, ...]:
    """Split a solid into convex parts. Raises ValueError where it is concave and may not be split."""
    over = facets.over()
    gap = max(tolerance, polyhedron.COPLANAR * polyhedron.size(facets.points))
    if over.max() <= gap:
        return (_convex(facets),)
    if not decompose:
        corner, side = np.unravel_index(int(over.argmax()), over.shape)
        at, face = facets.points[corner], facets.points[facets.corners[side]].mean(axis=0)
        where = "edge" if facets.points.shape[1] == 2 else "face"
        raise ValueError(
            f"it is concave: the corner at {_text(at)} lies {over.max():.3g} m in front of the {where} around "
            f"{_text(face)}; concave = 'decompose' makes convex parts of it"
        )
    if facets.points.shape[1] == 2:
        return tuple(facets.points[numbers] for numbers in convex_parts(facets.points))
    return tuple(polyhedron.hull(piece) for piece in convex_pieces(_sides(facets)))


def _sides(facets: Facets) -> Sides:
    return Sides(facets.points, *facets.triangles(), facets.normals, facets.heights)


def _convex(facets: Facets) -> Any:
    if facets.points.shape[1] == 2:
        return facets.points
    if len(facets.loops) == len(facets.normals):  # faces as the file has them
        return polyhedron.Polyhedron(facets.points, tuple(facets.loops))
    found = polyhedron.hull(facets.points)
    whole = solid_volume(_sides(facets))
    if abs(_volume(found) - whole) > 1e-6 * whole:
        raise ValueError("its faces do not enclose what its corners do: is a face missing, or there twice?")
    return found


def _volume(solid: polyhedron.Polyhedron) -> float:
    loops = [(loop[0], a, b) for loop in solid.faces for a, b in zip(loop[1:-1], loop[2:])]
    arms = solid.vertices[np.array(loops)] - solid.vertices.mean(axis=0)
    return float(determinants(arms).sum()) / 6.0


def _text(point: np.ndarray) -> str:
    return "[" + ", ".join(f"{x:.4g}" for x in point) + "]"
