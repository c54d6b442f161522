"""What tests of joint laws need: tables, displacement paths, points moved through the compiled contact loop."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from dem_cli.case.base import CaseModel
from dem_cli.case.tables.declared import table_of
from dem_cli.core.contact.joints import empty_contacts
from dem_cli.core.kernels.contact_forces import make_contact_forces
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.kernels.records import FixedJoints
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.mixed import mixed, row
from dem_cli.core.laws.registry import LAWS

LIKE = {2: ((0.0, 0.0), (0.0,)), 3: ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))}


class Joint(NamedTuple):
    """A law with its table, and the stiffness of a point: per area [Pa/m], and the area [m²]."""

    law: Law
    table: CaseModel
    kn: float = 2.0**21
    ks: float = 2.0**20
    area: float = 1.0
    step: float = float("inf")  # time of a step [s], for laws with rates

    @property
    def columns(self) -> list[float]:
        values = list(self.law.columns(self.table, self.kn))
        for column in self.law.rates:
            values[column] *= self.step
        return values

    @property
    def stiffness(self) -> dict[str, float]:
        """What `drive` takes beside law, table and path."""
        return {"kn": self.kn, "ks": self.ks, "area": self.area, "step": self.step}


def joint(law: str, stiffness: dict[str, float] | None = None, **keys: Any) -> Joint:
    """The law by its name in case files, with the keys of its table."""
    table = table_of(LAWS[law].parameters).model_validate({"law": law, **keys})
    return Joint(LAWS[law].of(table), table, **(stiffness or {}))


def ramp(*targets: Sequence[float], n: int = 64, start: Sequence[float] | None = None) -> np.ndarray:
    """Straight from target to target, n steps each; exact in binary where targets and n are. From zero by default."""
    corners = [np.zeros(len(targets[0])) if start is None else np.asarray(start), *map(np.asarray, targets)]
    shares = np.arange(1, n + 1)[:, None] / n
    return np.concatenate([a + (b - a) * shares for a, b in zip(corners, corners[1:])])


class Blocks(NamedTuple):
    """What the loop takes of `Bodies`."""

    velocities: np.ndarray  # (n_blocks, n_dof)
    forces: np.ndarray  # (n_blocks, n_dof)
    stretchings: np.ndarray = np.zeros((0, 0))  # of blocks that deform


class Looped(NamedTuple):
    """What came out of the loop, one row a step."""

    normal: np.ndarray  # (n, n_joints)
    shear: np.ndarray  # (n, n_joints, d − 1)
    slip: np.ndarray  # (n, n_joints)
    lost: np.ndarray  # of all joints, up to the step, (n,)
    external: np.ndarray  # work of whoever moves the blocks b, (n,)
    elastic: np.ndarray  # of all springs, (n,)
    memory: np.ndarray  # in the end, (n_joints, n_memory)


@cache
def contact_loop(laws: tuple[Law, ...], compiled: bool):
    law = mixed(laws)
    plain = make_contact_forces(law.function, law.bonded)
    return kernel(plain) if compiled else plain


def through_loop(
    joints: Sequence[Joint], path, compiled: bool = True, touches: bool = True, start: float = 0.0, dt: float = 0.125
) -> Looped:
    """One point of each joint moved along the same rows of (gap, slide...) by its own block b, all in one loop."""
    path, laws = np.asarray(path, float), tuple({j.law.name: j.law for j in joints}.values())
    n, d = len(joints), path.shape[1]
    like, like_rotation = LIKE[d]
    arrays = FixedJoints(
        blocks=np.array([[0, 1 + i] for i in range(n)]), starts=np.arange(n + 1),
        axes=np.tile(np.eye(d).reshape(1, -1), (n, 1)), anchors=np.zeros((n, d)), arms=np.zeros((n, 2 * d)),
        places=np.zeros((n, d - 1)),
        kn=np.array([j.kn * j.area for j in joints]), ks=np.array([j.ks * j.area for j in joints]),
        law=np.stack([row(laws, j.law, j.columns, max(len(i.columns) for i in joints)) for j in joints]),
        torsion=np.ones(n),
    )  # fmt: skip
    contacts = empty_contacts(n, n, d, mixed(laws).n_memory(d))
    contacts.gaps[:] = start
    for i, j in enumerate(joints):
        contacts.memory[i, : len(j.law.intact)] = j.law.intact if touches else 0.0
    loop, rows, lost, external = contact_loop(laws, compiled), [], 0.0, 0.0
    before, old = np.zeros((n, d)), np.array([start, *np.zeros(d - 1)])
    for place in path:
        velocities, forces = np.zeros((1 + n, d + len(like_rotation))), np.zeros((1 + n, d + len(like_rotation)))
        velocities[1:, :d] = (place - old) / dt
        lost += loop(arrays, None, contacts, Blocks(velocities, forces), dt, like, like_rotation)
        external -= 0.5 * ((before + forces[1:, :d]) @ (place - old)).sum()
        before, old = forces[1:, :d].copy(), place
        elastic = 0.5 * (contacts.normal**2 / arrays.kn + (contacts.shear**2).sum(axis=1) / arrays.ks).sum()
        rows.append((contacts.normal.copy(), contacts.shear.copy(), contacts.slip.copy(), lost, external, elastic))
    return Looped(*map(np.array, zip(*rows)), contacts.memory)
