"""Limit analysis of a model: from its geometry at the start to failure loads and their bounds."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.core.contact.gaps import gap_words, gaps_of_start
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.joints import JointProperties, only_points
from dem_cli.core.contact.start import TOUCHING_GAP, bodies_at_rest, joints_of_start
from dem_cli.core.laws.law import Law
from dem_cli.core.limit.associated import FALLS, LOCKED, OK, LimitLoad, associated_limit, slides, work_of_friction
from dem_cli.core.limit.cone import envelope_of, friction_of, steep
from dem_cli.core.limit.matrices import LimitStructure, structure_of
from dem_cli.core.limit.settings import DEFAULT_LIMIT, LimitSettings
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import largest_structure, smallest_edge
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.core.kernels.records import Bodies, Joints
    from dem_cli.core.laws.envelope import Envelope
    from dem_cli.core.limit.least import LeastLoad
    from dem_cli.core.limit.path import Path
    from dem_cli.core.limit.reduced import LowerBound

Progress = Callable[[float, float], None]
ROUNDED = 1e-9  # of the widest gap that closes: round-off of where it is measured again
LOWER, LEAST = "lower", "least"  # bounds of joints that do not dilate, which are computed on request
BOUNDED = (2,)  # dimensions in which these are known
SETTLED = (2,)  # dimensions in which LOCKED leaves no question: out of plane joints may lock because they dilate


class LimitLoads(NamedTuple):
    """Failure loads of one structure by limit analysis."""

    structure: LimitStructure
    friction: np.ndarray  # coefficient of every point [-], (n_points,)
    associated: LimitLoad  # joints dilate as they slide: an upper bound
    non_associated: Path | None  # joints do not; None where not requested, or where the first answer leaves no question
    seconds: float  # wall time of the associated load, with detection and matrices
    path_seconds: float | None  # of the non-associated load
    no_path: str | None = None  # why there is no non-associated load, where the joints are not of the kind
    lower: LowerBound | None = None  # below it nothing collapses; None where not requested
    least: LeastLoad | None = None  # of joints that do not dilate; None where not requested

    @property
    def in_space(self) -> bool:
        """Test whether joints slide in more than one direction, so that walls may fail out of their plane."""
        return self.associated.shear.shape[1] > 1

    @property
    def head_friction(self) -> float | None:
        """Return the share of the load that friction of head joints dissipates in the associated mechanism; None
        without a load.

        There they dilate and wedge, as no real joint does: of walls that fail out of their plane the bound says little.
        """
        found, structure = self.associated, self.structure
        if not found.multiplier:
            return None
        taken = work_of_friction(structure, self.friction, found)[steep(structure.joints)].sum()
        return float(taken / abs(found.multiplier))

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json under `limit_analysis`."""
        found, ok = self.associated, self.associated.status == OK
        said = {
            "associated": found.multiplier if ok else None,
            "associated_bounds": [found.lower, found.upper] if ok else None,
            "associated_status": found.status,
            "residual": found.residual,
            "gap": found.gap,
            "iterations": found.iterations,
            "seconds": self.seconds,
        }
        if self.in_space:
            said["associated_head_friction"] = self.head_friction
        for more in (self.lower, self.least):
            said |= more.summary() if more is not None else {}
        path = self.non_associated
        if path is None:
            return said | ({} if self.no_path is None else {"non_associated_status": self.no_path})
        of_path = path.summary()
        load = of_path.pop("load")
        said["non_associated"] = load if path.status == OK else None
        if path.status != OK and load is not None:
            said["non_associated_at_least"] = load  # every state of the path is in equilibrium
        said |= {f"non_associated_{key}": value for key, value in of_path.items()}
        return said | {"non_associated_seconds": self.path_seconds}


