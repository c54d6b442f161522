"""Natural frequencies of a structure on its joints: stiffness of the contact springs, real masses, eigenvalues.

    K = Bᵀ diag(k) B + G,   K φ = ω² M φ

B: relative motion at every contact point (contact.compatibility), k: its normal and shear stiffness; free blocks only.
G, on request: the geometric stiffness of the contact forces (dynamics.geometric_stiffness), W/(kn h) of the rest.
In space M is not diagonal: moments of inertia are those about principal axes. There the eigenvalues are found with
rotations about these axes; shapes have rotation vectors along the axes of the world.

Modes of blocks that deform are further degrees of freedom behind the rotations, with their own stiffness in K and their
consistent masses in M (model.mode_masses), which couple them with rotations and with each other; G leaves them out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.functions import agreed, agreed_beside
from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import diagonalised
from dem_cli.core.contact.compatibility import compatibility, held_motions
from dem_cli.core.dynamics.geometric_stiffness import geometric_stiffness
from dem_cli.core.engine.dynamic_settings import FrequencySettings
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.links.matrices import elongations
from dem_cli.core.links.matrices import geometric as geometric_of_links
from dem_cli.core.model.mode_masses import mass_matrices
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.kernels.records import Bodies, Joints
    from dem_cli.core.model.model import Model


class System(NamedTuple):
    """Springs and masses of the free degrees of freedom: block by block, translations first.

    L: M = Lᵀ L, a square root of the mass matrix, which turns rotations into principal axes.
    """

    rows: csr_array  # √k B L⁻¹, (n_points·d, n_free): without G, its Gram matrix has the eigenvalues ω² [1/s2]; a row
    # for each link is below these
    geometric: csr_array | None  # L⁻ᵀ G L⁻¹ [1/s2], (n_free, n_free); None: left out
    masses: np.ndarray  # and principal moments of inertia [kg, kg m2], (n_free_blocks, n_dof)
    axes: np.ndarray  # from principal axes to those of the world, with modes of blocks: from uncoupled motions to
    # rotations and modes, orthogonal, (n_free_blocks, r + m, r + m)
    blocks: np.ndarray  # free blocks, in their order, (n_free_blocks,)
    held: np.ndarray  # columns that restraints hold, and modes of rigid blocks: nothing is in them, (n_free,) bool
    settings: FrequencySettings

    @property
    def matrix(self) -> csr_array:
        """Dynamic matrix L⁻ᵀ K L⁻¹ [1/s2], symmetric; without G positive semidefinite, (n_free, n_free)."""
        springs = (self.rows.T @ self.rows).tocsr()
        return springs if self.geometric is None else springs + self.geometric

    @property
    def stiffness(self) -> csr_array:
        """Stiffness matrix K [N/m, N, N m], (n_free, n_free)."""
        from scipy.sparse import diags_array

        roots = diags_array(np.sqrt(self.masses.ravel())) @ _turning(self.axes, self.masses.shape[1]).T
        return (roots.T @ self.matrix @ roots).tocsr()

    def motion(self, vectors: np.ndarray) -> np.ndarray:
        """Convert scaled motions y to L⁻¹ y: displacements and rotation vectors of the free blocks [m, rad], (...,
        n_free_blocks, n_dof)."""
        found = vectors / np.sqrt(self.masses)
        return _with_rotations(found, self.axes)

    def reduced(self, forces: np.ndarray) -> np.ndarray:
        """Convert forces and moments f on the free blocks [N, N m], (n_free_blocks, n_dof), to L⁻ᵀ f."""
        return _with_rotations(forces, self.axes.swapaxes(1, 2)) / np.sqrt(self.masses)


class Highest(NamedTuple):
    """Highest natural frequency of a structure, with the block and the joint that its mode strains most."""

    frequency: float  # ω [rad/s]; 0 where no joint holds any block
    exact: bool  # False: not an eigenvalue but a bound above it
    block: int  # that moves most (by kinetic energy); -1: none
    joint: int  # of the simulation, that is strained most among those of this block; -1: none


class Modes(NamedTuple):
    """Lowest natural frequencies of a structure with mode shapes and effective masses, lowest first."""

    frequencies: np.ndarray  # [Hz], (n,)
    shapes: np.ndarray  # [m, rad], scaled to φᵀ M φ = 1 kg m2; zero for fixed blocks, (n, n_blocks, n_dof)
    effective_masses: np.ndarray  # that follow a motion of the base along each axis [kg], (n, d)
    mechanisms: int  # motions of free blocks that no joint holds back: without a frequency, not among the above
    loose: np.ndarray  # blocks that take part in these, (n_loose,)

    def agreed(self) -> Modes:
        """Round the modes to digits that all processors agree on, beside the largest part of each shape."""
        masses = agreed_beside(self.effective_masses, self.effective_masses.max(initial=0.0))
        shapes = [agreed_beside(shape, np.abs(shape).max(initial=0.0)) for shape in self.shapes]
        return self._replace(
            frequencies=agreed(self.frequencies),
            effective_masses=masses,
            shapes=np.array(shapes).reshape(self.shapes.shape),
        )


def system(sim: Simulation, closed: np.ndarray | None = None, geometric: bool = False) -> System:
    """Springs and masses of a simulation where its blocks are now.

    closed: which contact points act, (n_points,) bool; default: all in the list, also those that are open and may
    close: no state of the structure with these joints vibrates faster. geometric: with the forces that act now.
    """
    contacts = sim.measured()  # and frames and levers of this instant
    model, joints = sim.model, sim.joints
    found = springs_of(model, joints, closed, sim.settings.frequency, sim.bodies, contacts.gaps)
    found = found._replace(rows=_with_links(found, sim, closed is not None))
    if not geometric:
        return found
    per_mass = _per_mass(found.masses, found.axes)
    if model.n_modes:
        per_mass = _rigid_motions(model) @ per_mass
    turning = geometric_stiffness(model, joints, sim.geometry, contacts, sim.bodies)
    if sim.links:
        turning = turning + geometric_of_links(sim.links, sim.bodies, model.fixed, sim.bodies.velocities.shape[1])
    return found._replace(geometric=(per_mass.T @ turning @ per_mass).tocsr())


def with_springs(found: System, springs: csr_array) -> System:
    """Add stiffness of the free degrees of freedom [N/m, N, N m], (n_free, n_free), symmetric."""
    per_mass = _per_mass(found.masses, found.axes)
    more = (per_mass.T @ springs @ per_mass).tocsr()
    return found._replace(geometric=more if found.geometric is None else (found.geometric + more).tocsr())


def _with_links(found: System, sim: Simulation, acting: bool) -> csr_array:
    """Rows of the joints, below them √k T L⁻¹ of links; acting: of those that carry a force now."""
    from scipy.sparse import diags_array, vstack

    springs = sim.link_springs(along=True)
    if springs is None:
        return found.rows
    stiffness = springs.stiffness
    if acting:
        stiffness = stiffness * np.concatenate([link.acting() for link in sim.links])
    stretch = diags_array(np.sqrt(stiffness)) @ elongations(springs, sim.model.fixed)
    stretch = stretch @ diags_array(np.where(found.held, 0.0, 1.0)) if found.held.any() else stretch
    rows = vstack([found.rows, stretch @ _per_mass(found.masses, found.axes)]).tocsr()
    rows.eliminate_zeros()
    return rows


def springs_of(
    model: Model,
    joints: Joints,
    closed: np.ndarray | None = None,
    settings: FrequencySettings = DEFAULT.frequency,
    bodies: Bodies | None = None,
    gaps: np.ndarray | None = None,
) -> System:
    """Springs and masses of joints whose frames and levers are current; closed: as for `system`.

    bodies: where all blocks are, with the modes of those that deform; None: none has turned, and all are rigid.
    gaps: of all points [m], by which elastic faces are closed in part; None: they are closed, or open, as a whole.
    """
    from scipy.sparse import vstack

    d, strained = model.dimension, bodies if model.n_modes else None
    blocks = np.flatnonzero(~model.fixed)
    turning, axes = (part[blocks] for part in _uncoupled(model, bodies))
    masses = np.column_stack([np.repeat(model.masses[blocks, None], d, axis=1), turning])
    per_mass = _per_mass(masses, axes)
    rows = (_roots(joints, d, closed, gaps) @ compatibility(model, joints, strained) @ per_mass).tocsr()
    held = model.held_columns
    if strained is not None:
        rows, held = vstack([rows, _own_springs(model) @ per_mass]).tocsr(), held_motions(model, True)[blocks].ravel()
    rows.eliminate_zeros()
    return System(rows, None, masses, axes, blocks, held, settings)


def _roots(joints: Joints, d: int, closed: np.ndarray | None, gaps: np.ndarray | None) -> csr_array:
    """S with SᵀS = K, forces by motions of all points, their normals first, (n_points·d, n_points·d)."""
    from scipy.sparse import csr_array, diags_array

    springs = np.column_stack([joints.kn, *[joints.ks] * (d - 1)])
    if closed is not None:
        springs = springs * closed[:, None]
    if not len(joints.integrated):
        return diags_array(np.sqrt(springs.ravel())).tocsr()
    from dem_cli.core.dynamics.pressed_stiffness import root_of_stiffness

    root = root_of_stiffness(joints, _overlaps(joints, closed, gaps)).tocoo()
    springs[:, 0] = 0.0
    normals = csr_array((root.data, (d * root.row, d * root.col)), shape=(springs.size, springs.size))
    return normals + diags_array(np.sqrt(springs.ravel())).tocsr()


def _overlaps(joints: Joints, closed: np.ndarray | None, gaps: np.ndarray | None) -> np.ndarray:
    """Overlaps of all points [m], negative: open, (n_points,); 0 of faces that are closed as a whole, or just touch."""
    owners, n = joints.owners, len(joints.blocks)
    if closed is None:
        return np.zeros(len(owners))
    found = np.where(closed, 0.0, -1.0)
    acts = np.bincount(owners, closed, n) > 0.0
    whole = (joints.integrated == INTEGRATED)[owners]
    found[whole] = np.where(acts[owners], 0.0, -1.0)[whole]
    if gaps is not None:
        presses = np.bincount(owners, gaps <= 0.0, n) > 0.0
        bent = whole & (acts & presses)[owners]
        found[bent] = -gaps[bent]
    return found


def _uncoupled(model: Model, bodies: Bodies | None) -> tuple[np.ndarray, np.ndarray]:
    """Moments of inertia, and masses of modes, of motions of each block that are not coupled, (n_blocks, r + m); with
    these motions as System.axes."""
    if bodies is None or not model.n_modes:
        return model.inertias, principal_directions(model, None if bodies is None else bodies.orientations)
    matrix, r = mass_matrices(model), model.inertias.shape[1]
    if r == 3:
        matrix[:, :r] = product(matrices(bodies.orientations), matrix[:, :r])
        matrix[:, :, :r] = product(matrix[:, :, :r], matrices(bodies.orientations).swapaxes(1, 2))
    free = ~held_motions(model, True)[:, model.dimension :]
    found, axes = np.diagonal(matrix, axis1=1, axis2=2).copy(), np.tile(np.eye(matrix.shape[1]), (len(matrix), 1, 1))
    for block, kept in enumerate(free):  # those that are held stay what and where they are
        among = np.ix_(kept, kept)
        found[block, kept], axes[block][among] = diagonalised(matrix[block][among])
    return found, axes


def _own_springs(model: Model) -> csr_array:
    """√K of the modes of blocks that deform, (n_free_blocks·m, n_free)."""
    from scipy.sparse import coo_array

    n_dof = model.rotations.stop + model.n_modes
    stiffness = model.mode_stiffness[~model.fixed]
    columns = n_dof * np.arange(len(stiffness))[:, None] + np.arange(model.rotations.stop, n_dof)
    places = np.arange(stiffness.size), columns.ravel()
    return coo_array((np.sqrt(stiffness.ravel()), places), shape=(stiffness.size, n_dof * len(stiffness))).tocsr()


def _rigid_motions(model: Model) -> csr_array:
    """Build the matrix from degrees of freedom of deformable blocks to those of rigid ones, (n_free_rigid, n_free)."""
    from scipy.sparse import eye_array, kron

    one = eye_array(model.rotations.stop, model.rotations.stop + model.n_modes)
    return kron(eye_array(int((~model.fixed).sum())), one).tocsr()


def principal_directions(model: Model, orientations: np.ndarray | None = None) -> np.ndarray:
    """Rotation matrices from the principal axes of each block to the axes of the world, (n_blocks, r, r); 1 in the
    plane."""
    if not len(model.principal_axes):
        return np.ones((model.n_blocks, 1, 1))
    own = matrices(model.principal_axes)
    return own if orientations is None else product(matrices(orientations), own)


def _per_mass(masses: np.ndarray, axes: np.ndarray) -> csr_array:
    """Build the matrix L⁻¹ of System."""
    from scipy.sparse import diags_array

    return _turning(axes, masses.shape[1]) @ diags_array(1.0 / np.sqrt(masses.ravel()))


def _turning(axes: np.ndarray, n_dof: int) -> csr_array:
    """Degrees of freedom from those with rotations about principal axes, (n_free, n_free), orthogonal."""
    from scipy.sparse import coo_array

    n, r = axes.shape[:2]
    blocks = np.zeros((n, n_dof, n_dof))
    blocks[:] = np.eye(n_dof)
    blocks[:, n_dof - r :, n_dof - r :] = axes
    first = n_dof * np.arange(n)[:, None, None]
    rows, columns = first + np.arange(n_dof)[:, None], first + np.arange(n_dof)
    rows, columns = np.broadcast_arrays(rows, columns)
    used = blocks != 0.0
    return coo_array((blocks[used], (rows[used], columns[used])), shape=(n * n_dof, n * n_dof)).tocsr()


def _with_rotations(values: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Generalised vectors (..., n, n_dof) with their last r components turned, each block's by its own matrix."""
    r = axes.shape[1]
    turned = product(axes, values[..., -r:, None])[..., 0]
    return np.concatenate([values[..., :-r], turned], axis=-1)


