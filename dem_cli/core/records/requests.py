"""Requests to the solvers, in numbers, names and arrays; independent of the format of the input."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from dem_cli.frozen_records import dataclass

if TYPE_CHECKING:
    import numpy as np

    from dem_cli.core.laws.stiffness import StiffJoint

DEFAULT_FRACTION = 0.35  # of critical; thesis 6.1: best for the restitution of blocks with h/b from 2 to 5
REACTIONS = ("reaction", "reaction_moment")  # quantities of monitors: of what holds blocks


class JointRequest(NamedTuple):
    """Joints between materials, and how blocks of these deform."""

    named: dict[str, StiffJoint]  # joints by name, the default one first
    by_material: np.ndarray  # number of the joint between two materials, (n_materials, n_materials) int64
    heads: np.ndarray  # number of the joint in the head joints of each; −1: nothing lies there, (n_named,) int64
    moduli: np.ndarray  # Young's and shear modulus of blocks that deform in their joints, else infinite [Pa], (n, 2)
    uniform: np.ndarray  # Young's modulus of blocks of uniform strain, else infinite [Pa], (n_materials,)
    bends: np.ndarray  # whether blocks of a material bend by themselves, (n_materials,) bool
    dimension: int
    seed: int  # from which friction and profiles are drawn


@dataclass(frozen=True)
class AnalysisRequest:
    """Request for an analysis: its kinematics, its limits, and its method."""

    kinematics: Literal["auto", "fixed", "large"]
    max_steps: int
    resolution: float | None = None  # width of the bracket over the answer [-]; None: nothing is searched for
    tilting: bool = False  # whether the load is a table that tilts
    searches: bool = False  # whether a failure load is sought under a load that grows
    start: Literal["auto", "gravity", "path", "limit"] = "auto"  # how to come next to failure
    step: float | None = None  # largest step of the load [-]; None: steps grow


@dataclass(frozen=True)
class ShakingRequest(AnalysisRequest):
    """Request for a time history; all times in seconds."""

    margin: float = 0.25  # time step over the largest stable one [-]
    time_step: float | None = None  # [s]; None: by the margin
    free_step: bool = True  # whether neither time step nor margin is prescribed
    duration: float | None = None  # [s]; None: that of the motion
    settle: bool = True  # whether dead loads come to rest first
    fallen_deg: float = 60.0  # lean from which a block has collapsed [°]
    dropped: float | None = None  # sinking from which it has [m]; None: by its width
    coda: float | None = None  # how long it is followed after the motion [s]; None: by its height
    after_collapse: float = 0.5  # how long a collapse is followed [s]


@dataclass(frozen=True)
class RayleighRequest:
    """Request for Rayleigh damping in proportion to mass and stiffness, c = a0 m + a1 k."""

    ratio: float  # of critical [-]
    mass: float  # a0 [1/s]
    stiffness: float  # a1 [s]
    two_frequencies: bool = False  # whether the ratio holds at two frequencies, which needs both parts


class MaxwellRequest(NamedTuple):
    """Request for a Maxwell element: a spring and a dashpot in series beside each spring of a joint."""

    ratio: float  # damping ratio at its frequency [-]
    frequency: float  # where it damps most [Hz]


@dataclass(frozen=True)
class DampingRequest:
    """Request for damping of joints and blocks in a time history, beside friction; 0: none."""

    contact_fraction: float = 0.0  # dashpots of joints, of critical [-]
    restitution: float | Literal["housner"] | None = None  # angular velocity after over before a landing [-]
    block: str | None = None  # whose frequency or restitution is meant; None: each joint, or the heaviest block
    rayleigh: RayleighRequest | None = None
    stiffness: float = 0.0  # damping over stiffness of all joints [s]
    mass: float = 0.0  # damping force over mass and velocity [1/s]
    maxwell: tuple[MaxwellRequest, ...] = ()
    local: float = 0.0  # share of the unbalanced force against the motion [-]


@dataclass(frozen=True)
class InitialRequest:
    """Blocks that start a time history tilted, displaced or moving, as one."""

    names: tuple[str, ...]  # ids, aliases or selections that the model knows
    turn: tuple[float, ...]  # about the corner on which they then stand: angle, in space axis times angle [rad]
    displacement: tuple[float, ...]  # [m]
    velocity: tuple[float, ...]  # of each centroid [m/s], and spins [rad/s]


@dataclass(frozen=True)
class MonitorRequest:
    """Request for a monitor, followed through a run; one of link, selected, between, point and cut says where."""

    quantity: str  # one of history_rows.MONITOR_UNITS
    component: str | None = None  # "x", "y" or "z"; None: the length of the vector
    absolute: bool = False  # whether with the motion of the base
    link: str | None = None  # name of a tie or a bar
    at: float = 0.0  # how far along a bar [m]
    selected: str | None = None  # blocks, by a name that the model knows
    between: tuple[str, str] | None = None  # two blocks that share a joint
    point: tuple[float, ...] | None = None  # a material point, where it is drawn [m]
    cut: tuple[tuple[float, ...], ...] | None = None  # ends of a line, in space corners of a rectangle [m]
    height: float | None = None  # of a pier above its cut, for a drift [m]

    @property
    def of_what_holds(self) -> bool:
        """Test whether it follows reactions of fixed or restrained blocks."""
        return self.quantity in REACTIONS


@dataclass(frozen=True)
class SolverRequest:
    """Request for a run: all but its model and the ground motion."""

    joints: JointRequest
    analysis: AnalysisRequest
    gravity: float = 9.81  # [m/s²]
    imperfect: bool = False  # whether blocks have errors, which leave gaps that may close
    damping: DampingRequest = DampingRequest()
    initial: tuple[InitialRequest, ...] = ()
    monitors: tuple[MonitorRequest, ...] = ()
    snapshots: int = 20  # frames kept where the analysis does not know better
    frames: int | None = None  # frames of a time history; None: as many as show the motion
    rate: float = 200.0  # samples of the monitors of a time history [1/s]

    @property
    def in_seconds(self) -> bool:
        """Test whether the analysis is a time history."""
        return isinstance(self.analysis, ShakingRequest)

    @property
    def shaking(self) -> ShakingRequest:
        """Return the request for a time history, which the analysis must be."""
        assert isinstance(self.analysis, ShakingRequest)
        return self.analysis
