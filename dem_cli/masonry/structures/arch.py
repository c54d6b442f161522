"""Generate arches of voussoirs: circular, segmental, pointed, flat; on springings, columns or buttresses."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase
from dem_cli.core.arithmetic import functions
from dem_cli.core.geometry import polygon
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.bases import base_block


class Pier(CaseModel):
    """Pier of equal blocks, flush with the inner face of the ring, its top cut to the springing joint."""

    width: Positive = Field(description="width [m]; at least that of the springing joint", examples=[0.8])
    height: Positive = Field(
        description="height of the inner face, from the ground to the springing [m]", examples=[1.6]
    )
    courses: int = Field(1, ge=1, le=10_000, description="number of blocks that it consists of")
    material: str = Field("", description="a name in [materials]; default: that of the arch", examples=["brick"])


FINEST = math.radians(2.0)  # between corners of a face that follows a circle
SHAPE_KEYS = {
    "circular": ("radius", "inner_radius", "included_angle_deg"),
    "segmental": ("span", "rise"),
    "pointed": ("span", "rise", "inner_radius"),
    "flat": ("span", "skew_deg"),
}


class Arch(StructureBase):
    """Arch of voussoirs over a span. Local origin: mid-span, on the ground below the piers; without piers at the
    level of the springings (where the inner face starts). In 3D half of the thickness lies to either side of it.

    Block names: "<id>-<number>" for voussoirs from left to right, from 1; "<id>-left-<number>" and
    "<id>-right-<number>" for piers from below; "<id>-base-left", "<id>-base-right" for what is fixed.
    """

    kind: Literal["arch"] = "arch"
    shape: Literal["circular", "segmental", "pointed", "flat"] = Field(
        "circular",
        description="circular: by radius and angle; segmental: part of a circle, by span and rise; "
        "pointed: two arcs; flat: straight, wedge-shaped voussoirs",
    )
    joints: Literal["radial", "vertical"] = Field(
        "radial",
        description="how a circular arch is cut; radial: towards its centre; vertical: a half ring by upright joints, "
        "on level supports as wide as the ring",
        examples=["vertical"],
    )
    voussoirs: int = Field(
        ge=1,
        le=10_000,
        description="number of voussoirs; even for a pointed arch; of vertical joints those over the clear span, with "
        "more of about the same width on the supports",
        examples=[21],
    )
    ring: Positive = Field(description="depth of the ring, from inner to outer face [m]", examples=[0.15])
    radius: Positive | None = Field(None, description="radius of the middle of the ring [m] (circular)", examples=[1.0])
    inner_radius: Positive | None = Field(
        None, description="radius of the inner face [m] (circular, pointed)", examples=[0.925]
    )
    included_angle_deg: float | None = Field(
        None,
        gt=0.0,
        lt=360.0,
        description="from springing to springing [deg] (circular); default: 180",
        examples=[160.0],
    )
    span: Positive | None = Field(None, description="clear span [m] (segmental, pointed, flat)", examples=[2.0])
    rise: Positive | None = Field(None, description="rise of the inner face [m] (segmental, pointed)", examples=[0.5])
    skew_deg: float | None = Field(
        None,
        ge=0.0,
        lt=80.0,
        description="outermost joints against the vertical [deg] (flat); default: 20",
        examples=[20.0],
    )
    thickness: Positive = Field(1.0, description="depth out of plane [m]")
    columns: Pier | None = Field(
        None,
        description="columns below the springings; default: none, the springings are fixed",
        examples=[{"width": 0.3, "height": 1.0, "courses": 4}],
    )
    buttresses: Pier | None = Field(
        None,
        description="buttresses below the springings, the same as columns; default: none",
        examples=[{"width": 0.8, "height": 1.0, "courses": 4}],
    )
    base_extension: NonNegative = Field(
        0.0,
        description="how far the fixed ground goes beyond each side of a column or buttress, in 3D also beyond its "
        "faces [m]",
        examples=[1.5],
    )
    base: bool = Field(
        True,
        description="fixed blocks below the piers or behind the springings; false: other blocks are below it",
    )

    @property
    def piers(self) -> Pier | None:
        """Piers that carry the arch; None for fixed springings."""
        return self.columns or self.buttresses

    @property
    def on_ground(self) -> bool:
        """Tell whether a [ground] block replaces the base of the piers; springings without piers stay fixed."""
        return self.piers is not None

    @model_validator(mode="after")
    def _consistent(self) -> Arch:
        keys = SHAPE_KEYS[self.shape]
        for key in sorted({key for other in SHAPE_KEYS.values() for key in other} - set(keys)):
            if getattr(self, key) is not None:
                raise KeyProblem(f"not used by a {self.shape} arch, which is given by {', '.join(keys)}", key)
        if self.columns and self.buttresses:
            raise KeyProblem("an arch stands on columns or on buttresses, not on both", "buttresses")
        SHAPE_JOINTS[self.shape](self)
        if self.piers:
            _check_piers(self, self.piers)
        if not self.base and self.base_extension:
            raise KeyProblem("not used without base", "base_extension")
        _check_vertical(self)
        return self


def _check_vertical(arch: Arch) -> None:
    if arch.joints == "radial":
        return
    if arch.shape != "circular" or (arch.included_angle_deg or 180.0) != 180.0:
        raise KeyProblem("'vertical' is only allowed of a half ring: shape = 'circular', 180 degrees", "joints")
    if arch.piers:
        raise KeyProblem(
            "'vertical' is not allowed on columns or buttresses; the half ring stands on supports", "joints"
        )


def _check_piers(arch: Arch, piers: Pier) -> None:
    (inner, outer), key = SHAPE_JOINTS[arch.shape](arch)[0], "columns" if arch.columns else "buttresses"
    if outer[1] < inner[1] - 1e-9 * arch.ring:
        message = f"{arch.included_angle_deg:g} is not allowed; must be at most 180 for an arch on piers"
        raise KeyProblem(message, "included_angle_deg")
    least = inner[0] - outer[0]
    if piers.width < least * (1 - 1e-9):
        message = f"{piers.width:g} is not allowed; must be at least {least:g}, as the springing joint"
        raise KeyProblem(message, key, "width")


def _exactly_one(arch: Arch, *keys: str) -> tuple[str, float]:
    """Return the only given one of these keys, and its value."""
    given = [(key, value) for key in keys if (value := getattr(arch, key)) is not None]
    if len(given) != 1:
        found = "found none" if not given else "found both"
        raise KeyProblem(f"a {arch.shape} arch needs either {' or '.join(keys)}; {found}", keys[0])
    return given[0]


def _required(arch: Arch, *keys: str) -> list[float]:
    """Return the values of required keys. Raises KeyProblem for a missing one."""
    for key in keys:
        if getattr(arch, key) is None:
            raise KeyProblem(f"missing: a {arch.shape} arch needs {' and '.join(keys)}", key)
    return [getattr(arch, key) for key in keys]


def _arc(inner_radius: float, ring: float, half_angle: float, voussoirs: int) -> np.ndarray:
    """Compute the joints [inner, outer] of a symmetric arc from left to right, inner feet at y = 0, (n + 1, 2, 2)."""
    angles = half_angle * (1.0 - 2.0 * np.arange(voussoirs + 1) / voussoirs)
    directions = np.stack([-np.sin(angles), np.cos(angles)], axis=1)
    joints = directions[:, None, :] * np.array([inner_radius, inner_radius + ring])[None, :, None]
    joints[:, :, 1] -= inner_radius * np.cos(half_angle)
    joints[np.abs(joints) < 1e-14 * (inner_radius + ring)] = 0.0
    return joints


def _circular(arch: Arch) -> np.ndarray:
    key, radius = _exactly_one(arch, "radius", "inner_radius")
    inner = radius if key == "inner_radius" else radius - arch.ring / 2.0
    if inner <= 0.0:
        message = f"{radius:g} is not allowed; must be more than {arch.ring / 2:g}, half the ring"
        raise KeyProblem(message, "radius")
    angle = 180.0 if arch.included_angle_deg is None else arch.included_angle_deg
    return _arc(inner, arch.ring, np.radians(angle) / 2.0, arch.voussoirs)


def _segmental(arch: Arch) -> np.ndarray:
    span, rise = _required(arch, "span", "rise")
    half = span / 2.0
    if rise > half * (1.0 + 1e-9):
        message = f"{rise:g} is not allowed; must be at most {half:g} (half the span, a semicircle)"
        raise KeyProblem(message, "rise")
    half_angle = 2.0 * functions.arctan2(rise, half)
    return _arc(half / np.sin(half_angle), arch.ring, half_angle, arch.voussoirs)


def _pointed(arch: Arch) -> np.ndarray:
    (span,) = _required(arch, "span")
    key, value = _exactly_one(arch, "rise", "inner_radius")
    half, sides = span / 2.0, arch.voussoirs // 2
    if arch.voussoirs % 2:
        message = f"{arch.voussoirs} is not allowed; must be even: a pointed arch has a joint at the top"
        raise KeyProblem(message, "voussoirs")
    if value < half * (1.0 - 1e-9):
        message = f"{value:g} is not allowed; must be at least {half:g} (half the span, a semicircle)"
        raise KeyProblem(message, key)
    inner = value if key == "inner_radius" else (half**2 + value**2) / span
    radii = np.array([inner, inner + arch.ring])
    centre = max(inner - half, 0.0)
    angles = functions.arccos(centre / inner) * np.arange(sides + 1) / sides  # of the left arc, from its springing
    left = np.stack([-np.cos(angles), np.sin(angles)], axis=1)[:, None, :] * radii[None, :, None]
    left[:, :, 0] += centre
    left[-1] = np.stack([[0.0, 0.0], np.sqrt(radii**2 - centre**2)], axis=1)  # vertical at the top
    return np.concatenate([left, left[-2::-1] * [-1.0, 1.0]])


def _flat(arch: Arch) -> np.ndarray:
    (span,) = _required(arch, "span")
    inner = span * (np.arange(arch.voussoirs + 1) / arch.voussoirs - 0.5)
    slope = functions.tan(np.radians(20.0 if arch.skew_deg is None else arch.skew_deg))
    outer = inner * (1.0 + arch.ring * slope / (span / 2.0))
    joints = np.zeros((arch.voussoirs + 1, 2, 2))
    joints[:, 0, 0], joints[:, 1, 0], joints[:, 1, 1] = inner, outer, arch.ring
    return joints


SHAPE_JOINTS: dict[str, Callable[[Arch], np.ndarray]] = {
    "circular": _circular,
    "segmental": _segmental,
    "pointed": _pointed,
    "flat": _flat,
}


def build(arch: Arch) -> list[Block]:
    """Generate the blocks of an arch in local coordinates: fixed ones, piers from below, voussoirs left to right."""
    joints = SHAPE_JOINTS[arch.shape](arch)
    if arch.joints == "vertical":
        return _upright_blocks(arch, *np.abs(joints[0, :, 0]))
    if arch.piers:
        joints[:, :, 1] += arch.piers.height
    blocks = _bases(arch, joints) + (_pier_blocks(arch, arch.piers, joints) if arch.piers else [])
    for k in range(arch.voussoirs):
        shape = np.array([joints[k, 0], joints[k + 1, 0], joints[k + 1, 1], joints[k, 1]])
        if not polygon.is_convex(shape):
            raise ValueError(f"voussoir {k + 1} is not convex; use more voussoirs or a thinner ring")
        blocks.append(Block(f"{k + 1}", (polygon.simplified(shape),), "", arch.thickness))
    return blocks


def _upright_blocks(arch: Arch, inner: float, outer: float) -> list[Block]:
    """Generate the fixed supports and the voussoirs of a half ring with vertical joints, from left to right.

    inner, outer: radii [m]. Joints over the span are at equal distances, those over a support about as far apart. Faces
    follow the circles by corners; a block whose inner face has some consists of convex parts.
    """
    several = max(1, round((outer - inner) * arch.voussoirs / (2.0 * inner)))
    over_support = np.linspace(inner, outer, several + 1)
    cuts = np.concatenate([-over_support[::-1], np.linspace(-inner, inner, arch.voussoirs + 1)[1:-1], over_support])
    blocks = []
    for side, left in (("left", -outer), ("right", inner)) if arch.base else ():
        shape = polygon.rectangle(left, -arch.ring, arch.ring, arch.ring)
        blocks.append(base_block(f"base-{side}", shape, arch.thickness, 0.0))
    for k, ends in enumerate(zip(cuts, cuts[1:], strict=False)):
        foot = _on_circle(inner, *ends)
        parts = tuple(
            polygon.simplified(np.concatenate([foot[i : i + 2], _on_circle(outer, *foot[i : i + 2, 0])[::-1]]))
            for i in range(len(foot) - 1)
        )
        blocks.append(Block(f"{k + 1}", parts, "", arch.thickness))
    return blocks


def _on_circle(radius: float, left: float, right: float) -> np.ndarray:
    """Return corners along the upper half of a circle about the origin, at most `FINEST` apart, (n, 2).

    left, right: where they begin and end along x [m]; beyond the circle the corners are at the level of its centre.
    """
    angles = functions.arccos(np.clip([left / radius, right / radius], -1.0, 1.0))
    along = np.linspace(angles[0], angles[1], max(2, math.ceil((angles[0] - angles[1]) / FINEST) + 1))
    corners = radius * np.stack([np.cos(along), np.sin(along)], axis=1)
    corners[[0, -1], 0] = left, right
    corners[np.abs(corners) < 1e-14 * radius] = 0.0
    return corners


def _bases(arch: Arch, joints: np.ndarray) -> list[Block]:
    """Generate the two fixed blocks: below a pier as wide as it, or behind a springing joint, square to it."""
    if not arch.base:
        return []
    blocks = []
    for side, (inner, outer) in (("left", joints[0]), ("right", joints[-1])):
        sign = -1.0 if side == "left" else 1.0
        if arch.piers:
            height, reach = arch.ring, arch.piers.width + arch.base_extension
            ends = sorted([inner[0] - sign * arch.base_extension, inner[0] + sign * reach])
            shape = polygon.rectangle(ends[0], -height, ends[1] - ends[0], height)
        else:
            along = outer - inner
            back = np.array([along[1], -along[0]]) * sign
            corners = [inner, outer, outer + back, inner + back]
            shape = np.array(corners[::-1] if side == "right" else corners)
        blocks.append(base_block(f"base-{side}", shape, arch.thickness, arch.base_extension if arch.piers else 0.0))
    return blocks


def _pier_blocks(arch: Arch, pier: Pier, joints: np.ndarray) -> list[Block]:
    """Generate the rectangular blocks of a pier from below; the uppermost one is cut to the springing joint."""
    blocks = []
    levels = pier.height * np.arange(pier.courses + 1) / pier.courses
    for side, (inner, outer) in (("left", joints[0]), ("right", joints[-1])):
        sign = -1.0 if side == "left" else 1.0
        face, back = inner[0], inner[0] + sign * pier.width
        for k in range(pier.courses):
            low, high = levels[k : k + 2]
            corners = [[back, low], [face, low], [face, high], [back, high]]
            if k == pier.courses - 1:
                corners[2:] = [inner, outer, [back, outer[1]]]
            shape = polygon.simplified(np.array(corners[:: -int(sign)]))
            blocks.append(Block(f"{side}-{k + 1}", (shape,), pier.material, arch.thickness, course=k + 1))
    return blocks
