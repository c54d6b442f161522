"""Response of one contact point to a prescribed displacement path, uncompiled: forces of a law and its energy
balance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dem_cli.core.arithmetic.products import product
from dem_cli.core.kernels.contact_point import make_press
from dem_cli.core.laws.law import Law
from dem_cli.declarations import Parameters


class OneJoint(NamedTuple):
    """Stiffness and law of one contact point, in the fields of kernels.records.Joints."""

    kn: np.ndarray  # [N/m], (1,)
    ks: np.ndarray  # [N/m], (1,)
    law: np.ndarray  # (1, n_parameters)


class OneContact(NamedTuple):
    """State of one contact point, in the fields of kernels.records.Contacts."""

    normal: np.ndarray  # [N], (1,)
    shear: np.ndarray  # [N], (1, d − 1)
    slip: np.ndarray  # [m], (1,)
    memory: np.ndarray  # (1, n_memory)


class PathResponse(NamedTuple):
    """Response to a displacement path, one row a step; work and energy from the start up to there."""

    path: np.ndarray  # gap and total slide [m], (n, d)
    normal: np.ndarray  # normal force, compression positive [N], (n,)
    shear: np.ndarray  # shear force on b [N], (n, d − 1)
    slip: np.ndarray  # path of the plastic slip under compression [m], (n,)
    lost: np.ndarray  # work lost in the joint [J], (n,)
    external: np.ndarray  # work of whoever moves block b, by the trapezoid rule [J], (n,)
    elastic: np.ndarray  # energy of the springs, N²/2kn + s²/2ks [J], (n,)
    memory: np.ndarray  # of the point, (n, n_memory)


def drive(
    law: Law,
    table: Parameters,
    path: ArrayLike,
    *,
    kn: float,
    ks: float | None = None,
    area: float = 1.0,
    start: float = 0.0,
    touches: bool = True,
    step: float = math.inf,
) -> PathResponse:
    """Move one point of block b along rows of (gap, slide...) [m] while block a stands still.

    law, table: a law and its [joints.*] table; a variant that the table asks for is found. kn, ks: stiffness per area
    [Pa/m], ks = kn by default; area of the point [m²]. start: gap before the first row [m]; touches: the point is
    one of those that touch at the start (bonds are intact). step: time that a row stands for [s], for laws with rates.
    """
    law, path = law.of(table), np.asarray(path, float)
    d = path.shape[1]
    columns = list(law.columns(table, kn))
    for column in law.rates:
        columns[column] *= step
    stiffness = np.array([kn * area]), np.array([(kn if ks is None else ks) * area])
    joint = OneJoint(*stiffness, np.array([columns], float))
    contact = OneContact(np.zeros(1), np.zeros((1, d - 1)), np.zeros(1), np.zeros((1, law.n_memory(d))))
    if touches:
        contact.memory[0, : len(law.intact)] = law.intact
    press, lost, work = make_press(law.function, law.bonded), 0.0, 0.0
    before, rows = np.array([start, *np.zeros(d - 1)]), []
    for row in path:
        moved, old = row - before, np.array([*contact.normal, *contact.shear[0]])
        if law.bonded or row[0] < 0.0 or old[0] != 0.0:
            lost += press(row[0], moved[0], tuple(moved[1:]), joint, contact, 0, 0)[2]
        forces = np.array([*contact.normal, *contact.shear[0]])
        work -= product(0.5 * (old + forces), moved)
        elastic = 0.5 * (forces[0] ** 2 / joint.kn[0] + product(forces[1:], forces[1:]) / joint.ks[0])
        rows.append((forces[0], forces[1:], contact.slip[0], lost, work, elastic, contact.memory[0].copy()))
        before = row
    return PathResponse(path, *(np.array(column) for column in zip(*rows, strict=True)))
