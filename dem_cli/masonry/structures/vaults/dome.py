"""Generate domes of plane facets: corners on two spheres, bed faces towards their centre, shared faces.

Between two meridians and two parallels the corners make a hexahedron with plane faces: its beds and heads go through
the centre, inner and outer face are trapezia. A stone is one or more of them side by side: with two, heads of one
course lie above the middle of stones of the next, and still all corners coincide.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.arithmetic import functions
from dem_cli.core.geometry.frusta import frustum, skewed
from dem_cli.core.geometry.polyhedron import Polyhedron
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.vaults.table import Vault

Solids = tuple[Polyhedron, ...]
DOWN = np.array([0.0, 0.0, -1.0])


def build_dome(vault: Vault) -> list[Block]:
    """Generate the blocks of a dome: base, drum, courses from the springing up, cap."""
    counts, facets = _counts(vault)
    angles = parallels(vault)
    inner, outer = _required(vault.radius) - vault.thickness / 2.0, _required(vault.radius) + vault.thickness / 2.0
    if inner <= 0.0:
        message = f"{vault.radius:g} is not allowed; must be more than {vault.thickness / 2:g}, half the thickness"
        raise KeyProblem(message, "radius")
    lift = vault.drum.height if vault.drum else 0.0
    corners = _corners(angles, (inner, outer), facets)
    corners[..., 2] += lift - corners[0, 0, 0, 2]
    firsts = _first_heads(vault, counts, facets)
    blocks = _below(vault, corners[0], counts[0])
    for k in range(len(counts)):
        solids = [(frustum(_bed(corners[k], j), _bed(corners[k + 1], j)),) for j in range(facets)]
        blocks += _stones(f"{k + 1}", solids, counts[k], firsts[k], course=k + 1)
    if _has_cap(vault):
        blocks.append(Block("cap", (frustum(corners[-1, 0], corners[-1, 1]),), "", course=len(counts) + 1))
    return blocks


def parallels(vault: Vault) -> np.ndarray:
    """Return the angles of the bed joints from the crown, from the springing up [rad], (courses + 1,)."""
    courses, springing = _required(vault.courses), np.radians(vault.springing_deg)
    if vault.oculus_radius is not None:
        sine, key = vault.oculus_radius / (_required(vault.radius) - vault.thickness / 2.0), "oculus_radius"
        top = functions.arcsin(min(sine, 1.0))
    elif vault.oculus_deg is not None:
        top, key = np.radians(vault.oculus_deg), "oculus_deg"
    else:  # a cap that reaches down by half a course
        return np.linspace(springing, springing / (2 * courses + 1), courses + 1)
    if top >= springing * (1.0 - 1e-9):
        message = f"{getattr(vault, key):g} is not allowed; the dome springs at {vault.springing_deg:g} degrees"
        raise KeyProblem(message, key)
    return np.linspace(springing, top, courses + 1)


def _has_cap(vault: Vault) -> bool:
    open_top = vault.oculus_deg is not None or vault.oculus_radius is not None
    return not open_top if vault.cap is None else vault.cap


def _counts(vault: Vault) -> tuple[list[int], int]:
    """Return the number of stones in each course and of facets around. Raises KeyProblem."""
    given, courses = vault.per_course, _required(vault.courses)
    counts = list(given) if isinstance(given, tuple) else [_required(given)] * courses
    if len(counts) != courses:
        raise KeyProblem(f"{len(counts)} values; must be one for each of the {courses} courses", "per_course")
    pieces = 2 if vault.bond == "running" else 1
    facets = vault.facets or pieces * max(counts)
    for k, count in enumerate(counts):
        if facets % (pieces * count):
            of = f"{pieces} times " if pieces > 1 else ""
            message = f"{count} is not allowed; {of}the stones of a course must divide the {facets} facets around"
            raise KeyProblem(message, "per_course", *([k] if isinstance(given, tuple) else []))
    return counts, facets


def _first_heads(vault: Vault, counts: Sequence[int], facets: int) -> list[int]:
    """Return the first facet of the first stone of each course: above the middle of a stone below."""
    firsts = [0]
    for below, here in zip(counts[:-1], counts[1:], strict=True):
        shift = facets // max(below, here) // 2 if vault.bond == "running" else 0
        firsts.append((firsts[-1] + shift) % (facets // here))
    return firsts


def _corners(angles: np.ndarray, radii: tuple[float, float], facets: int) -> np.ndarray:
    """Compute the corners (parallels, inner and outer, meridians, 3) on two spheres about the origin."""
    turns = 2.0 * np.pi * np.arange(facets) / facets
    sines, cosines = np.sin(angles), np.cos(angles)
    cosines[angles == np.pi / 2.0] = 0.0
    directions = np.empty((len(angles), facets, 3))
    directions[..., 0], directions[..., 1] = np.outer(sines, np.cos(turns)), np.outer(sines, np.sin(turns))
    directions[..., 2] = cosines[:, None]
    return directions[:, None] * np.array(radii)[None, :, None, None]


def _bed(parallel: np.ndarray, j: int) -> np.ndarray:
    """Return the bed face of facet j on a parallel (inner and outer, meridians, 3), (4, 3)."""
    after = (j + 1) % parallel.shape[1]
    return np.array([parallel[0, j], parallel[1, j], parallel[1, after], parallel[0, after]])


def _stones(prefix: str, solids: Sequence[Solids], count: int, first: int, **others: Any) -> list[Block]:
    """Combine the facets around a course to its stones."""
    each = len(solids) // count
    blocks = []
    for n in range(count):
        own = [solids[(first + n * each + i) % len(solids)] for i in range(each)]
        parts = tuple(part for parts in own for part in parts)
        blocks.append(Block(f"{prefix}-{n + 1}", parts, **({"material": ""} | others)))
    return blocks


def _below(vault: Vault, springing: np.ndarray, count: int) -> list[Block]:
    """Generate the drum, its uppermost course cut to the springing, and a fixed block below each stone."""
    facets = springing.shape[1]
    blocks: list[Block] = []
    foot = [_bed(springing, j) for j in range(facets)]
    if vault.drum:
        foot, blocks = _drum(vault, springing, count)
    if not vault.base:
        return blocks
    ground = [(skewed(face, vault.thickness * DOWN),) for face in foot]
    return _stones("base", ground, count, 0, fixed=True) + blocks


def _drum(vault: Vault, springing: np.ndarray, count: int) -> tuple[list[np.ndarray], list[Block]]:
    """Return foot faces by facet, and the courses of the drum from below; the uppermost ends level with the outer
    face.
    """
    drum = _required(vault.drum)
    inner, outer = springing
    reach, least = np.hypot(*inner[0, :2]) + drum.width, np.hypot(*outer[0, :2]) - np.hypot(*inner[0, :2])
    if drum.width < least * (1.0 - 1e-9):
        message = f"{drum.width:g} is not allowed; must be at least {least:g}, as the springing joint"
        raise KeyProblem(message, "drum", "width")
    wider = drum.width > least * (1.0 + 1e-9)
    rim = outer * [*[reach / np.hypot(*outer[0, :2])] * 2, 1.0] if wider else outer
    wall = np.stack([inner, rim])
    tops = [springing, np.stack([outer, rim])] if wider and vault.springing_deg < 90.0 else [wall]
    levels = drum.height * np.arange(drum.courses + 1) / drum.courses
    blocks, each = [], len(inner) // count
    for k, level in enumerate(levels[:-1]):
        highs = tops if k == drum.courses - 1 else [_level(wall, levels[k + 1])]
        solids = [
            tuple(frustum(_bed(_level(high, level), j), _bed(high, j)) for high in highs) for j in range(len(inner))
        ]
        first = each // 2 if vault.bond == "running" and (drum.courses - k) % 2 else 0
        blocks += _stones(f"drum-{k + 1}", solids, count, first, course=k + 1, material=drum.material)
    foot = _level(wall, 0.0)
    return [_bed(foot, j) for j in range(len(inner))], blocks


def _level(ring: np.ndarray, height: float) -> np.ndarray:
    """Project a ring (..., 3) vertically to a level [m]."""
    return ring * [1.0, 1.0, 0.0] + [0.0, 0.0, height]


def _required(value: Any) -> Any:
    """Return a value that the table has already checked to be present."""
    assert value is not None
    return value