def highest_frequency(sim: Simulation) -> float:
    """Highest natural frequency ω [rad/s] with all contact points closed; 0 where there are none.

    The largest eigenvalue to round-off, or Gershgorin's bound above it where the iteration does not converge.
    """
    return highest_of(system(sim))


def highest_of(found: System) -> float:
    """Compute the highest natural frequency ω [rad/s] of springs and masses."""
    return _largest(found)[0]


def limiting(sim: Simulation) -> Highest:
    """Find the highest natural frequency, and the block and the joint that its mode moves and strains most."""
    found = system(sim)
    frequency, vector = _largest(found)
    if frequency == 0.0:
        return Highest(0.0, True, -1, -1)
    exact = vector is not None
    if vector is None:  # the degree of freedom with the largest bound
        vector = np.zeros(found.masses.size)
        vector[_gershgorin(found.matrix).argmax()] = 1.0
    block = found.blocks[_first_largest((vector.reshape(len(found.blocks), -1) ** 2).sum(axis=1), found.settings.equal)]
    d, owner = sim.model.dimension, sim.joints.owners
    energy = ((found.rows @ vector)[: d * len(owner)].reshape(len(owner), d) ** 2).sum(axis=1)
    strained = np.bincount(owner, energy, len(sim.joints.blocks))
    strained[~(sim.joints.blocks == block).any(axis=1)] = -1.0
    held = not sim.links or (strained > 0.0).any()  # by a joint, not by links alone
    joint = _first_largest(strained, found.settings.equal) if held else -1
    return Highest(frequency, exact, int(block), joint)


