"""Tuple algebra of a joint plane: rotations and moments in its frame, motion and moments of places in it; 2D and 3D.

A frame is the unit normal n and the tangents (in 3D t₂ = n × t₁); a place is what is counted along the tangents. With
r = x t₁ + y t₂ the velocity ω × r is ω₁ y − ω₂ x along the normal and (−ωₙ y, ωₙ x) along the tangents. Each function
is plain Python too, as in vec.py.
"""

from __future__ import annotations

from dem_cli.core.kernels.jit import overload
from dem_cli.core.kernels.vec import add_torques, axpy, components, compose, dot, load_levers, scale, turn

LEAST_PUSH = 1e-250  # one over less than that may be infinite


def sweep(spin, arm):
    """Compute the velocity of the tip of an arm that turns: ω × arm."""
    if len(arm) == 2:
        return -spin[0] * arm[1], spin[0] * arm[0]
    return (
        spin[1] * arm[2] - spin[2] * arm[1],
        spin[2] * arm[0] - spin[0] * arm[2],
        spin[0] * arm[1] - spin[1] * arm[0],
    )


@overload(sweep)
def _sweep(spin, arm):
    if len(arm) == 2:
        return lambda spin, arm: (-spin[0] * arm[1], spin[0] * arm[0])
    return lambda spin, arm: (
        spin[1] * arm[2] - spin[2] * arm[1],
        spin[2] * arm[0] - spin[0] * arm[2],
        spin[0] * arm[1] - spin[1] * arm[0],
    )


def moment(arm, force):
    """Compute the moment of a force about the origin of its arm: arm × force."""
    if len(arm) == 2:
        return (arm[0] * force[1] - arm[1] * force[0],)
    return sweep(arm, force)


@overload(moment)
def _moment(arm, force):
    if len(arm) == 2:
        return lambda arm, force: (arm[0] * force[1] - arm[1] * force[0],)
    return lambda arm, force: sweep(arm, force)


def seen_from(frame, rotation):
    """Resolve a rotation or moment along the normal and the tangents of a frame; in 2D it has but one component."""
    if len(frame) == 2:
        return rotation
    return tuple(dot(axis, rotation) for axis in frame)


@overload(seen_from)
def _seen_from(frame, rotation):
    if len(frame) == 2:
        return lambda frame, rotation: rotation
    return lambda frame, rotation: (dot(frame[0], rotation), dot(frame[1], rotation), dot(frame[2], rotation))


def seen_outside(frame, rotation):
    """Transform a rotation or moment from components along a frame to the world axes; in 2D it is unchanged."""
    if len(frame) == 2:
        return rotation
    return compose(frame, rotation[0], rotation[1:], (0.0, 0.0, 0.0))


@overload(seen_outside)
def _seen_outside(frame, rotation):
    if len(frame) == 2:
        return lambda frame, rotation: rotation
    return lambda frame, rotation: axpy(
        rotation[2], frame[2], axpy(rotation[1], frame[1], scale(rotation[0], frame[0]))
    )


def opening_at(spin, place):
    """Compute the normal motion of a place in the joint plane when the joint opens by a spin, both in its frame."""
    return -spin[0] * place[0] if len(place) == 1 else spin[1] * place[1] - spin[2] * place[0]


@overload(opening_at)
def _opening_at(spin, place):
    if len(place) == 1:
        return lambda spin, place: -spin[0] * place[0]
    return lambda spin, place: spin[1] * place[1] - spin[2] * place[0]


def sliding_at(slide, spin, place):
    """Compute the tangential motion of a place in the joint plane that slides and turns about its normal."""
    if len(place) == 1:
        return slide
    return slide[0] - spin[0] * place[1], slide[1] + spin[0] * place[0]


@overload(sliding_at)
def _sliding_at(slide, spin, place):
    if len(place) == 1:
        return lambda slide, spin, place: slide
    return lambda slide, spin, place: (slide[0] - spin[0] * place[1], slide[1] + spin[0] * place[0])


def add_moment_at(place, normal_part, tangent_parts, start):
    """Add to start the moment of a force at a place in the joint plane about the origin of places, in the joint's
    frame.
    """
    if len(place) == 1:
        return (start[0] - place[0] * normal_part,)
    return (
        start[0] + (place[0] * tangent_parts[1] - place[1] * tangent_parts[0]),
        start[1] + place[1] * normal_part,
        start[2] - place[0] * normal_part,
    )


@overload(add_moment_at)
def _add_moment_at(place, normal_part, tangent_parts, start):
    if len(place) == 1:
        return lambda place, normal_part, tangent_parts, start: (start[0] - place[0] * normal_part,)
    return lambda place, normal_part, tangent_parts, start: (
        start[0] + (place[0] * tangent_parts[1] - place[1] * tangent_parts[0]),
        start[1] + place[1] * normal_part,
        start[2] - place[0] * normal_part,
    )


def torsion_share(torsion, joint, like):
    """Return FixedJoints.torsion of a joint; an empty tuple in 2D."""
    return 1.0 if len(like) == 2 else torsion[joint]


@overload(torsion_share)
def _torsion_share(torsion, joint, like):
    if len(like) == 2:
        return lambda torsion, joint, like: 1.0
    return lambda torsion, joint, like: torsion[joint]


def centre_of(push, twist):
    """Compute the centre of pressure in the joint plane from normal force and moments about the tangents. Without a
    normal force it is the origin of places.
    """
    if len(twist) == 1:
        return (0.0,)
    part = 1.0 / push if push > LEAST_PUSH else 0.0
    return -part * twist[2], part * twist[1]


