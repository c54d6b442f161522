"""Records of arrays that the kernels work on, each with its meaning, unit and shape.

n_dof = d + r + m: d translations, r rotations, then m modes by which a block deforms (m = 0: rigid blocks). Time is the
solver's: seconds in dynamics, one unit per step in quasi-static runs (with fictitious masses).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.kernels.fixed_joints import NO_JOINTS, NO_SHARES, NOTHING, FixedJoints

NO_MODES = np.zeros((0, 0))


class Bodies(NamedTuple):
    """State of the blocks that changes: positions, velocities, forces."""

    positions: np.ndarray  # centroids [m], (n_blocks, d)
    orientations: np.ndarray  # angles [rad], (n_blocks, 1); in space rotation vectors, (n_blocks, 3), that add up where
    # geometry is that of the start, or where it moves unit quaternions from the start to now, (n_blocks, 4)
    velocities: np.ndarray  # half a step behind the positions; spins along the axes of the world, (n_blocks, n_dof)
    forces: np.ndarray  # sum of contact forces and moments [N, N m], (n_blocks, n_dof)
    unbalanced: np.ndarray  # contact forces and loads of the last step [N, N m], (n_blocks, n_dof)
    corners: np.ndarray  # world coordinates of all corners [m], (n_vertices, d); kept only by moving geometry
    turns: np.ndarray  # cosine and sine of the orientations, (n_blocks, 2), in space rotation matrices, row by row,
    # (n_blocks, 9); kept only by moving geometry
    mobilities: np.ndarray  # inverse tensors of inertia along the axes of the world, real ones, 0 of supports: those of
    # now in time histories [1/(kg m²)], (n_blocks, r·r)
    means: np.ndarray  # mean velocities of the last step, (n_blocks·n_dof,)
    drags: np.ndarray  # damping forces of the last step [N, N m], (n_blocks·n_dof,)
    pulled: np.ndarray  # velocities before the dashpots of a step, then after all of it, before blocks turn on,
    # (n_blocks·n_dof,)
    travel: np.ndarray  # bound of how far any corner moved since detection [m], (n_blocks,)
    # For joints in space that hold their geometry (kernels/spatial_forces.py):
    poses: np.ndarray = NO_MODES  # orientations from which turns count, as `orientations`
    turned: np.ndarray = NOTHING  # 1: has turned from there by what joints notice, and there it is now, (n_blocks,)
    # Of blocks that deform (model/uniform_strain.py), else empty:
    modes: np.ndarray = NO_MODES  # amplitudes [m], (n_blocks, m)
    gradients: np.ndarray = NO_MODES  # deformation gradients R (I + ε), row by row, (n_blocks, d·d)
    covectors: np.ndarray = NO_MODES  # in space, F⁻ᵀ of these gradients, which takes normals along, (n_blocks, 9)
    stretchings: np.ndarray = NO_MODES  # velocity gradients by deformation alone [1 per unit of time], (n_blocks, d·d)
    dyads: np.ndarray = NO_MODES  # Σ contact force ⊗ arm from the centroid, axes of the world [N m], (n_blocks, d·d)
    # Of quadratic modes (kernels/deformation/quadratic.py), in the axes of the block:
    bent: np.ndarray = NO_MODES  # displacement as a polynomial of the place, (n_blocks, 12)
    bending: np.ndarray = NO_MODES  # its rate, (n_blocks, 12)
    triads: np.ndarray = NO_MODES  # Σ contact force ⊗ (x², x y, y²) [N m²], (n_blocks, 6)


class BlockShapes(NamedTuple):
    """Constant geometry of the blocks."""

    corner_blocks: np.ndarray  # block of each corner, (n_vertices,)
    corner_arms: np.ndarray  # corner relative to the centroid, undeformed [m], (n_vertices, d)
    radii: np.ndarray  # largest distance of a corner from the centroid [m], (n_blocks,)
    inertias: np.ndarray  # moments of inertia, principal ones in space; 0 of supports [kg m²], (n_blocks, r)
    axes: np.ndarray  # from the principal axes to those of the block, matrices row by row, (n_blocks, 9); 2D (0, 9)
    mode_stiffness: np.ndarray = NO_MODES  # of blocks that deform, 0: rigid ones among them [N/m], (n_blocks, m)
    bends: np.ndarray = NO_MODES  # of quadratic modes: coefficients of each (model/quadratic_modes.py), (n_blocks, 72)


class MovingJoints(NamedTuple):
    """Pairs of faces that touch or may touch, point by point; a joint owns points starts[j]:starts[j + 1]."""

    blocks: np.ndarray  # blocks a and b, (n_joints, 2)
    starts: np.ndarray  # first point of each joint, (n_joints + 1,)
    frames: np.ndarray  # unit normal from a to b, then tangent(s) (2D: normal turned by +90°), (n_points, d·d)
    levers: np.ndarray  # moments of unit forces along the frame about both centroids [m], (n_points, 2·d·r)
    points: np.ndarray  # where the points are [m], (n_points, d)
    kn: np.ndarray  # normal stiffness of a point [N/m], (n_points,)
    ks: np.ndarray  # shear stiffness of a point [N/m], (n_points,)
    law: np.ndarray  # parameters of the joint law, (n_joints, n_parameters)
    torsion: np.ndarray = NO_SHARES  # in space: as FixedJoints.torsion, (n_joints,)
    held: np.ndarray = NO_JOINTS  # in space: points that touch, n; −1 − n where geometry was just measured, (n_joints,)
    # Of elastic faces (kernels/deformation/pressed_faces.py), else empty:
    integrated: np.ndarray = NOTHING  # 1: pressure is integrated over the face, (n_joints,) int8
    after: np.ndarray = NO_JOINTS  # in space: the point that follows along the outline, (n_points,)
    fans: np.ndarray = NO_SHARES  # and the share of the area between both and their mean, (n_points,)
    faint: np.ndarray = NO_SHARES  # how much of its pressure a corner hands to those beside it [-], (n_points,)
    back: np.ndarray = NO_SHARES  # and how much of that to the one before it [-], (n_points,)

    @property
    def owners(self) -> np.ndarray:
        """Joint of each point, (n_points,)."""
        return np.repeat(np.arange(len(self.blocks)), np.diff(self.starts))

    def kept(self) -> MovingJoints:
        """Copy what changes as blocks move in space: stiffness, torsion, outlines."""
        names = ("kn", "ks", "torsion", "after", "fans", "faint", "back")
        return self._replace(**{name: getattr(self, name).copy() for name in names})


# What both have in common: blocks, starts, owners, frames, levers, points, kn, ks, law.
Joints = MovingJoints | FixedJoints


class PlanarGeometry(NamedTuple):
    """Geometry of the two edges of each joint in the plane, row by row as `Joints`; constant but for `sunk`."""

    keys: np.ndarray  # the two faces (model.topology), by which a joint is known again, (n_joints, 2)
    features: np.ndarray  # place of each point among those of its joint, by which it is known again, (n_points,)
    edges: np.ndarray  # corners (a0, a1, b0, b1) of the two edges, (n_joints, 4)
    scales: np.ndarray  # length of edge a [m]; 1/length of a, of b, `blend` of share_of [1/m]; cotangents of the inner
    # angles at the corners of `edges`, (n_joints, 8)
    profile: np.ndarray  # place along the edge of b and rise above it [m], (n_points, 2); (0, 2): all joints are plane
    sunk: np.ndarray  # chains only: penetration that a joint had when it came to touch, its zero [m], (n_joints,)

    @property
    def faces(self) -> np.ndarray:
        """Two faces of each joint (model.topology), (n_joints, 2)."""
        return self.keys

    def settled(self) -> PlanarGeometry:
        """Return what is used when points stay where they were placed: the whole record."""
        return self

    def kept(self) -> PlanarGeometry:
        """Return the record with a copy of the arrays that change."""
        return self._replace(sunk=self.sunk.copy())


class Polyhedra(NamedTuple):
    """Convex parts in space, in place, as detection and contact geometry read them (model.topology)."""

    corners: np.ndarray  # [m], (n_vertices, 3)
    part_starts: np.ndarray  # part p has the corners part_starts[p]:part_starts[p + 1]
    part_faces: np.ndarray  # and the faces part_faces[p]:part_faces[p + 1]
    face_starts: np.ndarray  # face f has the corners face_corners[face_starts[f]:face_starts[f + 1]]
    face_corners: np.ndarray  # counter-clockwise seen from outside
    normals: np.ndarray  # unit, outwards, (n_faces, 3)
    part_edges: np.ndarray  # part p has the edges part_edges[p]:part_edges[p + 1]
    edges: np.ndarray  # two corners, and the two faces that meet along each, (n_edges, 4)
    sizes: np.ndarray  # diagonals of the boxes around the parts [m], (n_parts,)


class SpatialGeometry(NamedTuple):
    """Geometry of joints in space as they were found, row by row as `Joints`; fixed geometry.

    All points of a joint lie in one plane, across its normal.
    """

    keys: np.ndarray  # the two faces (model.topology), by which a joint is known again, (n_joints, 2)
    features: np.ndarray  # corners or edges that make each point, by which it is known again, (n_points,)
    kinds: np.ndarray  # FACES, RIM_OF_A, RIM_OF_B or EDGES, (n_joints,) int8
    corners: np.ndarray  # how many of the points of a joint are its outline; those after these lie within, (n_joints,)
    axes: np.ndarray  # unit normal from a to b, and two tangents, (n_joints, 9)
    places: np.ndarray  # of the points, in the coordinates in which they were found [m], (n_points, 3)
    gaps: np.ndarray  # along the normal, positive open [m], (n_points,)
    areas: np.ndarray  # of the joints [m²], (n_joints,)

    @property
    def faces(self) -> np.ndarray:
        """Two faces of each joint (model.topology), (n_joints, 2)."""
        return self.keys

    def settled(self) -> SpatialGeometry:
        """Return what is used when points stay where they were placed; these are then with the joints."""
        return self._replace(axes=np.zeros((0, 9)), places=np.zeros((0, 3)), gaps=np.zeros(0))

    def kept(self) -> SpatialGeometry:
        """Return the record itself: nothing of it changes."""
        return self


FACES, RIM_OF_A, RIM_OF_B, EDGES = 0, 1, 2, 3  # of SpatialGeometry.kinds


class SpatialMotion(NamedTuple):
    """Geometry of contact points of blocks that move in space, row by row as `Joints`.

    A joint has room for more points than there are now: a slot without a point has no stiffness. Renewal (renewal.py)
    changes what a slot holds; what goes on being a point keeps its slot.
    """

    keys: np.ndarray  # the two parts of each joint, by which it is known again, (n_joints, 2)
    features: np.ndarray  # what makes the point of each slot, by which it is known again; −1: none, (n_points,)
    kinds: np.ndarray  # as SpatialGeometry.kinds, (n_joints,) int8
    faces: np.ndarray  # the faces that look at each other, (n_joints, 2)
    normals: np.ndarray  # outward unit normals of both, each in the frame of its block, (n_joints, 6)
    tangents: np.ndarray  # what shear is counted along, in the frame of block a, (n_joints, 3)
    markers: np.ndarray  # two corners of face b in the frame of block a, at the last renewal [m], (n_joints, 6)
    apart: np.ndarray  # from centroid b to a when geometry was measured that may be held, else nan [m], (n_joints, 3)
    opened: np.ndarray  # by how much a point opened since the step before it was measured [m], (n_points,)
    scales: np.ndarray  # columns as in spatial_points.py, (n_joints, 10)
    edges: (
        np.ndarray
    )  # of joints of two edges: corners of that of a and of that of b, sign of the normal; −1: none, (n, 5)
    types: np.ndarray  # CORNER_OF_B, CORNER_OF_A, CROSSING or FIXED_TO_B, (n_points,) int8
    corners: np.ndarray  # that corner and up to two sides of the rim near it (−1: none), or two edges, (n_points, 5)
    shares: np.ndarray  # of crossings: place along the edge of a when renewed; lone: sign of the normal, (n_points,)
    spans: np.ndarray  # one over the lengths of those sides of the rim [1/m], (n_points, 2)
    arms: np.ndarray  # of points fixed to b: in its frame, from its centroid [m], (n_points, 3)
    rises: np.ndarray  # of caps (contact/caps.py): how high the outline of b lies over its lowest ring [m], (n_joints,)
    slopes: np.ndarray  # of a cap, of its steepest side, (n_joints,)
    cap_starts: np.ndarray  # a joint has the inner points cap_starts[j]:cap_starts[j + 1] of a cap, (n_joints + 1,)
    cap_arms: np.ndarray  # of these, as `arms`, (n, 3)
    cap_areas: np.ndarray  # [m²], (n,)
    face_starts: np.ndarray  # as Polyhedra, and the next four
    face_corners: np.ndarray
    part_starts: np.ndarray
    part_edges: np.ndarray
    part_sides: np.ndarray  # the corners of each edge, (n_edges, 2)
    work: np.ndarray  # of renewal: outlines, (6, room, 4)
    found: np.ndarray  # points that were found: as `corners`, (room, 5)
    labels: np.ndarray  # feature and type of each, (room, 2)
    numbers: np.ndarray  # area, share, arm of each, and what it has from the nearest point before, (room, 11 + memory)
    taken: np.ndarray  # slot that each has, (room,)
    heirs: np.ndarray  # and the slot that is nearest to each new one, (room,)

    def settled(self) -> SpatialMotion:
        """Return what is used when points stay where they were placed: the whole record."""
        return self

    def kept(self) -> SpatialMotion:
        """Return the record with a copy of the arrays that change."""
        changing = ("features", "markers", "types", "corners", "shares", "spans", "arms")
        unmeasured = np.full_like(self.apart, np.nan)
        return self._replace(apart=unmeasured, **{name: getattr(self, name).copy() for name in changing})


CORNER_OF_B, CORNER_OF_A, CROSSING, FIXED_TO_B = 0, 1, 2, 3  # of SpatialMotion.types


class Contacts(NamedTuple):
    """State of the contact points that changes: forces, slip, memory."""

    gaps: np.ndarray  # positive open [m], (n_points,)
    shear: np.ndarray  # shear force on b along the tangents [N], (n_points, d - 1)
    normal: np.ndarray  # normal force, compression positive [N], (n_points,)
    slip: np.ndarray  # accumulated slip path [m], (n_points,)
    memory: np.ndarray  # whatever the law remembers, then what the dampers do, (n_points, n_memory)
    closure: np.ndarray  # overlap that a point needs for the force that it was last at rest with: the normal force is
    # kn × (closure − gap) [m], (n_points,); 0: kn × −gap, an elastic joint (engine/rigid_joints.py)
    stale: np.ndarray  # 1: no longer the touching faces; the last entry asks for detection, (n_joints + 1,) int8
    exchanged: (
        np.ndarray
    )  # elastic energy that went with areas that changed [J]: net (negative: made), sum of amounts, (2,)
    jolts: np.ndarray  # work of the present call by `contact_point.jolt` [J], (1,)
    lumped: np.ndarray = (
        NO_SHARES  # gaps at which the points of elastic faces carry what they do [m], (n_points,); empty:
    )
    # there are none (kernels/deformation/pressed_faces.py)


class Loads(NamedTuple):
    """Applied loads and how they drive the blocks."""

    dead: np.ndarray  # [N, N m], (n_blocks, n_dof)
    live: np.ndarray  # per unit of the load multiplier [N, N m], (n_blocks, n_dof)
    inverse_masses: np.ndarray  # fictitious or real; 0: prescribed velocity, (n_blocks, n_dof)
    force_scales: np.ndarray  # unbalanced force × scale = its share of the block's own weight, (n_blocks, n_dof)
    speed_limits: np.ndarray  # largest velocity; infinite but for blocks that fall in pseudo-time, (n_blocks, n_dof)


class Ground(NamedTuple):
    """Motion of the supports over the steps of a stretch; the frame of coordinates moves with the base."""

    accelerations: np.ndarray  # of the frame, mean over each step [m/s²], (n_steps, d)
    moving: np.ndarray  # supports that move relative to the frame, (n_moving,)
    velocities: np.ndarray  # of them, after each step [m/s, rad/s], (n_steps, n_moving, n_dof)


class StrainRates(NamedTuple):
    """Rates of the modes of blocks in a time history (kernels/deformation/strain_rates.py); empty: all are rigid."""

    turns: np.ndarray  # W: by which rates of modes turn a block less than its mean [rad/m], (n_blocks, r, m)
    masses: np.ndarray  # of modes, beside the mean spin [kg], (n_blocks, m, m)
    viscosity: np.ndarray  # of modes [N s/m], (n_blocks, m)
    keep: np.ndarray  # rates after a step by those before [-], (n_blocks, m, m)
    gain: np.ndarray  # and by forces [s/kg], (n_blocks, m, m)
    mobilities: np.ndarray  # rates by impulses in a step, in which modes are damped [1/kg], (n_blocks, m, m)
    radii: np.ndarray  # of blocks [m], (n_blocks,)
    bends: np.ndarray  # as BlockShapes.bends


class Dampers(NamedTuple):
    """Masses and viscous joints of time histories.

    Impulses and Maxwell forces of the joints are columns of Contacts.memory, from `first` on: d impulses [N s], then d
    forces of each Maxwell element [N].
    """

    first: int
    viscosity: np.ndarray  # damping over stiffness of a joint [s], (n_joints,)
    elements: np.ndarray  # Maxwell: force kept over a step [-], gained per stiffness and rate [s], (n_elements, 2);
    # where there are none: (0,)
    rates: np.ndarray  # opening and sliding before the step [m/s], where elements ask for it, (n_points, d)
    gains: np.ndarray  # what a turn reads, of the points that touch one behind another, columns as in dashpots.py,
    # (n_points, 16), in space as in spatial_dashpots.py, (n_points, 18)
    packed: np.ndarray  # in the plane the rows packed[j]:packed[j + 1] of `gains` are of joint j, (n_joints + 1,)
    lasts: np.ndarray  # in space these are packed[j]:lasts[j], and packed[-1] the first row that is free, (n_joints,)
    rooms: np.ndarray  # how many they may become where they are, (n_joints,)
    holders: np.ndarray  # and these the points of the rows, (n_points,)
    active: np.ndarray  # joints that have rows; the last entry is how many they are, (n_joints + 1,)
    awake: np.ndarray  # those of them that are swept once more, (n_joints,)
    met: np.ndarray  # 1: points of the joint have met in this step, (n_joints,) int8
    stirred: np.ndarray  # last turn of this step in which others on a block notice its impulses, (n_blocks,) int8
    trifles: np.ndarray  # impulses that nobody notices [N s]; infinite for supports, (n_blocks,)
    slips: np.ndarray  # slip path after the last step [m], (n_points,)
    states: np.ndarray  # 0: open, 1: sticking, 2: slipping, 3: closed from now on, (n_points,) int8
    masses: np.ndarray  # and moments of inertia in the plane; 0 of supports, and where inertia is a tensor (in
    # space: BlockShapes.inertias), (n_blocks, n_dof)
    pushes: np.ndarray  # impulses of the step before on the blocks [N s, N m s], (n_blocks, n_dof)
    strained: StrainRates
    motions: np.ndarray  # of points by rates of modes of both blocks [-], (n_points, 2, d, m); of rigid blocks: (0,)
    lifts: np.ndarray  # rates of modes by impulses there [1/kg], of the same shape


NO_LINKS = np.zeros((0, 0, 3))


class Gauges(NamedTuple):
    """Numbers whose extremes are taken at every step (kernels/gauges.py); gauge g reads points starts[g]:starts[g + 1].

    Of each the mean over its points, along one axis, or the square of its length.
    """

    kinds: np.ndarray  # PLACE, SPEED or TURN, and the first two with the base, (n_gauges,) int64
    components: np.ndarray  # axis; −1: square of the length; −2: along `axes`, (n_gauges,) int64
    axes: np.ndarray  # unit, (n_gauges, d)
    starts: np.ndarray  # (n_gauges + 1,) int64
    blocks: np.ndarray  # block of each point, (n,) int64
    arms: np.ndarray  # from its centroid, in its own axes [m], (n, d)
    drawn: np.ndarray  # where the point was drawn [m], (n, d)
    weights: np.ndarray  # of the points in the mean, (n,)
    base: np.ndarray  # displacement and velocity of the base at every step [m, m/s], (n_steps, 2, d); (0, 2, d): unused
    plain: np.ndarray  # kind of gauges of one component at the centroid of one block that need no more than one number:
    # PLACE, SPEED, in the plane TURN; −1: others, (n_gauges,) int64
    owners: np.ndarray  # block of their first point, (n_gauges,) int64
    shifts: np.ndarray  # where it was drawn along that component [m], (n_gauges,)
    found: np.ndarray  # out: highest value, its step, lowest value, its step; the step is one of the stretch, (n, 4)
    tally: np.ndarray  # out: least gap of a point [m], and steps in which points met, (2,); (0,): not looked at


PLACE, SPEED, TURN, PLACE_IN_SPACE, SPEED_IN_SPACE = 0, 1, 2, 3, 4  # of Gauges.kinds
HIGHEST, HIGHEST_AT, LOWEST, LOWEST_AT = 0, 1, 2, 3  # columns of Gauges.found
LEAST_GAP, MET = 0, 1  # of Gauges.tally
_NUMBERS, _VECTORS = np.zeros(0, np.int64), np.zeros((0, 0))
NO_GAUGES = Gauges(
    _NUMBERS, _NUMBERS, _VECTORS, _NUMBERS, _NUMBERS, _VECTORS, _VECTORS, np.zeros(0), np.zeros((0, 2, 0)),
    _NUMBERS, _NUMBERS, np.zeros(0), np.zeros((0, 4)), np.zeros(0),
)  # fmt: skip


class Watch(NamedTuple):
    """Blocks whose motion is sampled: place, velocity and acceleration at one instant, relative to the base."""

    blocks: np.ndarray  # (n_watched,)
    every: int  # steps from one sample to the next
    samples: np.ndarray  # out: of the steps 0, every, 2 every ... of a stretch, (n_samples, n_watched, 3, n_dof)
    links: np.ndarray = NO_LINKS  # out: state of all links at these steps (links/link.py), (n_samples, n_links, 3)
    gauges: Gauges = NO_GAUGES  # what is looked at in every step


NOT_INTEGRATED, INTEGRATED = 0, 1  # of Joints.integrated

# Slots of the vector `ledger`: sums over steps [J].
EXTERNAL, CONTACT, DAMPING, FRICTION, SUPPORT, DASHPOT, MASS, MAXWELL = 0, 1, 2, 3, 4, 5, 6, 7
LIVE = 8  # what of EXTERNAL live loads gave
JOLT = 9  # what steps took in which points closed, less what those gave in which they opened, in pseudo-time
N_LEDGER = 10

# Slots of the vector `control`.
DEAD_FACTOR = 0  # multiplies dead loads
LIVE_FACTOR = 1  # multiplies live loads
RATE = 2  # creep: prescribed live·v per step
DAMP = 3  # local damping: share of |F| against the velocity
UNBALANCED = 4  # out: largest unbalanced force of the last step, in weights of its own block
MEAN_LOAD = 5  # out: mean live factor over the call
TRAVEL_LIMIT = 6  # stop when a corner may have moved that far since detection [m]
FIRE_MIX = 7  # state of FIRE: current mixing
SINCE_UPHILL = 8  # state of FIRE: steps since the power was negative
DAMP_CHANGE = 9  # combined damping: share of |F| against its own change
MASS_RATE = 10  # damping force over mass and velocity of a block [1/s]
FIRE_START = 11  # mixing with which FIRE begins, and begins again after a step uphill
N_CONTROL = 12

# What the step is driven by.
HOLD_LOAD, CREEP, FIRE, TILT_CREEP, GUIDED, TILT_GUIDED = 0, 1, 2, 3, 4, 5