def _largest(found: System) -> tuple[float, np.ndarray | None]:
    """Highest frequency [rad/s] and its mode times √M, (n_free,); no mode where the frequency is but a bound."""
    settings = found.settings
    n = found.masses.size
    if n == 0 or found.rows.nnz == 0:
        return 0.0, np.zeros(n)
    matrix = found.matrix
    if n <= settings.dense:
        values, vectors = np.linalg.eigh(matrix.toarray())
        return float(np.sqrt(values[-1])), vectors[:, -1]
    from scipy.sparse.linalg import ArpackError, eigsh

    try:
        values, vectors = eigsh(matrix, k=1, which="LA", v0=start_vector(n), tol=settings.accurate)
    except ArpackError:
        return float(np.sqrt(_gershgorin(matrix).max())), None
    return float(np.sqrt(values[0])), vectors[:, 0]


def modes(found: System, count: int, dimension: int, n_blocks: int) -> Modes:
    """Compute the `count` lowest natural frequencies above 0 with their shapes; fewer where there are not so many.

    The sign of a shape: it follows a base that moves along +x, or along +y where that excites it more.
    """
    masses, (n_free, n_dof) = found.masses, found.masses.shape
    entries = np.bincount(found.rows.indices, minlength=n_free * n_dof)
    strained = (entries > 0).reshape(n_free, n_dof).any(axis=1)  # blocks that touch anything
    joined = np.repeat(strained, n_dof) & ~found.held
    values, joined_vectors = _lowest(found.matrix[joined][:, joined], count, found.settings)
    flat = np.zeros((len(values), n_free * n_dof))
    flat[:, joined] = joined_vectors.T
    vectors = flat.reshape(len(values), n_free, n_dof)
    still = values == 0.0
    loose = ~strained | ((vectors[still] ** 2).sum(axis=2) > found.settings.equal).any(axis=0)
    moving = found.motion(vectors[~still])
    shares = (moving * masses)[:, :, :dimension].sum(axis=1)  # φᵀ M r, r: unit motion of the base along each axis
    shapes = np.zeros((len(moving), n_blocks, n_dof))
    shapes[:, found.blocks] = moving * _signs(moving, shares, masses[:, 0].sum(), found.settings.equal)[:, None, None]
    return Modes(
        frequencies=np.sqrt(values[~still]) / (2.0 * np.pi),
        shapes=shapes,
        effective_masses=shares**2,
        mechanisms=int(still.sum() + (~joined & ~found.held).sum()),
        loose=found.blocks[loose],
    )


