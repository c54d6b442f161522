"""The thesis's own joint with microrotations (7.2.3): the yardstick of docs/chapter7.md, not the product.

Nothing of dem_cli is used. A joint has two nodes, the ends of the overlap, with springs as in eq. 7-5 and friction as
in 7-10. The resultant of their normal forces is at x from node 1; the polygon has a vertex at v, where its side ends.
Beyond it the thesis sets the spring of the node on that side to about 0 (7-7, 7-8) and puts the moment N e on both
blocks, so that the joint carries N at v while the block turns; at the angle φ of the polygon the spring and no moment
are back and all velocities are 0 (Figure 7-12). A node that opens carries nothing (7-9).

Chosen here:
- N at v is had by a return of the springs, each with an offset of its own, by a share of the excess in every step: 1
  is all of it, as the thesis has its moment; with less, joints creep, and loads end undecided.
- pivot "end" is the thesis's: the other node keeps its place and the loaded one sinks by φ times the length of the
  joint ("around the limiting points of the joint", 7.2.3). "vertex" differs in the offsets alone: the block turns
  about v, as on a polygon, and the other node rises.
- A joint that is partly turned and loaded at the other end turns back from there, to the angle of the side before.
- All joints turn at once, whether or not there is equilibrium. Damping is local. The friction does not soften.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

DAMPING = 0.7  # of the unbalanced force, against the velocity
SAFETY = 0.6  # masses over the sum of the stiffnesses, for a time step of 1


class Blocks(NamedTuple):
    """Rectangles; arrays that the kernel changes."""

    place: np.ndarray  # centroid [m] and rotation, (n, 3)
    axis: np.ndarray  # cosine and sine of the rotation, (n, 2)
    speed: np.ndarray  # per step, (n, 3)
    force: np.ndarray  # and moment, unbalanced, (n, 3)
    half: np.ndarray  # width and height over 2 [m], (n, 2)
    weight: np.ndarray  # (n,) [N]
    mass: np.ndarray  # fictitious, (n, 3); 0 where fixed


class Joints(NamedTuple):
    """Joints between the right or upper side of block `first` and the left or lower one of `second`; arrays."""

    first: np.ndarray  # (m,)
    second: np.ndarray
    head: np.ndarray  # upright
    length: np.ndarray  # of the overlap at the start [m]
    stiffness: np.ndarray  # of a node, normal and tangential [N/m]
    vertex: np.ndarray  # of the polygon from node 1, both ends of the joint among them, (m, sides + 1) [m]
    angle: np.ndarray  # at which each side carries, from the one at the start, (m, sides)
    last: np.ndarray  # number of the last side; 0: plane
    side: np.ndarray  # that carries
    turned: np.ndarray  # clockwise since the start, by flow
    offset: np.ndarray  # of the nodes, by flow, (m, 2) [m]
    normal: np.ndarray  # forces, (m, 2) [N]
    shear: np.ndarray


class Rule(NamedTuple):
    """How joints slide and turn."""

    friction: float
    at_end: bool  # the pivot: the other node, or the vertex
    share: float  # of the excess moment that a joint flows by in one step


@njit(cache=True)
def corner(blocks, i, head, side, end):
    """Corner of a block: side 1 is the right or upper one, -1 the other; end -1 is left or lower on it, 1 the other."""
    x = (side if head else end) * blocks.half[i, 0]
    y = (end if head else side) * blocks.half[i, 1]
    c, s = blocks.axis[i]
    return blocks.place[i, 0] + c * x - s * y, blocks.place[i, 1] + s * x + c * y


@njit(cache=True)
def node(blocks, a, b, head, end):
    """Place of a node, the normal there from a to b, and its gap: the corner of one block on the side of the other."""
    ax, ay = corner(blocks, a, head, 1, end)
    bx, by = corner(blocks, b, head, -1, end)
    c, s = blocks.axis[a]
    beyond = ((by - ay) * c - (bx - ax) * s if head else (bx - ax) * c + (by - ay) * s) * end
    x, y = bx, by
    if beyond > 0.0:
        x, y = ax, ay
        c, s = blocks.axis[b]
    nx, ny = (c, s) if head else (-s, c)
    return x, y, nx, ny, (bx - ax) * nx + (by - ay) * ny


@njit(cache=True)
def flow(joints, j, f1, f2, rule):
    """Turn joint j by its excess moment: 0 where the resultant is on its side, 1 on the way, 2 where it is complete."""
    length, side = joints.length[j], joints.side[j]
    x = f2 / (f1 + f2) * length
    if side < joints.last[j] and x > joints.vertex[j, side + 1]:
        to, v, far = 1, joints.vertex[j, side + 1], 0.0
    elif side > 0 and x < joints.vertex[j, side]:
        to, v, far = -1, joints.vertex[j, side], length
    else:
        return 0
    pivot = far if rule.at_end else v
    excess = f2 * (length - v) - f1 * v
    turn = rule.share * excess / (joints.stiffness[j] * ((length - pivot) * (length - v) + pivot * v))
    rest = joints.angle[j, side + to] - joints.turned[j]
    complete = to * turn >= to * rest
    if complete:
        turn = rest
        joints.side[j] += to
    joints.turned[j] += turn
    joints.offset[j, 0] -= turn * pivot
    joints.offset[j, 1] += turn * (length - pivot)
    return 2 if complete else 1


@njit(cache=True)
def press(blocks, joints, j, rule, flows):
    """Forces of joint j on its blocks; what `flow` says."""
    a, b, head, k = joints.first[j], joints.second[j], joints.head[j], joints.stiffness[j]
    nodes = (node(blocks, a, b, head, -1), node(blocks, a, b, head, 1))
    f1 = k * max(-nodes[0][4] - joints.offset[j, 0], 0.0)
    f2 = k * max(-nodes[1][4] - joints.offset[j, 1], 0.0)
    state = flow(joints, j, f1, f2, rule) if flows and f1 + f2 > 0.0 else 0
    for i in range(2):
        x, y, nx, ny, gap = nodes[i]
        normal = k * max(-gap - joints.offset[j, i], 0.0)
        ax, ay, bx, by = x - blocks.place[a, 0], y - blocks.place[a, 1], x - blocks.place[b, 0], y - blocks.place[b, 1]
        va, vb = blocks.speed[a], blocks.speed[b]
        slip = (vb[0] - vb[2] * by - va[0] + va[2] * ay) * ny - (vb[1] + vb[2] * bx - va[1] - va[2] * ax) * nx
        limit = rule.friction * normal
        shear = min(max(joints.shear[j, i] - k * slip, -limit), limit)
        joints.normal[j, i], joints.shear[j, i] = normal, shear
        fx, fy = normal * nx + shear * ny, normal * ny - shear * nx
        for block, sign, rx, ry in ((a, -1.0, ax, ay), (b, 1.0, bx, by)):
            blocks.force[block, 0] += sign * fx
            blocks.force[block, 1] += sign * fy
            blocks.force[block, 2] += sign * (rx * fy - ry * fx)
    return state


@njit(cache=True)
def move(blocks, halt):
    """One step of motion, without velocity where `halt`; largest unbalanced force over the weight of its block."""
    unbalanced = 0.0
    for i in range(len(blocks.weight)):
        if blocks.mass[i, 0] == 0.0:
            continue
        for c in range(3):
            force = blocks.force[i, c]
            unbalanced = max(unbalanced, abs(force) / (blocks.weight[i] * (1.0 if c < 2 else 2.0 * blocks.half[i, 1])))
            damped = force - DAMPING * abs(force) * np.sign(blocks.speed[i, c])
            blocks.speed[i, c] = 0.0 if halt else blocks.speed[i, c] + damped / blocks.mass[i, c]
            blocks.place[i, c] += blocks.speed[i, c]
        blocks.axis[i, 0], blocks.axis[i, 1] = np.cos(blocks.place[i, 2]), np.sin(blocks.place[i, 2])
    return unbalanced


@njit(cache=True)
def advance(blocks, joints, rule, loads, steps, flows):
    """Steps under loads[0] to loads[1] times the weight, reached after loads[2] steps.

    Returns the unbalanced force of the last step, the joints that flow in it, and the turns completed in all.
    """
    unbalanced, flowing, completed = 0.0, 0, 0
    for step in range(steps):
        load = loads[1] if step >= loads[2] else loads[0] + (loads[1] - loads[0]) * (step + 1) / loads[2]
        blocks.force[:, 0] = load * blocks.weight
        blocks.force[:, 1] = -blocks.weight
        blocks.force[:, 2] = 0.0
        flowing, before = 0, completed
        for j in range(len(joints.first)):
            state = press(blocks, joints, j, rule, flows)
            flowing += state > 0
            completed += state == 2
        unbalanced = move(blocks, completed > before)
    return unbalanced, flowing, completed
