"""Benchmark structures in space, each with the best-known load and where it comes from.

Where friction holds a wall back out of its plane, statics alone (the associated load, `upper`) says several times too
much; the reference is the bracket of a fine search, and `path`, the zero-dilation load by `dem limit`, its check.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

from bench.cases import BLOCKS_KEY, COURSES_KEY, KnownStructure, solve

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

WIDTH, DEPTH, HEIGHT = 0.4, 0.3, 1.0  # m, of the block
LENGTH, TALL = 20.0, 10.0  # m, of the wall
MODULUS = 2.5e9  # Pa, of its stone: kn × height of a block
SEARCH = "dem, resolution 0.0005"


def friction_of(case: Case) -> float:
    """Friction coefficient of the only kind of joint."""
    (joint,) = case.joints.values()
    return float(joint.coefficient)


def _block(azimuth: int) -> KnownStructure:
    x, y = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    load = min(WIDTH / HEIGHT / x, DEPTH / HEIGHT / y)
    source = f"closed form: min({WIDTH:g} / cos ψ, {DEPTH:g} / sin ψ) / {HEIGHT:g}"
    return KnownStructure(
        f"block {azimuth}°", "spatial/block", (f"analysis.direction=[{x!r}, {y!r}, 0.0]",), load, source
    )


def wall_out_of_plane(courses: int, blocks: int, load: float = math.nan, upper: float | None = None) -> KnownStructure:
    """The wall of 20 × 10 × 0.8 m in so many courses of so many blocks; nan: no load of it is known."""
    count = (courses // 2) * (2 * blocks + 1) + courses % 2 * blocks  # every other course has one more
    overrides = (
        COURSES_KEY.format(courses), BLOCKS_KEY.format(blocks),
        f"structure.0.block=[{LENGTH / blocks!r}, {TALL / courses!r}]",
        f"joints.dry.kn={MODULUS * courses / TALL!r}", f"joints.dry.ks={0.4 * MODULUS * courses / TALL!r}",
    )  # fmt: skip
    return KnownStructure(f"wall {count:,}", "spatial/wall", overrides, load, SEARCH, upper)


KNOWN_IN_SPACE = {
    known.name: known
    for known in (
        _block(30),
        _block(60),
        KnownStructure("panel", "spatial/panel", (), 0.125, "closed form: turns over at thickness / height"),
        KnownStructure("L wall", "spatial/l_wall", (), 0.285812, SEARCH, 0.361778, 0.285595),
        wall_out_of_plane(10, 20, 0.206328, 0.371604),
    )
}
SIZES_IN_SPACE = (
    wall_out_of_plane(5, 10),
    wall_out_of_plane(10, 20),
    wall_out_of_plane(16, 32),
    wall_out_of_plane(22, 45),
    wall_out_of_plane(32, 64),
)
MANY = wall_out_of_plane(70, 143)


@cache
def compiled_in_space() -> None:
    """Have all kernels of a run in space compiled or loaded, so that nobody's time holds that."""
    solve(*KNOWN_IN_SPACE["panel"].build("analysis.resolution=0.1"))
