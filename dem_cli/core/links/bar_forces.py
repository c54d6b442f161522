"""Forces of bars in the stepping loop: each chain is brought to equilibrium with the blocks as they lie now.

Nodes have no mass. Their slips s make Σ of the springs' energies least, springs that have reached their limit at that
force: Newton's method on a tridiagonal matrix, with a line search on the slope along the step, which ends in any case,
as the sum is convex. Blocks get the forces of the elements that cross joints, all that leaves a block.
"""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.core.kernels.contact_point import push_apart
from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.kernels.joint_plane import moment, sweep
from dem_cli.core.kernels.vec import axpy, dot, load, norm, scale, store
from dem_cli.core.links.link import FORCE, PLASTIC, STRETCH
from dem_cli.core.links.material_points import turned_arm

ITERATIONS = 40  # of Newton's method; one or two do, and what is left goes on in the next step
HALVINGS = 12  # of a step that goes too far
EXACT = 1e-10  # unbalanced force of a node over the largest force in its bar
SOFTENED = 1e-6  # tangent of a spring at its limit over its stiffness, so that a bar that slides as a whole has one
TURNS = 4  # of the direction across a joint towards that with nodes that have given way
TOO_FAR = 0.1  # slope behind a step over that before it, from which on the step was too long


@inline
def spring(stiffness, limit, plastic, stretch):
    """Compute the force of an elastic – perfectly plastic spring, and whether it is at its limit."""
    force = stiffness * (stretch - plastic)
    if force > limit:
        return limit, True
    if force < -limit:
        return -limit, True
    return force, False


@inline
def gradient(bars, bar, slips, out):
    """Compute unbalanced forces of the nodes of one bar into `out`; returns the largest force of a spring in it.

    Stretches of all springs go into their rows of `stretch`, and their tangents into those of `tangent`.
    """
    begin, end, n = bars.first[bar], bars.first[bar + 1], bars.slips.shape[0]
    largest = 0.0
    for i in range(begin, end):
        force, limited = spring(bars.stiffness[i], bars.limits[i], bars.state[i, PLASTIC], slips[i])
        bars.stretch[i] = slips[i]
        bars.tangent[i] = SOFTENED * bars.stiffness[i] if limited else bars.stiffness[i]
        out[i] = force
        largest = max(largest, abs(force))
    for i in range(begin, end + 1):  # the element before node i, behind the last one that at the end
        e = i + bar
        row = n + e
        if bars.stiffness[row] > 0.0:
            stretch = bars.drive[e]
            if i > begin:
                stretch -= bars.cosines[e, 0] * slips[i - 1]
            if i < end:
                stretch += bars.cosines[e, 1] * slips[i]
            force, limited = spring(bars.stiffness[row], bars.limits[row], bars.state[row, PLASTIC], stretch)
            bars.stretch[row] = stretch
            bars.tangent[row] = SOFTENED * bars.stiffness[row] if limited else bars.stiffness[row]
            if i > begin:
                out[i - 1] -= bars.cosines[e, 0] * force
            if i < end:
                out[i] += bars.cosines[e, 1] * force
            largest = max(largest, abs(force))
        else:
            bars.tangent[row] = 0.0
    return largest


@inline
def newton_step(bars, bar):
    """Solve for the Newton step from the present tangents and unbalanced forces, into `step`; returns the slope along
    it.
    """
    begin, end, n = bars.first[bar], bars.first[bar + 1], bars.slips.shape[0]
    diagonal, step = bars.diagonal, bars.step
    for i in range(begin, end):
        e = i + bar
        own = bars.tangent[i] + bars.cosines[e, 1] ** 2 * bars.tangent[n + e]
        own += bars.cosines[e + 1, 0] ** 2 * bars.tangent[n + e + 1]
        step[i] = -bars.unbalanced[i]
        if i > begin:
            beside = -bars.cosines[e, 0] * bars.cosines[e, 1] * bars.tangent[n + e]
            share = beside * diagonal[i - 1]
            own -= share * beside
            step[i] -= share * step[i - 1]
        diagonal[i] = 1.0 / own
    for i in range(end - 1, begin - 1, -1):
        if i < end - 1:
            e = i + 1 + bar
            step[i] += bars.cosines[e, 0] * bars.cosines[e, 1] * bars.tangent[n + e] * step[i + 1]
        step[i] *= diagonal[i]
    slope = 0.0
    for i in range(begin, end):
        slope += bars.unbalanced[i] * step[i]
    return slope


