"""Reinforcing bars in blocks ([bars.NAME], [[reinforcement]]): stitches and grouted anchors, held by bond.

A bar is a chain of nodes that carry axial forces from one to the next, EA/l, elastic – perfectly plastic. Each node is
tied to a material point of the block in which it lies: along the bar by the bond, a spring kb l with a slider sb l;
across it by a spring that gives way where a joint that has opened or slid bends the bar. Nodes lie on both sides of
each joint, so that one element crosses it. A bar has no mass and does not resist bending: nodes are in equilibrium at
every instant (links/bar_forces.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.small_matrices import root
from dem_cli.core.links.bar_forces import make_bar_forces
from dem_cli.core.links.chain import Chain
from dem_cli.core.links.drawn_bar import DrawnBar, Reinforcement, elements_of, nodes_of
from dem_cli.core.links.kinks import Kinks, kinks_of
from dem_cli.core.links.link import FORCE, N_STATE, PLASTIC, STRETCH, Link, LinkEnds, LinkReading, Outline, Springs
from dem_cli.core.links.spans import Spans, spans

KINKED = 0.1  # stiffness across a joint over that along the bar, for masses: the element there turns when blocks slide
SLIPPED = 1e-9  # of the elastic slip at the strength of the bond: less is round-off


class Bars(NamedTuple):
    """All bars of a scene, as the stepping loop sees them: n nodes, n + n_bars elements, two dowels for each joint.

    Springs, one behind another: bonds of the nodes; elements, bar by bar, one before each node and one at the end, of
    stiffness 0 where that is free; dowels before and behind each joint.
    """

    blocks: np.ndarray  # either side of the joints that bars cross, (n_joints, 2) int64
    arms: np.ndarray  # of the ends of kinks beside these (links/kinks.py) from the centroids, undeformed [m],
    # (n_joints, 2·d)
    axes: np.ndarray  # unit, from end to end, at the start, (n_joints, d)
    starts: np.ndarray  # centroids of both blocks at the start [m], (n_joints, 2·d)
    lengths: np.ndarray  # from end to end at the start [m], (n_joints,)
    along: np.ndarray  # unit, directions of the bar at both nodes, undeformed, (n_joints, 2·d)
    first: np.ndarray  # first node of each bar, and how many there are, (n_bars + 1,) int64
    crossing: np.ndarray  # joint that an element crosses, −1: none, (n_elements,) int64
    stiffness: np.ndarray  # of the springs [N/m], (m,)
    limits: np.ndarray  # their largest force [N], (m,)
    state: np.ndarray  # plastic elongation, elongation [m] (of dowels N over theirs), force [N], (m, 3)
    node_blocks: np.ndarray  # block in which each node lies, (n,) int64
    node_arms: np.ndarray  # nodes from its centroid [m], (n, d)
    tips: np.ndarray  # both ends of each bar from the centroids of their blocks [m], (n_bars, 2, d)
    node_places: np.ndarray  # nodes along their bar from its start [m], (n,)
    reach: np.ndarray  # length of bar that each node holds [m], (n,)
    # what the loop works with
    slips: np.ndarray  # of the nodes [m], (n,)
    step: np.ndarray  # (n,)
    unbalanced: np.ndarray  # (n,)
    diagonal: np.ndarray  # inverse, (n,)
    drive: np.ndarray  # elongations of elements without slips [m], (n_elements,)
    cosines: np.ndarray  # between an element and the bar at either end, (n_elements, 2)
    stretch: np.ndarray  # (m,)
    tangent: np.ndarray  # (m,)
    directions: np.ndarray  # of the elements across joints, (n_joints, d)
    levers: np.ndarray  # of their ends about the blocks, (n_joints, 2·d)

    @property
    def kind(self) -> str:
        """Name of this kind of link in the registry."""
        return BAR.key

    @property
    def n_drawn(self) -> int:
        """Number of bars as they were drawn."""
        return len(self.first) - 1

    @property
    def joints(self) -> np.ndarray:
        """Elements of bars that cross joints, one for each crossing, (n_joints,)."""
        return np.flatnonzero(self.crossing >= 0)

    @property
    def spans(self) -> Spans:
        """Spans of bars across the joints, from end to end of the kinks, as far as the nodes there have slipped."""
        n_joints, d = self.axes.shape
        right = self.joints - np.searchsorted(self.first[1:] + np.arange(1, self.n_drawn + 1), self.joints, "right")
        slips = self.state[np.column_stack([right - 1, right]), STRETCH]
        arms = self.arms + (slips[:, :, None] * self.along.reshape(n_joints, 2, d)).reshape(n_joints, 2 * d)
        return Spans(self.blocks, arms, self.axes, self.starts, self.lengths)

    def started(self, origin: np.ndarray) -> Bars:
        """Copy the bars for a simulation that counts places from `origin`."""
        alone = self._replace(**{name: getattr(self, name).copy() for name in _WORK}, state=np.zeros_like(self.state))
        return alone._replace(starts=self.starts - np.tile(origin, 2))

    def chain(self, number: int) -> Chain:
        """Return one bar as an elastic chain."""
        begin, end, n = self.rows(number)
        elements = slice(begin + number, end + number + 1)
        stiffness = self.stiffness[n:][elements]
        return Chain(self.stiffness[begin:end], stiffness, np.flatnonzero(self.crossing[elements] >= 0))

    def joints_of(self, number: int) -> slice:
        """Return the joints that one bar crosses."""
        begin, end, _ = self.rows(number)
        found = np.searchsorted(self.joints, [begin + number, end + number + 1])
        return slice(int(found[0]), int(found[1]))

    def rows(self, number: int) -> tuple[int, int, int]:
        """Return the first node of a bar, that of the next one, and the number of all nodes: where elements begin."""
        return int(self.first[number]), int(self.first[number + 1]), len(self.slips)

    def axial(self, bodies: Any = None) -> Springs:
        """Elastic springs between the blocks of each bar, as many as joints: a factor of the condensed stiffness."""
        axes, _, arms = self.spans.lines(bodies)
        rows = self.spans.motion(axes, arms)
        widest, n_dof = max((len(self._factor(b)) for b in range(self.n_drawn)), default=0) + 1, rows.shape[2]
        blocks = np.zeros((len(rows), widest), np.int64)
        motion, stiffness = np.zeros((len(rows), widest, n_dof)), np.zeros(len(rows))
        for bar in range(self.n_drawn):
            here, factor = self.joints_of(bar), self._factor(bar)
            k, own = len(factor), rows[here]
            stiffness[here] = np.diag(factor) ** 2
            shares = (factor / np.diag(factor)).T
            blocks[here, :k], blocks[here, 1 : k + 1] = self.blocks[here, 0], self.blocks[here, 1]
            motion[here, :k] += shares[:, :, None] * own[:, 0]
            motion[here, 1 : k + 1] += shares[:, :, None] * own[:, 1]
        return Springs(blocks, motion, stiffness)

    def _factor(self, number: int) -> np.ndarray:
        """Compute the Cholesky factor L of the condensed stiffness K = L Lᵀ of a bar, lower triangular."""
        found: np.ndarray = root(self.chain(number).condensed())
        return found

    def acting(self) -> np.ndarray:
        """Return True for all axial springs: bars take tension and compression."""
        return np.ones(len(self.blocks), bool)

    def across(self, bodies: Any = None) -> Springs:
        """Return springs across the elements at joints: geometric stiffness N/L, and a share of the axial one when
        blocks slide.
        """
        held = self.spans
        _, lengths, _ = held.lines(bodies)
        stiffness = np.maximum(self.forces, 0.0) / lengths
        if bodies is not None:
            stiffness = stiffness + KINKED * self._own_stiffness()
        sides = held.sideways(bodies)
        return Springs(np.concatenate([self.blocks] * len(sides)), np.concatenate(list(sides)),
                       np.concatenate([stiffness] * len(sides)))  # fmt: skip

    @property
    def forces(self) -> np.ndarray:
        """Axial force at each joint that a bar crosses [N], (n_joints,)."""
        return self.state[len(self.slips) + self.joints, FORCE]

    def _own_stiffness(self) -> np.ndarray:
        """Compute the stiffness of each joint crossing when the others do not open [N/m], (n_joints,)."""
        return np.concatenate([np.zeros(0), *(np.diag(self.chain(b).condensed()) for b in range(self.n_drawn))])

    def turning(self, bodies: Any) -> np.ndarray:
        """Compute the geometric stiffness of the present bar forces (`Spans.turning`)."""
        return self.spans.turning(self.forces, bodies)

    def bounded(self, bodies: Any = None) -> tuple[Springs, np.ndarray]:
        """Return bars for limit analysis: a force at each joint, at most what yields, or what bond and anchors on
        either side hold; bodies None: as drawn, else kinked as the last step left them.

        That bond in a block between two joints also bounds how much these forces differ is left out.
        """
        held, d = self.spans, self.axes.shape[1]
        axes, _, arms = held.lines(None)
        along = np.concatenate([np.zeros(0), *(self._anchorage(bar) for bar in range(self.n_drawn))])
        if bodies is not None:  # of an element that leans towards the bar, bond holds the part along that
            axes, arms = self.directions, self.levers.reshape(-1, 2, d)
            along = along / np.abs(self.cosines[self.joints]).min(axis=1, initial=1.0)
        most = np.minimum(along, self.limits[len(self.slips) + self.joints])
        springs = Springs(self.blocks, held.motion(axes, arms), self._own_stiffness())
        return springs, np.column_stack([-most, most])

    def preload(self) -> np.ndarray:
        """Return the force of bars before any load at the joints that they cross: none [N], (n_joints,)."""
        return np.zeros(len(self.blocks))

    def _anchorage(self, number: int) -> np.ndarray:
        """Compute the largest force of one bar at its joints, by yield, bond and anchors [N], (n_joints of it,)."""
        begin, end, n = self.rows(number)
        at = self.joints[self.joints_of(number)]
        elements = n + begin + number
        anchors = np.where(self.stiffness[[elements, n + end + number]] > 0.0, np.inf, 0.0)
        upto = np.concatenate([[0.0], np.cumsum(self.limits[begin:end])])
        before = upto[at - begin - number]
        behind = np.cumsum(self.limits[begin:end][::-1])[::-1][at - begin - number]
        return np.minimum(np.minimum(before + anchors[0], behind + anchors[1]), self.limits[n + at])

    def yields(self) -> bool:
        """Test whether any bar yields, or slides in its bond."""
        return bool(np.isfinite(self.limits).any())

    def softest(self) -> float:
        """Compute the least stiffness of a joint that opens, by its bar alone [N/m]."""
        return float(self._own_stiffness().min(initial=np.inf))

    def energy(self) -> float:
        """Compute the elastic energy in all springs of bars [J]."""
        return 0.5 * float((self.state[:, FORCE] ** 2 / np.where(self.stiffness > 0.0, self.stiffness, 1.0)).sum())

    def follow(self, motion: np.ndarray, bodies: Any) -> None:
        """Update slips and forces of bars after small displacements of all blocks, (n_blocks, n_dof); elastic, up to
        the limits.
        """
        axes, _, arms = self.spans.lines(bodies)
        opened = (self.spans.motion(axes, arms) * motion[self.blocks]).sum(axis=(1, 2))
        n = len(self.slips)
        for bar in range(self.n_drawn):
            begin, end, _ = self.rows(bar)
            chain, here = self.chain(bar), opened[self.joints_of(bar)]
            slips = chain.slips(here)
            self.state[begin:end, STRETCH] += slips
            self.state[n + begin + bar : n + end + bar + 1, STRETCH] += chain.stretches(here, slips)
        springs = slice(n + len(self.crossing))
        forces = self.stiffness[springs] * (self.state[springs, STRETCH] - self.state[springs, PLASTIC])
        self.state[springs, FORCE] = np.clip(forces, -self.limits[springs], self.limits[springs])
        beyond = forces - self.state[springs, FORCE]
        held = self.stiffness[springs] > 0.0
        self.state[springs, PLASTIC] += np.divide(
            beyond, self.stiffness[springs], out=np.zeros(len(beyond)), where=held
        )

    # -- what people read --------------------------------------------------------------------------

    def length(self, number: int) -> float:
        """Return the length of one bar [m]."""
        last = self.first[number + 1] - 1
        return float(self.node_places[last] + 0.5 * self.reach[last])

    def reading(self, number: int, quantity: str, at: float) -> LinkReading:
        """Return monitor weights: slip, linear between the nodes of a block, or force, linear between middles of
        elements.
        """
        begin, end, n = self.rows(number)
        places, reach = self.node_places[begin:end], self.reach[begin:end]
        if quantity == "slip":
            # Slip jumps at joints: of the nodes of the block there only.
            bounds = [0.0, *(places[:-1] + 0.5 * reach[:-1]), self.length(number)]
            node = int(np.clip(np.searchsorted(bounds, at, "right") - 1, 0, end - begin - 1))
            cuts = self.crossing[begin + number : end + number + 1] >= 0
            low = max((i for i in range(node + 1) if i == 0 or cuts[i]), default=0)
            high = min(i for i in range(node, end - begin) if i + 1 == end - begin or cuts[i + 1])
            rows, points = np.arange(low, high + 1) + begin, places[low : high + 1]
        else:
            points = np.concatenate([[0.0], places[:-1] + 0.5 * reach[:-1], [self.length(number)]])
            rows = n + begin + number + np.arange(end - begin + 1)
        right = int(np.clip(np.searchsorted(points, at), 1, max(len(points) - 1, 1)))
        if len(points) == 1:
            return LinkReading((int(rows[0]),), STRETCH, (1.0,))
        share = float(np.clip((at - points[right - 1]) / (points[right] - points[right - 1]), 0.0, 1.0))
        column = STRETCH if quantity == "slip" else FORCE
        return LinkReading((int(rows[right - 1]), int(rows[right])), column, (1.0 - share, share))

    def answer(self, number: int) -> dict[str, Any]:
        """Summarise one bar: largest force and slip with their places along it, and whether it yielded or slid
        somewhere.
        """
        begin, end, n = self.rows(number)
        slips, forces = self.state[begin:end], self.state[n + begin + number : n + end + number + 1]
        middles = np.concatenate([[0.0], self.node_places[begin:end] + 0.5 * self.reach[begin:end]])
        most, slid = int(np.abs(forces[:, FORCE]).argmax()), int(np.abs(slips[:, STRETCH]).argmax())
        elastic = self.limits[begin:end] / self.stiffness[begin:end]
        own = np.where(np.isfinite(elastic), elastic, 0.0)
        return {
            "force": float(forces[most, FORCE]),
            "at": float(middles[most]),
            "slip": float(slips[slid, STRETCH]),
            "slip_at": float(self.node_places[begin + slid]),
            "yielded": bool((forces[:, PLASTIC] != 0.0).any()),
            "slid": bool((np.abs(slips[:, PLASTIC]) > SLIPPED * own).any()),
        }

    def outline(self) -> Outline:
        """Return bars as lines through their nodes and on either side of joints; at a node the mean force beside it."""
        blocks, arms, forces, counts, n, d = [], [], [], [], len(self.slips), self.axes.shape[1]
        for bar in range(self.n_drawn):
            begin, end, _ = self.rows(bar)
            elements = self.state[n + begin + bar : n + end + bar + 1, FORCE]
            here = self.joints_of(bar)
            right = np.repeat(self.joints[here] - bar, 2) + np.tile([-1, 0], here.stop - here.start)  # nodes
            along = self.along[here].reshape(-1, d)
            half = np.tile([0.5, -0.5], here.stop - here.start)[:, None] * self.reach[right, None]
            at = np.repeat(self.joints[here] - bar - begin, 2)
            held, nodes = self.node_blocks[begin:end], self.node_arms[begin:end]
            means = 0.5 * (elements[:-1] + elements[1:])
            blocks += [held[:1], np.insert(held, at, self.node_blocks[right]), held[-1:]]
            arms += [
                self.tips[bar, :1],
                np.insert(nodes, at, self.node_arms[right] + half * along, 0),
                self.tips[bar, 1:],
            ]
            forces += [elements[:1], np.insert(means, at, elements[at]), elements[-1:]]
            counts.append(end - begin + 2 + len(at))
        return Outline(np.array(counts), np.concatenate(blocks), np.concatenate(arms), np.concatenate(forces))

    def words(self, number: int, ids: Sequence[str]) -> str:
        """Describe one bar in a line of text; ids: of the blocks."""
        begin, end, _ = self.rows(number)
        here, of = self.joints_of(number), self.node_blocks[begin:end]
        most = self._anchorage(number)
        limit = f"up to {most.max():.4g} N at a joint" if np.isfinite(most).all() else "without limit"
        count = here.stop - here.start
        joints = f"{count} joint{'s' * (count != 1)}"
        held = f"'{ids[of[0]]}' to '{ids[of[-1]]}', {self.length(number):.4g} m across {joints}"
        return f"{held}, {end - begin} elements of {self.reach[begin:end].max():.3g} m, {limit}"


_WORK = (
    "slips", "step", "unbalanced", "diagonal", "drive", "cosines", "stretch", "tangent", "directions", "levers"
)  # fmt: skip


def bars(tables: Sequence[Reinforcement], drawn: Sequence[DrawnBar], centroids: np.ndarray) -> Bars:
    """Build the bars of a model whose blocks lie where they are; centroids: of the blocks [m], (n_blocks, d)."""
    d, cut = centroids.shape[1], [nodes_of(bar) for bar in drawn]
    first = np.concatenate([[0], np.cumsum([len(nodes.blocks) for nodes in cut])]).astype(np.int64)
    blocks, arms, along, reach, places = (
        np.concatenate([np.zeros((0, *shape), kind), *(getattr(nodes, name) for nodes in cut)])
        for name, shape, kind in (
            ("blocks", (), np.int64), ("arms", (d,), float), ("along", (d,), float), ("reach", (), float),
            ("places", (), float),
        )
    )  # fmt: skip
    elements = [elements_of(bar, nodes) for bar, nodes in zip(drawn, cut, strict=True)]
    right, crossing, axial, kinks, n_joints = [], [], [np.zeros(0)], [Kinks(np.zeros((0, 2, d)), np.zeros((0, 2)))], 0
    for bar, nodes, begin, (stiffness, crosses) in zip(drawn, cut, first.tolist(), elements):
        part = np.full(len(crosses), -1, np.int64)
        part[crosses] = n_joints + np.arange(crosses.sum())
        n_joints += int(crosses.sum())
        crossing.append(part)
        right.append(begin + np.flatnonzero(crosses))
        axial.append(stiffness)
        kinks.append(kinks_of(bar, nodes, np.flatnonzero(crosses)))
    behind = np.concatenate([np.zeros(0, np.int64), *right])
    pairs = np.column_stack([behind - 1, behind])
    kink_arms, dowels = (np.concatenate(parts) for parts in zip(*kinks))
    held = spans([LinkEnds((int(a), int(b)), ends) for (a, b), ends in zip(blocks[pairs], kink_arms)], centroids)
    profiles = [bar.profile for bar, nodes in zip(drawn, cut, strict=True) for _ in nodes.blocks]
    bond = np.array([p.bond_stiffness for p in profiles]) * reach
    strength = np.array([np.inf if p.bond_strength is None else p.bond_strength for p in profiles]) * reach
    yields = [np.full(len(part), bar.profile.largest) for bar, part in zip(drawn, crossing, strict=True)]
    stiffness = np.concatenate([bond, *axial, dowels.ravel()])
    limits = np.concatenate([strength, *yields, np.full(dowels.size, np.inf)])
    n, m, n_elements = len(blocks), len(stiffness), len(blocks) + len(drawn)
    numbers = np.concatenate([np.zeros(0, np.int64), *crossing])
    along_pairs = along[pairs].reshape(-1, 2, d)
    cosines = np.ones((n_elements, 2))
    cosines[numbers >= 0] = (along_pairs * held.axes[:, None, :]).sum(axis=2)
    return Bars(
        *held,
        along=along_pairs.reshape(-1, 2 * d),
        first=first,
        crossing=numbers,
        stiffness=stiffness,
        limits=limits,
        state=np.zeros((m, N_STATE)),
        node_blocks=blocks,
        node_arms=arms,
        tips=np.array([[bar.pieces[0].ends[0], bar.pieces[-1].ends[1]] for bar in drawn]),
        node_places=places,
        reach=reach,
        slips=np.zeros(n),
        step=np.zeros(n),
        unbalanced=np.zeros(n),
        diagonal=np.zeros(n),
        drive=np.zeros(n_elements),
        cosines=cosines,
        stretch=np.zeros(m),
        tangent=np.zeros(m),
        directions=np.zeros((n_joints, d)),
        levers=np.zeros((n_joints, 2 * d)),
    )


BAR = Link(
    key="reinforcement",
    word="bar",
    parameters=Reinforcement,
    made=bars,
    forces={moves: make_bar_forces(moves) for moves in (False, True)},
)