def limit_loads(
    model: Model,
    properties: JointProperties,
    law: Law,
    heads_frictionless: bool = False,
    associated_only: bool = False,
    bounds: Collection[str] = (),
    progress: Progress = lambda load, reached: None,
    settings: LimitSettings = DEFAULT_LIMIT,
) -> LimitLoads:
    """Limit analysis of the faces that touch at the start; the multiplier is that of model.live_loads.

    heads_frictionless  no friction in joints steeper than 45° to the horizontal (thesis Table 5-3)
    associated_only     leave out the load of joints that do not dilate, which takes longer
    bounds              LOWER, LEAST or both, which take longer still
    progress            called with the load and the displacement of every increment of the path (limit.path)

    Raises UsageError without live loads, where the strength of the law is not held by straight lines, or where bounds
    are not known in so many dimensions.
    """
    begun = time.perf_counter()
    _require_known(model, bounds)
    near = TOUCHING_GAP if settings.touching is None else settings.touching
    structure = start_structure(model, properties, law, near=near)
    strength = envelope_of(structure.joints, law, heads_frictionless, bonds=structure.bonds)
    associated = associated_limit(structure, strength, settings.associated)
    found = LimitLoads(structure, strength.friction, associated, None, time.perf_counter() - begun, None)
    try:
        friction = friction_of(structure.joints, law, heads_frictionless)
    except UsageError:
        friction = None
        if not associated_only:
            found = found._replace(no_path=f"not looked for: the path knows friction alone, and law '{law.name}' more")
    if associated.status == FALLS:
        return found
    settled = associated.status == LOCKED and model.dimension in SETTLED
    if not (associated_only or settled or friction is None) and structure.dead.any():
        begun = time.perf_counter()
        path = _path(structure, friction, associated, progress, settings)
        found = found._replace(non_associated=path, path_seconds=time.perf_counter() - begun)
    left = envelope_of(structure.joints, law, heads_frictionless, residual=True, bonds=structure.bonds)
    return _with_bounds(found, strength, left, bounds, settings)


def with_path(found: LimitLoads, settings: LimitSettings) -> LimitLoads:
    """Add the failure load of joints that do not dilate, where sliding in the associated mechanism may make it
    another.

    Unchanged where the path does not apply: strength beside friction, no dead loads, or too many blocks for it.
    """
    structure, associated = found.structure, found.associated
    blocks, dimension = largest_structure(structure.joints.blocks, structure.model.fixed), structure.model.dimension
    if associated.upper is None or not structure.dead.any() or settings.too_large(blocks, dimension):
        return found
    if not slides(structure, found.friction, associated, settings.associated):
        return found
    begun = time.perf_counter()
    path = _path(structure, found.friction, associated, lambda load, reached: None, settings)
    return found._replace(non_associated=path, path_seconds=time.perf_counter() - begun)


def _require_known(model: Model, bounds: Collection[str]) -> None:
    """Bounds of joints that do not dilate have one shear force per joint: in space its points slide each their way."""
    if bounds and (model.dimension not in BOUNDED or model.links):
        asked = " and ".join(f"--{name}" for name in sorted(bounds, reverse=True))
        known = "in 2D only" if model.dimension not in BOUNDED else "without ties and bars only"
        raise UsageError(f"{asked}: bounds of joints that do not dilate are known {known}; leave it out here")


def _path(
    structure: LimitStructure, friction: np.ndarray, associated: LimitLoad, progress: Progress, settings: LimitSettings
) -> Path:
    """Trace the path to the failure load of joints that do not dilate.

    Where nothing slides in the mechanism of the associated load, joints that do not dilate may carry it as well: a
    plateau below it may be a rest on the way, and the load is followed on. One that is a failure stays.
    """
    from dem_cli.core.limit.path import trace  # with SciPy's solvers

    blocks = largest_structure(structure.joints.blocks, structure.model.fixed)
    settings = settings.of_path(blocks, structure.model.dimension)
    path, lowest = trace(structure, friction, progress=progress, settings=settings), associated.lower
    if path.load is None or lowest is None or slides(structure, friction, associated, settings.associated):
        return path
    if path.finished and path.load < lowest - settings.path.plateau * abs(lowest):
        return trace(structure, friction, settings.path.finer, progress=progress, settings=settings)
    return path


def _with_bounds(
    found: LimitLoads, strength: Envelope, left: Envelope, bounds: Collection[str], settings: LimitSettings
) -> LimitLoads:
    """Add the lower bound and the least load of joints that do not dilate, as `bounds` names them.

    left: of the strength, after sliding and opening for long.
    """
    upper = np.inf if found.associated.upper is None else found.associated.upper
    if LOWER in bounds:
        from dem_cli.core.limit.reduced import lower_bound

        found = found._replace(lower=lower_bound(found.structure, strength, left, upper, settings.reduced))
    if LEAST in bounds:
        from dem_cli.core.limit.least import least_load

        if not all(np.array_equal(whole, part) for whole, part in zip(strength, left, strict=True)):
            raise UsageError(
                "the least load (--least) is that of joints whose strength stays, and that of the joints here falls as "
                "they slide or open; give them residual strengths as high as the others, or leave --least out"
            )
        found = found._replace(least=least_load(found.structure, strength, upper, found.non_associated, settings.least))
    return found


def require_scalable(model: Model, properties: JointProperties, law: Law) -> None:
    """Raises UsageError where the load of a tilting table is not that of a push: less weight on joints with strength.

    Dead loads fall with the cosine of its angle, and so does the strength of joints with friction alone.
    """
    structure = start_structure(model, properties, law)
    strength = envelope_of(structure.joints, law, bonds=structure.bonds)
    if strength.cohesion.any() or strength.tension.any() or np.isfinite(strength.compression).any():
        raise UsageError(
            f"limit analysis keeps the dead loads, and those of a tilting table fall: strengths of law '{law.name}' "
            "would count for too little; use analysis.pattern = 'mass'"
        )
    if structure.links:
        raise UsageError(
            "limit analysis keeps the dead loads, and those of a tilting table fall: largest forces of ties and bars "
            "would count for too little; use analysis.pattern = 'mass'"
        )