@inline
def balance(bars, bar):
    """Find the slips of one bar that leave its nodes in equilibrium, into `slips`."""
    begin, end = bars.first[bar], bars.first[bar + 1]
    slips, step, unbalanced = bars.slips, bars.step, bars.unbalanced
    largest = gradient(bars, bar, slips, unbalanced)
    for _ in range(ITERATIONS):
        worst = 0.0
        for i in range(begin, end):
            worst = max(worst, abs(unbalanced[i]))
        if worst <= EXACT * largest:
            break
        before = newton_step(bars, bar)
        share, done = 1.0, 0.0
        for _ in range(HALVINGS):
            for i in range(begin, end):
                slips[i] += (share - done) * step[i]
            done = share
            largest = gradient(bars, bar, slips, unbalanced)
            slope = 0.0
            for i in range(begin, end):
                slope += unbalanced[i] * step[i]
            if slope <= -TOO_FAR * before:
                break
            share *= max(0.1, before / (before - slope))


@inline
def settle(bars, bar):
    """Update plastic deformations and forces of one bar in its rows of `state`; returns the work lost [J]."""
    begin, end, n = bars.first[bar], bars.first[bar + 1], bars.slips.shape[0]
    state, lost = bars.state, 0.0
    for part in range(2):
        rows = range(begin, end) if part == 0 else range(n + begin + bar, n + end + bar + 1)
        for row in rows:
            stiffness, limit = bars.stiffness[row], bars.limits[row]
            if stiffness == 0.0:
                continue
            force, limited = spring(stiffness, limit, state[row, PLASTIC], bars.stretch[row])
            if limited:
                plastic = bars.stretch[row] - force / stiffness
                lost += 0.5 * (state[row, FORCE] + force) * (plastic - state[row, PLASTIC])
                state[row, PLASTIC] = plastic
            state[row, STRETCH], state[row, FORCE] = bars.stretch[row], force
    return lost


@inline
def drives_that_stay(bars, bodies, like, like_rotation):
    """Compute the elongation of each element that crosses a joint in fixed geometry, without slips."""
    d, positions, orientations = len(like), bodies.positions, bodies.orientations
    for e in range(bars.crossing.shape[0]):
        c = bars.crossing[e]
        if c >= 0:
            a, b = bars.blocks[c, 0], bars.blocks[c, 1]
            axis, arm_a, arm_b = (
                load(bars.axes, c, 0, like),
                load(bars.arms, c, 0, like),
                load(bars.arms, c, d, like),
            )
            moved_a = axpy(-1.0, load(bars.starts, c, 0, like), load(positions, a, 0, like))
            moved_a = axpy(1.0, sweep(load(orientations, a, 0, like_rotation), arm_a), moved_a)
            moved_b = axpy(-1.0, load(bars.starts, c, d, like), load(positions, b, 0, like))
            moved_b = axpy(1.0, sweep(load(orientations, b, 0, like_rotation), arm_b), moved_b)
            bars.drive[e] = dot(axis, axpy(-1.0, moved_a, moved_b))
            store(bars.directions, c, 0, axis)
            store(bars.levers, c, 0, arm_a)
            store(bars.levers, c, d, arm_b)


