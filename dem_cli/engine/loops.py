"""Stepping loops, compiled for what a scene needs: one kinematics, one law, one kind of joints."""

from __future__ import annotations

from functools import cache

from dem_cli.kernels.advance import make_advance
from dem_cli.kernels.contact_forces import make_contact_forces
from dem_cli.kernels.drift import drift_centroids, drift_corners
from dem_cli.kernels.planar_forces import make_planar_forces
from dem_cli.kernels.planar_profiles import make_profiled_forces
from dem_cli.kernels.shake import make_shake
from dem_cli.laws.law import Law


@cache
def compiled_advance(kinematics: str, law: Law, profiled: bool = False):
    """The stepping loop for one kinematics, one law and one kind of joints; compiled at its first call."""
    if kinematics == "fixed":
        return make_advance(make_contact_forces(law.function, law.bonded), drift_centroids)
    make = make_profiled_forces if profiled else make_planar_forces
    return make_advance(make(law.function, law.bonded, rigid=True), drift_corners)


@cache
def compiled_shake(law: Law, profiled: bool, damped: bool):
    """The stepping loop of time histories for one law and one kind of joints; compiled at its first call."""
    make = make_profiled_forces if profiled else make_planar_forces
    return make_shake(make(law.function, law.bonded, keeps=damped, meets=True), drift_corners, damped)
