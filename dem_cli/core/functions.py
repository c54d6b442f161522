"""Functions for people who have arrays: joints, limit load, failure load, and the motion of a shaken structure.

Each takes a `Structure`; what they return are frozen records. docs/core.md shows them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.core.engine.job import Job
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.requests import (
    DEFAULT_FRACTION,
    AnalysisRequest,
    DampingRequest,
    InitialRequest,
    JointRequest,
    MonitorRequest,
    ShakingRequest,
    SolverRequest,
)

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.laws.stiffness import StiffJoint
    from dem_cli.core.limit.analysis import LimitLoads
    from dem_cli.core.model.model import Model
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.records.history_rows import Samples
    from dem_cli.core.structure import Structure

AXES = "xyz"
MOST_STEPS = 200_000_000  # at which a run gives up


class FailureAnswer(NamedTuple):
    """Failure load, reached from gravity by a load that grew."""

    status: str  # "ok": both ends of the bracket are proved
    low: float | None  # highest multiplier that was held at rest
    high: float | None  # lowest one at which failure is proved
    bound: float | None  # what limit analysis allows at most
    warnings: tuple[str, ...]
    simulation: Simulation  # as the search left it


class ShakenMotion(NamedTuple):
    """Motion of the blocks that are free, relative to the base, at even intervals."""

    status: str
    times: np.ndarray  # [s], (n,)
    displacements: np.ndarray  # of centroids, from where they were drawn [m], (n, n_free, d)
    rotations: np.ndarray  # in the plane counter-clockwise, in space about x, y and z [rad], (n, n_free, r)
    collapsed: bool
    ending: str  # how it ended, one of records/statuses.py
    warnings: tuple[str, ...]


def joints(law: str = "coulomb", **parameters: Any) -> StiffJoint:
    """Create joints between all blocks: a law of docs/laws by its name, and its parameters by theirs.

    Raises ValueError for a name that no law has, and with the key for a value that is not allowed.
    """
    from dem_cli.core.laws.registry import LAWS

    if law not in LAWS:
        raise ValueError(f"law: '{law}' is not allowed; must be one of {', '.join(map(repr, LAWS))}")
    return LAWS[law].parameters(**parameters)


def limit_load(
    structure: Structure, joint: StiffJoint, load: Sequence[float] | np.ndarray, settings: Settings = DEFAULT
) -> LimitLoads:
    """Compute the limit load of the faces that touch: `associated.upper` is what the structure cannot exceed.

    load: as `Structure.under` takes it. Where friction slides, `non_associated.load` is that of joints that do not
    dilate, by the path from gravity. Raises UsageError for laws that limit analysis does not know.
    """
    from dem_cli.core.limit.analysis import limit_loads

    request, model = _request(structure, joint, AnalysisRequest("fixed", 0)), structure.under(load)
    properties = joint_properties(request, model, settings.stiffness.statics)
    return limit_loads(model, properties, law_of(request), settings=settings.limit)


def failure_load(
    structure: Structure,
    joint: StiffJoint,
    load: Sequence[float] | np.ndarray,
    resolution: float = 1e-3,
    settings: Settings = DEFAULT,
) -> FailureAnswer:
    """Compute the load multiplier at which a structure fails: the explicit solver carries `low`, and fails at
    `high`.

    load: as `Structure.under` takes it; resolution: width of the bracket over the load.
    """
    from dem_cli.core.failure_search import failure_search
    from dem_cli.core.statics.agreement import doubts, load_range

    if not 0.0 < resolution < 1.0:
        raise ValueError(f"resolution: {resolution:g} is not allowed; must be between 0 and 1")
    asked = AnalysisRequest("auto", MOST_STEPS, resolution, searches=True)
    job = Job.start(_request(structure, joint, asked), structure.under(load), Observer(), settings)
    found, sim = failure_search(job)
    warnings = [*job.warnings, *doubts(found, resolution, load_range(found, resolution))]
    low = None if found.low is None or not found.found else float(found.low)
    return FailureAnswer(found.status, low, found.high, found.bound, tuple(dict.fromkeys(warnings)), sim)


def shake(
    structure: Structure,
    joint: StiffJoint,
    acceleration: np.ndarray | Sequence[Motion] = (),
    interval: float = 0.01,
    duration: float | None = None,
    tilt: Mapping[int, float | Sequence[float]] | None = None,
    damping: DampingRequest | None = None,
    rate: float = 200.0,
    settings: Settings = DEFAULT,
) -> ShakenMotion:
    """Compute the motion of a structure from rest, on a base that is shaken, or after blocks were tilted.

    acceleration  of the base, (n,) along x or (n, d), at even intervals [m/s²]; or motions of core/motion
    interval      between its values [s]
    duration      [s]; None: that of the base
    tilt          by which angle blocks stand tilted at the start, by their numbers [rad]; in space axis times angle
    damping       what landings and joints lose; None: dashpots of 0.35 of critical in the joints
    rate          rows a second of what is returned

    Raises ValueError where nothing says how long it lasts, SolverError where no rest under gravity is found.
    """
    from dem_cli.core.dynamics.ground import GroundMotion
    from dem_cli.core.dynamics.history import TimeHistory
    from dem_cli.core.dynamics.rocking_stiffness import rocking_stiffness

    model, motions = structure.model, _motions(acceleration, interval, structure.model.dimension)
    if duration is None and not motions:
        raise ValueError("duration: is missing, and there is no motion of the base that has one")
    if duration is not None and not 0.0 < duration < np.inf:
        raise ValueError(f"duration: {duration:g} is not allowed; must be positive and finite [s]")
    free = np.flatnonzero(~model.fixed)
    if not set(tilt or {}) <= set(free.tolist()):
        raise ValueError("tilt: numbers of blocks that are not fixed are wanted")
    request = _request(
        structure,
        joint,
        ShakingRequest("large", MOST_STEPS, duration=duration),
        damping=DampingRequest(DEFAULT_FRACTION) if damping is None else damping,
        initial=tuple(_tilted(model, block, turn) for block, turn in (tilt or {}).items()),
        monitors=tuple(one for block in free.tolist() for one in _followed(model, f"{block}")),
        snapshots=0,
        rate=rate,
    )
    observer = MotionKeeper()
    job = Job.start(request, model, observer, settings)
    job.settings = rocking_stiffness(request, model, settings).applied(settings)
    summary = TimeHistory(job, GroundMotion(motions, model)).run().summary
    times, values = observer.joined()
    d = model.dimension
    rows = values.reshape(len(times), len(free), model.rotations.stop)
    return ShakenMotion(
        summary["status"], times, rows[:, :, :d], rows[:, :, d:], bool(summary["collapsed"]), summary["ending"],
        tuple(summary["warnings"]),
    )  # fmt: skip


class MotionKeeper(Observer):
    """Observer that keeps the samples of a time history."""

    def __init__(self) -> None:
        self.stretches: list[Samples] = []

    def samples(self, samples: Samples) -> None:
        """Append one more stretch of samples."""
        self.stretches.append(samples)

    def joined(self) -> tuple[np.ndarray, np.ndarray]:
        """Join all stretches: times [s] (n,) and all values (n, n_monitors)."""
        parts = [(each.times, each.monitors) for each in self.stretches]
        times, values = zip(*parts, strict=True)
        return np.concatenate(times), np.concatenate(values)


def _request(structure: Structure, joint: StiffJoint, analysis: AnalysisRequest, **more: Any) -> SolverRequest:
    """Build the request to the solvers, where all joints are alike."""
    endless = np.full((1, 2), np.inf)
    of_joints = JointRequest(
        {"joint": joint}, np.zeros((1, 1), np.int64), np.zeros(1, np.int64), endless, endless[:, 0],
        np.zeros(1, bool), structure.model.dimension, 0,
    )  # fmt: skip
    return SolverRequest(of_joints, analysis, structure.gravity, **more)


def _motions(acceleration: np.ndarray | Sequence[Motion], interval: float, dimension: int) -> list[Motion]:
    """Build motions of the base along the axes, from samples at even intervals."""
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.motion.record import record

    if not isinstance(acceleration, np.ndarray):
        if not all(isinstance(one, Motion) for one in acceleration):
            raise ValueError("acceleration: an array of numbers, or a list of motions, is wanted")
        return list(acceleration)
    if not (0.0 < interval < np.inf and np.isfinite(acceleration).all()):
        raise ValueError("acceleration and interval: all numbers must be finite, and the interval positive [s]")
    columns = acceleration.reshape(len(acceleration), -1)
    if len(columns) < 2 or columns.shape[1] not in (1, dimension):
        raise ValueError(f"acceleration: an array (n,) or (n, {dimension}) is wanted, n at least 2")
    times, axes = interval * np.arange(len(columns)), np.eye(dimension)
    moving = [k for k in range(columns.shape[1]) if columns[:, k].any()]
    return [Motion(record(times, columns[:, k]), tuple(axes[k].tolist())) for k in moving]


def _tilted(model: Model, block: int, turn: float | Sequence[float]) -> InitialRequest:
    n_turns, none = model.rotations.stop - model.dimension, (0.0,)
    turns = tuple(np.atleast_1d(np.asarray(turn, float)).tolist())
    if len(turns) != n_turns:
        raise ValueError(f"tilt: {n_turns} number(s) are wanted for block {block}")
    return InitialRequest((f"{block}",), turns, none * model.dimension, none * model.rotations.stop)


def _followed(model: Model, block: str) -> list[MonitorRequest]:
    """List monitors of all motions of one block, in the order of its degrees of freedom."""
    d, names = model.dimension, AXES[: model.dimension]
    moves = [MonitorRequest("displacement", name, selected=block) for name in names]
    turning = [None] if d == 2 else list(names)
    return moves + [MonitorRequest("rotation", name, selected=block) for name in turning]
