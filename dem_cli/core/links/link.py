"""Interface of a kind of link: elements between material points of blocks, whose forces follow those of the joints.

A kind is an input table, a record of arrays, and a compiled function:

    forces(arrays, bodies, like, like_rotation) -> work lost [J]

which adds its forces to bodies.forces and leaves in `state` what each element has. A new kind: one file with these and
a `Link` record, one line in the registry. Scenes without links compile none of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from dem_cli.core.kernels.jit import always_inline, inline, named
from dem_cli.declarations import Parameters

FIXED_POINT = -1  # in place of a block: a point that moves with the base alone
PLASTIC, STRETCH, FORCE = 0, 1, 2  # columns of LinkArrays.state
N_STATE = 3


class LinkEnds(NamedTuple):
    """Blocks and end points of a link as it was drawn, the second block maybe FIXED_POINT."""

    blocks: tuple[int, int]
    points: np.ndarray  # [m], (2, d)


class Springs(NamedTuple):
    """Linear springs that links are for small motions of their blocks, one behind another."""

    blocks: np.ndarray  # whose motion makes each longer, FIXED_POINT: none, (n, 2 or more) int64
    motion: np.ndarray  # how much longer each becomes per motion of each block, (n, 2 or more, n_dof)
    stiffness: np.ndarray  # [N/m], (n,)


class LinkReading(NamedTuple):
    """Reading of a link by a monitor: a weighted sum of one column of rows of its state."""

    rows: tuple[int, ...]
    column: int  # PLASTIC, STRETCH or FORCE
    weights: tuple[float, ...]


class Outline(NamedTuple):
    """Outlines of links as lines through points, one after the other."""

    counts: np.ndarray  # points of each, (n_links,) int64
    blocks: np.ndarray  # of each point, or FIXED_POINT, (n_points,) int64
    arms: np.ndarray  # from the centroid of its block, undeformed; of a fixed point its place [m], (n_points, d)
    forces: np.ndarray  # axial, tension positive [N], (n_points,)


class LinkArrays(Protocol):
    """Elements of one kind of link, as its compiled function sees them; a NamedTuple of arrays."""

    blocks: np.ndarray  # pairs of blocks that they hold together; the second may be FIXED_POINT, (n, 2) int64
    state: np.ndarray  # what changes, spring by spring: plastic elongation, elongation [m], force [N], (m, 3)

    @property
    def kind(self) -> str:
        """Name of this kind of link in the registry."""

    @property
    def n_drawn(self) -> int:
        """Number of links that were drawn, one after the other in `Model.link_names`."""

    def started(self, origin: np.ndarray) -> LinkArrays:
        """Copy the links for a simulation that counts places from `origin`, with the forces of the start."""

    def axial(self, bodies: Any = None) -> Springs:
        """Return springs along the elements where the blocks are now; None: where they were drawn."""

    def acting(self) -> np.ndarray:
        """Test which of the axial springs carry a force now, (n_springs,) bool."""

    def across(self, bodies: Any = None) -> Springs:
        """Return springs across the elements, at least as stiff as the geometric stiffness of their forces."""

    def turning(self, bodies: Any) -> np.ndarray:
        """Compute the geometric stiffness of the present forces, (n, 2·n_dof, 2·n_dof); rows as in `blocks`."""

    def bounded(self, bodies: Any = None) -> tuple[Springs, np.ndarray]:
        """Springs for limit analysis where the blocks are now, with the least and largest force of each [N], (n, 2);
        None: where they were drawn."""

    def preload(self) -> np.ndarray:
        """Force of each of the springs of `bounded` before any load, tension positive [N], (n,)."""

    def yields(self) -> bool:
        """Test whether any link has a force limit at which it stretches or slides for good."""

    def softest(self) -> float:
        """Compute the least stiffness of any element [N/m]."""

    def energy(self) -> float:
        """Compute the elastic energy of all elements [J]."""

    def follow(self, motion: np.ndarray, bodies: Any) -> None:
        """Update elongations and forces after small displacements of all blocks, (n_blocks, n_dof), which grow
        evenly.
        """

    def length(self, number: int) -> float:
        """Return the length of one link as it was drawn [m]."""

    def reading(self, number: int, quantity: str, at: float) -> LinkReading:
        """Return what a monitor of one link reads, in its rows of `state`; at: how far along it [m]."""

    def answer(self, number: int) -> dict[str, Any]:
        """Summarise the state of one link for summary.json."""

    def outline(self) -> Outline:
        """Return all links as lines through points of their blocks, with the forces of this instant."""

    def words(self, number: int, ids: Sequence[str]) -> str:
        """Describe one link in a line of text; ids: of the blocks, that of a fixed point last."""


class Link(NamedTuple):
    """Kind of link as it is registered: its table, arrays and compiled forces."""

    key: str  # [[key]] in the case file
    word: str  # what one is called, also without an id: word-1, word-2 ...
    parameters: type[Parameters]  # that table
    made: Callable[[Sequence[Any], Sequence[Any], np.ndarray], Any]  # (tables, as drawn, centroids) -> LinkArrays
    forces: dict[bool, Callable]  # where geometry is that of the start, and where it moves


def all_forces(kinds: Sequence[Callable]) -> Callable:
    """Combine the force functions of several kinds of link into one function; () for none."""
    if not kinds:
        return no_forces
    first, others = kinds[0], all_forces(kinds[1:])
    more = len(kinds) > 1

    @inline
    def link_forces(links, bodies, like, like_rotation):
        """Add the forces of all links on their blocks to `forces`; returns the work lost [J]."""
        lost = first(links[0], bodies, like, like_rotation)
        if more:
            lost += others(links[1:], bodies, like, like_rotation)
        return lost

    return named(link_forces, *kinds)


@always_inline
def no_forces(links, bodies, like, like_rotation):
    """Return no work lost: the force function of a model without links."""
    return 0.0
