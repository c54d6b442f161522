"""Displacement path of one contact point, uncompiled: what a law answers, and what becomes of the work."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dem_cli.case.base import CaseModel
from dem_cli.kernels.contact_point import make_press
from dem_cli.laws.law import Law


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
    table: CaseModel,
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
    point_kn, point_ks = kn * area, (kn if ks is None else ks) * area
    columns = list(law.columns(table, kn))
    for column in law.rates:
        columns[column] *= step
    parameters, memory = np.array([columns], float), np.zeros((1, law.n_memory(d)))
    if touches:
        memory[0, : len(law.intact)] = law.intact
    press = make_press(law.function, law.bonded)
    normal, shear, lost, slip, work = 0.0, (0.0,) * (d - 1), 0.0, 0.0, 0.0
    before, rows = np.array([start, *shear]), []
    for row in path:
        moved, old = row - before, np.array([normal, *shear])
        if law.bonded or row[0] < 0.0 or normal != 0.0:
            normal, shear, path_length, loss = press(
                row[0], moved[0], tuple(moved[1:]), normal, shear, point_kn, point_ks, parameters, 0, memory, 0
            )
            lost, slip = lost + loss, slip + path_length
        work -= 0.5 * (old + np.array([normal, *shear])) @ moved
        elastic = 0.5 * (normal**2 / point_kn + np.dot(shear, shear) / point_ks)
        rows.append((normal, shear, slip, lost, work, elastic, memory[0].copy()))
        before = row
    return PathResponse(path, *(np.array(column) for column in zip(*rows, strict=True)))