@overload(centre_of)
def _centre_of(push, twist):
    if len(twist) == 1:
        return lambda push, twist: (0.0,)

    def in_space(push, twist):
        part = 1.0 / push if push > LEAST_PUSH else 0.0
        return -part * twist[2], part * twist[1]

    return in_space


def drawn_in(slide, spin, centre, share):
    """Compute slide and spin by which `sliding_at` gives the slides at c + share × (r − c) for places r, c: centre."""
    if len(spin) == 1:
        return slide, spin
    rest = (1.0 - share) * spin[0]
    return (slide[0] - rest * centre[1], slide[1] + rest * centre[0]), (share * spin[0], spin[1], spin[2])


@overload(drawn_in)
def _drawn_in(slide, spin, centre, share):
    if len(spin) == 1:
        return lambda slide, spin, centre, share: (slide, spin)

    def in_space(slide, spin, centre, share):
        rest = (1.0 - share) * spin[0]
        return (slide[0] - rest * centre[1], slide[1] + rest * centre[0]), (share * spin[0], spin[1], spin[2])

    return in_space


def torsion_of(twist, rub, centre, share):
    """Moment of all forces of a joint, where those along it act at c + share × (r − c); twist: as if at r."""
    if len(twist) == 1:
        return twist
    about = centre[0] * rub[1] - centre[1] * rub[0]
    return share * twist[0] + (1.0 - share) * about, twist[1], twist[2]


@overload(torsion_of)
def _torsion_of(twist, rub, centre, share):
    if len(twist) == 1:
        return lambda twist, rub, centre, share: twist

    def in_space(twist, rub, centre, share):
        about = centre[0] * rub[1] - centre[1] * rub[0]
        return share * twist[0] + (1.0 - share) * about, twist[1], twist[2]

    return in_space


def reach_of(joints, point, side, centre, like):
    """Return the levers (2D) or the arm [m] (3D) of a point about the centroid of block a (side 0) or b (side 1)."""
    if len(like) == 2:
        return load_levers(joints.levers, point, side, like)
    return tuple(joints.points[point, k] - centre[k] for k in range(3))


@overload(reach_of)
def _reach_of(joints, point, side, centre, like):
    if len(like) == 2:
        return lambda joints, point, side, centre, like: load_levers(joints.levers, point, side, like)
    return lambda joints, point, side, centre, like: (
        joints.points[point, 0] - centre[0],
        joints.points[point, 1] - centre[1],
        joints.points[point, 2] - centre[2],
    )


def rates_at(frame, reach_a, reach_b, relative, spin_a, spin_b):
    """Speed of opening and sliding of a point whose blocks move and turn [m/s]; relative: of centroid b against a."""
    if len(frame) == 2:
        normal, along = components(frame, relative)
        normal_a, along_a = turn(reach_a, spin_a)
        normal_b, along_b = turn(reach_b, spin_b)
        return normal + normal_b - normal_a, axpy(-1.0, along_a, axpy(1.0, along_b, along))
    return components(frame, axpy(-1.0, sweep(spin_a, reach_a), axpy(1.0, sweep(spin_b, reach_b), relative)))


@overload(rates_at)
def _rates_at(frame, reach_a, reach_b, relative, spin_a, spin_b):
    if len(frame) == 2:

        def planar(frame, reach_a, reach_b, relative, spin_a, spin_b):
            normal, along = components(frame, relative)
            normal_a, along_a = turn(reach_a, spin_a)
            normal_b, along_b = turn(reach_b, spin_b)
            return normal + normal_b - normal_a, axpy(-1.0, along_a, axpy(1.0, along_b, along))

        return planar
    return lambda frame, reach_a, reach_b, relative, spin_a, spin_b: components(
        frame, axpy(-1.0, sweep(spin_a, reach_a), axpy(1.0, sweep(spin_b, reach_b), relative))
    )


def torque_at(reach, force, normal_part, tangent_parts):
    """Moment of a force at a point about a centroid: by its components along the frame in 2D, by itself in 3D."""
    if len(force) == 2:
        return add_torques(reach, normal_part, tangent_parts, (0.0,))
    return moment(reach, force)


@overload(torque_at)
def _torque_at(reach, force, normal_part, tangent_parts):
    if len(force) == 2:
        return lambda reach, force, normal_part, tangent_parts: add_torques(reach, normal_part, tangent_parts, (0.0,))
    return lambda reach, force, normal_part, tangent_parts: moment(reach, force)


def load_mobility(mobilities, row, like):
    """Load the inverse inertia of a block along the world axes, row by row: one number in 2D, three by three in 3D."""
    if len(like) == 2:
        return ((mobilities[row, 0],),)
    return tuple(tuple(mobilities[row, 3 * k : 3 * k + 3]) for k in range(3))


@overload(load_mobility)
def _load_mobility(mobilities, row, like):
    if len(like) == 2:
        return lambda mobilities, row, like: ((mobilities[row, 0],),)
    return lambda mobilities, row, like: (
        (mobilities[row, 0], mobilities[row, 1], mobilities[row, 2]),
        (mobilities[row, 3], mobilities[row, 4], mobilities[row, 5]),
        (mobilities[row, 6], mobilities[row, 7], mobilities[row, 8]),
    )


def spun(mobility, torque):
    """Compute the change of spin by an angular impulse: mobility × torque."""
    return tuple(dot(row, torque) for row in mobility)


@overload(spun)
def _spun(mobility, torque):
    if len(mobility) == 1:
        return lambda mobility, torque: (dot(mobility[0], torque),)
    return lambda mobility, torque: (dot(mobility[0], torque), dot(mobility[1], torque), dot(mobility[2], torque))
