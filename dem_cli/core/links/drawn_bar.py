"""Bars as they are drawn: their input tables, their pieces in blocks, and the nodes and elements of these.

What holds them and how they act: links/bar.py.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, NamedTuple

import numpy as np

from dem_cli.declarations import KeyProblem, Limits, Name, Parameters, Positive, SpaceVector, parameter

FINE = 0.2  # μ l of elements by default


class BarProfile(Parameters):
    """[bars.NAME]: a kind of reinforcing bar: section, steel, bond."""

    area: Positive = parameter(description="cross-section; in 2D of all bars in the thickness [m2]", examples=[1.13e-4])
    young: Positive = parameter(description="Young's modulus [Pa]", examples=[2.0e11])
    yield_stress: Positive | None = parameter(
        default=None,
        description="yield stress in tension and compression, perfectly plastic [Pa]; default: no limit",
        examples=[4.0e8],
    )
    bond_stiffness: Positive = parameter(
        description="bond force per slip, per length of bar: N/m per m [Pa]", examples=[1.0e9]
    )
    bond_strength: Positive | None = parameter(
        default=None, description="largest bond force per length of bar [N/m]; default: no limit", examples=[4.0e4]
    )
    dowel_stiffness: Positive | None = parameter(
        default=None,
        description="as bond_stiffness, across the bar, where a joint bends it [Pa]; default: bond_stiffness",
        examples=[1.0e9],
    )

    @property
    def decay(self) -> float:
        """Decay rate of the bar force by bond, μ = √(kb/EA): along 1/μ the force of a pulled bar falls to 1/e [1/m]."""
        return math.sqrt(self.bond_stiffness / (self.young * self.area))

    @property
    def largest(self) -> float:
        """Yield force of the bar [N]."""
        return math.inf if self.yield_stress is None else self.yield_stress * self.area


class Reinforcement(Parameters):
    """[[reinforcement]]: a bar along a polyline through blocks, held by bond in each.

    Its path lies in blocks as they were drawn; these take it along.
    """

    id: Name | None = parameter(default=None, description="name; default: bar-1, bar-2 ...", examples=["corner-1"])
    bar: str = parameter(description="a name in [bars]", examples=["rebar"])
    path: Annotated[tuple[SpaceVector, ...], Limits(min_length=2)] = parameter(
        description="corners of the line along which it runs, all in blocks [m]",
        examples=[[[0.1, 0.1], [0.1, 2.0]]],
    )
    element: Positive | None = parameter(
        default=None, description="its elements are no longer than this [m]; default: 0.2 √(EA/bond_stiffness)",
        examples=[0.05],
    )  # fmt: skip
    anchored: tuple[Literal["start", "end"], ...] = parameter(
        default=(), description="ends that do not slip, as with a hook or a plate: start, end", examples=[["start"]]
    )

    def check(self) -> None:
        """Check that the corners of the path are different points; raises KeyProblem."""
        super().check()
        for i, (a, b) in enumerate(zip(self.path, self.path[1:])):
            if len(a) == len(b) and math.dist(a, b) == 0.0:
                raise KeyProblem("this corner is the one before it", "path", i + 1)


class BarPiece(NamedTuple):
    """Straight part of a bar in one block."""

    block: int
    ends: np.ndarray  # from the centroid of the block [m], (2, d)


class DrawnBar(NamedTuple):
    """Bar as it was drawn: its profile, and its pieces in the blocks one after another."""

    profile: BarProfile
    element: float  # greatest length of an element [m]
    anchored: tuple[bool, bool]
    pieces: tuple[BarPiece, ...]


class BarNodes(NamedTuple):
    """Nodes of one bar, one behind another, in the middles of equal parts of its pieces."""

    blocks: np.ndarray  # in which they lie, (n,)
    arms: np.ndarray  # from its centroid [m], (n, d)
    along: np.ndarray  # directions of the bar, (n, d)
    reach: np.ndarray  # lengths of bar that they stand for [m], (n,)
    places: np.ndarray  # from the start of the bar [m], (n,)


def nodes_of(bar: DrawnBar) -> BarNodes:
    """Place the nodes of a bar, no farther apart than its elements may be long."""
    blocks, arms, along, reach, places, upto = [], [], [], [], [], 0.0
    for piece in bar.pieces:
        way = piece.ends[1] - piece.ends[0]
        length = math.sqrt(float((way**2).sum()))
        count = max(1, math.ceil(length / bar.element - 1e-9))
        shares = (np.arange(count) + 0.5) / count
        blocks += [piece.block] * count
        arms.append(piece.ends[0] + shares[:, None] * way)
        along.append(np.tile(way / length, (count, 1)))
        reach += [length / count] * count
        places.append(upto + shares * length)
        upto += length
    return BarNodes(
        np.array(blocks, np.int64), np.concatenate(arms), np.concatenate(along), np.array(reach), np.concatenate(places)
    )


def elements_of(bar: DrawnBar, nodes: BarNodes) -> tuple[np.ndarray, np.ndarray]:
    """Axial stiffness of the elements of one bar [N/m], and which of them cross a joint, (n_nodes + 1,) each."""
    rigidity, reach = bar.profile.young * bar.profile.area, nodes.reach
    stiffness = np.zeros(len(reach) + 1)
    stiffness[1:-1] = rigidity / (0.5 * (reach[:-1] + reach[1:]))
    for end, place in ((0, 0), (1, -1)):
        stiffness[place] = rigidity / (0.5 * reach[place]) if bar.anchored[end] else 0.0
    crosses = np.zeros(len(stiffness), bool)
    crosses[1:-1] = nodes.blocks[:-1] != nodes.blocks[1:]
    return stiffness, crosses
