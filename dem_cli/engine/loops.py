"""Stepping loops, compiled for what a scene needs: one kinematics, one law, one kind of joints, one dimension."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from dem_cli.kernels.advance import make_advance
from dem_cli.kernels.contact_forces import make_contact_forces
from dem_cli.kernels.drift import drift_centroids, drift_corners, drift_solids, drift_tumbling
from dem_cli.kernels.planar_forces import make_planar_forces
from dem_cli.kernels.planar_profiles import make_profiled_forces
from dem_cli.kernels.shake import make_shake
from dem_cli.kernels.spatial_forces import make_spatial_forces
from dem_cli.laws.law import Law
from dem_cli.links.link import all_forces
from dem_cli.links.registry import LINKS


class Drifts(NamedTuple):
    """What moves blocks, with their corners."""

    in_pseudo_time: Callable
    in_time: Callable  # with real masses, in seconds


def _in_plane(law: Law, profiled: bool, **flags: bool) -> Callable:
    return (make_profiled_forces if profiled else make_planar_forces)(law.function, law.bonded, **flags)


def _in_space(law: Law, profiled: bool, **flags: bool) -> Callable:
    return make_spatial_forces(law.function, law.bonded, remembers=law.n_memory(3), capped=profiled, **flags)


FORCES = {2: _in_plane, 3: _in_space}  # where geometry moves, by dimension: what makes the loop over joints of a law
DRIFTS = {2: Drifts(drift_corners, drift_corners), 3: Drifts(drift_solids, drift_tumbling)}


@cache
def compiled_advance(
    kinematics: str, law: Law, profiled: bool = False, dimension: int = 2, links: tuple[str, ...] = ()
):
    """The stepping loop for one kinematics, one law, one kind of joints and some of links; compiled at its first call.

    links: kinds of links that the scene has (links/registry.py).
    """
    if kinematics == "fixed":
        return make_advance(make_contact_forces(law.function, law.bonded), drift_centroids, _pull(links, False))
    forces = FORCES[dimension](law, profiled, rigid=True)
    return make_advance(forces, DRIFTS[dimension].in_pseudo_time, _pull(links, True))


@cache
def compiled_shake(law: Law, profiled: bool, damped: bool, dimension: int = 2, links: tuple[str, ...] = ()):
    """The stepping loop of time histories, as compiled_advance; compiled at its first call."""
    forces = FORCES[dimension](law, profiled, keeps=damped, meets=True)
    return make_shake(forces, DRIFTS[dimension].in_time, damped, _pull(links, True))


def _pull(links: tuple[str, ...], moves: bool) -> Callable | None:
    """What adds the forces of these kinds of links; None: there are none."""
    return all_forces([LINKS[kind].forces[moves] for kind in links]) if links else None
