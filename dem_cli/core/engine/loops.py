"""Stepping loops, compiled for what a scene needs: one kinematics, one law, one kind of joints, one dimension."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from dem_cli.core.kernels.advance import make_advance
from dem_cli.core.kernels.contact_forces import make_contact_forces
from dem_cli.core.kernels.drift import (
    drift_bent_corners,
    drift_centroids,
    drift_corners,
    drift_solids,
    drift_strained_centroids,
    drift_strained_corners,
    drift_strained_solids,
    drift_strained_tumbling,
    drift_tumbling,
)
from dem_cli.core.kernels.planar_forces import make_planar_forces
from dem_cli.core.kernels.planar_profiles import make_profiled_forces
from dem_cli.core.kernels.shake import make_shake
from dem_cli.core.kernels.spatial_forces import make_spatial_forces
from dem_cli.core.kernels.tiles.tiled_forces import make_tiled_forces
from dem_cli.core.kernels.tiles.tiled_steps import make_tiled_advance
from dem_cli.core.laws.law import Law
from dem_cli.core.links.link import all_forces
from dem_cli.core.links.registry import LINKS

RIGID, LINEAR, QUADRATIC = 0, 1, 2  # polynomials that displacements within a block are


class Drifts(NamedTuple):
    """Kernels that move blocks, with their corners."""

    in_pseudo_time: Callable
    in_time: Callable  # with real masses, in seconds
    strained: Callable  # in pseudo-time, of blocks that deform
    strained_in_time: Callable


def _in_plane(law: Law, profiled: bool, **flags: bool) -> Callable:
    return (make_profiled_forces if profiled else make_planar_forces)(law.function, law.bonded, **flags)


def _in_space(law: Law, profiled: bool, keeps: bool = False, **flags: bool) -> Callable:
    return make_spatial_forces(law.function, law.bonded, remembers=law.n_memory(3), capped=profiled, **flags)


FORCES = {2: _in_plane, 3: _in_space}  # where geometry moves, by dimension: what makes the loop over joints of a law
DRIFTS = {
    2: Drifts(drift_corners, drift_corners, drift_strained_corners, drift_strained_corners),
    3: Drifts(drift_solids, drift_tumbling, drift_strained_solids, drift_strained_tumbling),
}


@cache
def compiled_advance(
    kinematics: str,
    law: Law,
    profiled: bool = False,
    dimension: int = 2,
    links: tuple[str, ...] = (),
    order: int = RIGID,
    tiled: bool = False,
    elastic: bool = False,
):
    """Build the stepping loop for one kinematics, one law, one kind of joints and some of links; compiled at its
    first call.

    links: kinds of links that the scene has (links/registry.py); order: of the displacements within blocks, RIGID,
    LINEAR or QUADRATIC, which no link knows; tiled: joints are in tiles (`FixedJoints.tiles`), which geometry of the
    start asks for; elastic: there are faces over which pressure is integrated (kernels/deformation/pressed_faces.py).
    """
    if tiled and law.of_lanes is not None:
        return make_tiled_advance(
            make_tiled_forces(law.of_lanes, law.n_of_lanes + elastic, elastic), _pull(links, False)
        )
    if order > RIGID:
        return _strained_advance(kinematics, law, profiled, dimension, order == QUADRATIC, elastic)
    if kinematics == "fixed":
        forces = make_contact_forces(law.function, law.bonded, elastic=elastic)
        return make_advance(forces, drift_centroids, _pull(links, False))
    forces = FORCES[dimension](law, profiled, rigid=True, elastic=elastic)
    return make_advance(forces, DRIFTS[dimension].in_pseudo_time, _pull(links, True))


def _strained_advance(kinematics: str, law: Law, profiled: bool, dimension: int, bends: bool, elastic: bool):
    if kinematics == "fixed":
        forces = make_contact_forces(law.function, law.bonded, True, bends, elastic)
        return make_advance(forces, drift_strained_centroids, strains=True, bends=bends)
    flags = {"rigid": True, "strains": True, "elastic": elastic}
    if bends:  # tables ask for joints of more than two points, in the plane
        forces = make_profiled_forces(law.function, law.bonded, bends=True, **flags)
        return make_advance(forces, drift_bent_corners, strains=True, moves=True, bends=True)
    return make_advance(
        FORCES[dimension](law, profiled, **flags), DRIFTS[dimension].strained, strains=True, moves=True
    )  # fmt: skip


@cache
def compiled_shake(
    law: Law,
    profiled: bool,
    damped: bool,
    dimension: int = 2,
    links: tuple[str, ...] = (),
    order: int = RIGID,
):
    """Build the stepping loop of time histories, as compiled_advance; compiled at its first call."""
    flags = {"keeps": damped, "meets": True}
    if order == QUADRATIC:
        forces = make_profiled_forces(law.function, law.bonded, strains=True, bends=True, **flags)
        return make_shake(forces, drift_bent_corners, damped, strains=True, bends=True)
    if order == LINEAR:
        forces = FORCES[dimension](law, profiled, strains=True, **flags)
        return make_shake(forces, DRIFTS[dimension].strained_in_time, damped, strains=True)
    forces = FORCES[dimension](law, profiled, **flags)
    return make_shake(forces, DRIFTS[dimension].in_time, damped, _pull(links, True))


def _pull(links: tuple[str, ...], moves: bool) -> Callable | None:
    """Combine the force kernels of these kinds of links; None: there are none."""
    return all_forces([LINKS[kind].forces[moves] for kind in links]) if links else None