def _lowest(matrix: csr_array, count: int, settings: FrequencySettings) -> tuple[np.ndarray, np.ndarray]:
    """Compute all eigenvalues up to 0, set exactly to 0, and the `count` lowest above, with vectors (n, n_values)."""
    n = matrix.shape[0]
    largest, asked = float(_gershgorin(matrix).max(initial=0.0)), count
    while True:
        if n <= settings.dense or asked >= settings.dense_share * n:
            values, vectors = np.linalg.eigh(matrix.toarray())
        else:
            values, vectors = _shift_invert(matrix, min(asked, n - 1), settings.shift * largest)
        values[values < settings.zero * largest] = 0.0
        stop = int((values == 0.0).sum()) + count
        if len(values) >= min(stop, n - 1):
            return values[:stop], vectors[:, :stop]
        asked = max(2 * asked, stop)


def _shift_invert(matrix: csr_array, count: int, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the `count` lowest eigenvalues in ascending order, with their vectors (n, count)."""
    from scipy.sparse.linalg import ArpackError, eigsh

    try:
        values, vectors = eigsh(matrix.tocsc(), k=count, sigma=-shift, v0=start_vector(matrix.shape[0]))
    except ArpackError as error:
        raise SolverError(f"the {count} lowest natural frequencies were not found: {error}") from None
    order = np.argsort(values, kind="stable")
    return values[order], vectors[:, order]


def _signs(shapes: np.ndarray, shares: np.ndarray, mass: float, equal: float) -> np.ndarray:
    """1 or −1 for each shape (n, n_blocks, n_dof): with the base where it follows it, else its first large part up."""
    signs = np.empty(len(shapes))
    for i, (shape, share) in enumerate(zip(shapes, shares)):
        axis = _first_largest(np.abs(share), equal)
        excited = share[axis] ** 2 > equal * mass
        leading = share[axis] if excited else shape.ravel()[_first_largest(np.abs(shape).ravel(), equal)]
        signs[i] = 1.0 if leading >= 0.0 else -1.0
    return signs


def start_vector(n: int) -> np.ndarray:
    """Return a fixed start vector for iterations that no mode is orthogonal to, (n,)."""
    return np.random.default_rng(0).standard_normal(n)


def _gershgorin(matrix: csr_array) -> np.ndarray:
    """Sums of absolute values by row, the largest of which no eigenvalue exceeds, (n,)."""
    return np.asarray(abs(matrix).sum(axis=1)).ravel()


def _first_largest(values: np.ndarray, equal: float) -> int:
    """Index of the first of the largest values; round-off does not choose between equal ones."""
    return int(np.flatnonzero(values >= values.max() - equal * abs(values.max()))[0])