def taken_as_plane(properties: JointProperties) -> str | None:
    """Return the warning that limit analysis ignores the profile of joints; None where no joint has one."""
    rough = [
        f"'{name}'"
        for name, layout in zip(properties.names, properties.layouts, strict=True)
        if layout is not None and layout.sides is not None
    ]
    return f"limit analysis takes joint {', '.join(rough)} as plane: it knows no profile" if rough else None


def gaps_left_open(model: Model) -> str | None:
    """Return the warning about gaps of the start, which rigid blocks at rest do not close; None where there are
    none."""
    gaps = gaps_of_start(model)
    return f"limit analysis closes no gaps: {gap_words(model, gaps)}" if len(gaps.widths) else None


def closing_gaps(model: Model) -> tuple[float, str] | None:
    """Return the widest gap that closes like a joint [smallest edges], and the warning about it; None without such
    gaps.

    For structures that nothing carries while they are open, such as tiers drawn one above the other to a few digits.
    """
    gaps = gaps_of_start(model)
    gaps = gaps.where(gaps.close & (gaps.widths > 0.0))
    if not len(gaps.widths):
        return None
    near = float(gaps.widths.max()) / smallest_edge(model) * (1.0 + ROUNDED)
    return near, f"limit analysis takes as closed {gap_words(model, gaps)}: open, they leave dead loads without support"


def start_structure(
    model: Model,
    properties: JointProperties,
    law: Law | None = None,
    bodies: Bodies | None = None,
    near: float = TOUCHING_GAP,
) -> LimitStructure:
    """Build the limit analysis structure from the joints at the start, all plane, or from blocks that have moved.

    Points at their ends are enough for joints with friction alone; where tension, cohesion or crushing of the `law` are
    shared among points, these are those of the DEM joint, so that both are the same joint. Points that are open carry
    nothing: where only a corner touches a face, the other end is far from anything.

    bodies: where the blocks are, the links of the model being those of their simulation; None: where they start.
    near: gap or overlap of faces that touch, in smallest edges.
    """
    shared = law is not None and law.bonded
    plane = (layout if shared and layout and layout.sides is None else None for layout in properties.layouts)
    properties = properties._replace(layouts=tuple(plane))
    places = bodies_at_rest(model) if bodies is None else bodies
    built = joints_of_start(model, places, properties, smallest_edge(model), near=near)
    closed = built.contacts.gaps <= 0.0
    bonds = geometry_of(model.dimension).bonds(model, built.geometry)[built.joints.owners]
    return structure_of(model, only_points(built.joints, closed), bonds[closed], bodies)


def load_where_it_rests(
    model: Model,
    properties: JointProperties,
    law: Law,
    bodies: Bodies,
    touch: tuple[float, float],
    settings: LimitSettings = DEFAULT_LIMIT,
) -> LimitLoad:
    """Compute the associated failure load of blocks that have moved, on joints found where the blocks now are.

    model: with the loads that act there; bodies: as for `start_structure`; touch: gaps or overlaps of faces that touch
    in any case, and at most [m]. Blocks that have turned touch with corners: faces touch up to the smallest gap with
    which they carry the dead loads. Raises UsageError as `limit_loads`.
    """
    for near in gaps_that_touch(model, touch):
        structure = start_structure(model, properties, law, bodies, near)
        strength = envelope_of(structure.joints, law, bonds=structure.bonds)
        found = associated_limit(structure, strength, settings.associated)
        if found.upper is not None:
            break
    return found


def gaps_that_touch(model: Model, touch: tuple[float, float]) -> Iterator[float]:
    """Gaps or overlaps up to which faces touch, one after the other ten times as wide, in smallest edges.

    touch: the first and the last of them [m].
    """
    smallest = smallest_edge(model)
    near, most = (max(TOUCHING_GAP, reach / smallest) for reach in touch)
    yield near
    while near < most:
        near = min(10.0 * near, most)
        yield near


def load_of_points(
    model: Model, joints: Joints, closed: np.ndarray, law: Law, settings: LimitSettings = DEFAULT_LIMIT
) -> LimitLoad:
    """Compute the associated load with some contact points of the start; closed: points that carry, (n_points,)
    bool."""
    among = only_points(joints, closed)
    return associated_limit(structure_of(model, among), envelope_of(among, law), settings.associated)