@inline
def drives_that_move(bars, bodies, like, like_rotation):
    """Compute the elongation of each element that crosses a joint in moving geometry. It is linear in the slips about
    those of the last step; nodes give way across the bar.
    """
    d = len(like)
    dowels = bars.stiffness.shape[0] - 2 * bars.blocks.shape[0]
    for bar in range(bars.first.shape[0] - 1):
        begin = bars.first[bar]
        for i in range(begin + 1, bars.first[bar + 1]):
            e = i + bar
            c = bars.crossing[e]
            if c < 0:
                continue
            a, b = bars.blocks[c, 0], bars.blocks[c, 1]
            along_a = turned_arm(bodies.turns, a, load(bars.along, c, 0, like))
            along_b = turned_arm(bodies.turns, b, load(bars.along, c, d, like))
            arm_a = axpy(bars.slips[i - 1], along_a, turned_arm(bodies.turns, a, load(bars.arms, c, 0, like)))
            arm_b = axpy(bars.slips[i], along_b, turned_arm(bodies.turns, b, load(bars.arms, c, d, like)))
            centres = axpy(-1.0, load(bodies.positions, a, 0, like), load(bodies.positions, b, 0, like))
            between = axpy(1.0, centres, axpy(-1.0, arm_a, arm_b))
            # Nodes go by N sin/(kd l) across the bar, towards the line between them, of which that turns the direction.
            row = dowels + 2 * c
            give_a, give_b = bars.state[row, STRETCH], bars.state[row + 1, STRETCH]  # N/(kd l) [m]
            axis = scale(1.0 / norm(between), between)
            for _ in range(TURNS):
                along = axpy(give_b * dot(axis, along_b), along_b, between)
                along = axpy(give_a * dot(axis, along_a), along_a, along)
                whole = norm(along)
                axis = scale(1.0 / whole, along)
            length = whole - give_a - give_b
            arm_a = axpy(give_a, axpy(-dot(axis, along_a), along_a, axis), arm_a)
            arm_b = axpy(-give_b, axpy(-dot(axis, along_b), along_b, axis), arm_b)
            cos_a, cos_b = dot(axis, along_a), dot(axis, along_b)
            bars.cosines[e, 0], bars.cosines[e, 1] = cos_a, cos_b
            bars.drive[e] = length - bars.lengths[c] + cos_a * bars.slips[i - 1] - cos_b * bars.slips[i]
            store(bars.directions, c, 0, axis)
            store(bars.levers, c, 0, arm_a)
            store(bars.levers, c, d, arm_b)


@inline
def give_way(bars, e, c, force):
    """Compute the lateral displacement of the nodes beside a joint, towards the force there, without overshoot.

    With the angle between the bar and the element that crosses, each carries N sin of it.
    """
    n = bars.slips.shape[0]
    row = bars.stiffness.shape[0] - 2 * bars.blocks.shape[0] + 2 * c
    pull = max(force, 0.0)
    soft = 1.0 / bars.stiffness[row] + 1.0 / bars.stiffness[row + 1]
    for side in range(2):
        square = max(0.0, 1.0 - bars.cosines[e, side] ** 2)
        stiffness = bars.stiffness[row + side]
        change = pull / stiffness - bars.state[row + side, STRETCH]
        bars.state[row + side, STRETCH] += change / (1.0 + bars.stiffness[n + e] * square * soft)
        bars.state[row + side, FORCE] = pull * square**0.5


def make_bar_forces(moves: bool) -> Callable:
    """Make the loop over bars; moves: along the lines between their nodes now, else along those of the start."""
    drive = drives_that_move if moves else drives_that_stay

    @inline
    def bar_forces(bars, bodies, like, like_rotation):
        """Add the forces of all bars on their blocks to `forces`; returns the work lost by yielding and slip [J]."""
        d, n, forces, lost = len(like), bars.slips.shape[0], bodies.forces, 0.0
        for i in range(n):
            bars.slips[i] = bars.state[i, STRETCH]
        drive(bars, bodies, like, like_rotation)
        for bar in range(bars.first.shape[0] - 1):
            balance(bars, bar)
            lost += settle(bars, bar)
        for e in range(bars.crossing.shape[0]):
            c = bars.crossing[e]
            if c >= 0:
                force = bars.state[n + e, FORCE]
                if moves:
                    give_way(bars, e, c, force)
                pull = scale(-force, load(bars.directions, c, 0, like))  # on the second block
                arm_a, arm_b = load(bars.levers, c, 0, like), load(bars.levers, c, d, like)
                push_apart(forces, bars.blocks[c, 0], bars.blocks[c, 1], pull, moment(arm_a, pull), moment(arm_b, pull))
        return lost

    return named(bar_forces, "moving" if moves else "still")
