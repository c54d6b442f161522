"""Types of the keys of summary.json that reports, pictures and answers are made of.

Keys that are not named here may hold anything. What a table names without a default is missing where it is not there;
`TOGETHER` names what comes along with a key that has a value, `AS_LONG` lists that are as long as another.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

LARGEST = float(np.finfo(np.float32).max)  # pictures and reports have single precision
Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]
Count = Annotated[int, Field(strict=True, ge=0)]
Maybe = Number | None
Pair = Annotated[list[Maybe], Field(min_length=2, max_length=2)]
Range = Annotated[list[Number], Field(min_length=2, max_length=2)]


class SummaryTable(BaseModel):
    """Table of a summary."""

    model_config = ConfigDict(extra="allow", strict=True, defer_build=True)
    TOGETHER: ClassVar[dict[str, tuple[str, ...]]] = {}
    AS_LONG: ClassVar[dict[str, tuple[str, ...]]] = {}  # lists with an entry for each of a list, or tables of such


class FoundPeak(SummaryTable):
    """Table peaks.NAME of a summary."""

    peak: Maybe
    residual: Maybe
    time: Maybe
    unit: str
    during_motion: Maybe = None
    during_motion_time: Maybe = None


class FoundMotion(SummaryTable):
    """Table moved_far of a summary."""

    block: str
    distance: Number


class FoundAbove(SummaryTable):
    """Table above_the_bound of a summary."""

    bound: Number
    displacement: Number
    bound_where_it_rests: Maybe
    explained: bool


class FoundMovedBound(SummaryTable):
    """Table bound_where_it_rests of a summary."""

    bound: Number
    displacement: Number


class FoundValue(SummaryTable):
    """Table monitors.NAME of a summary."""

    value: Maybe = None
    unit: str | None = None


class FoundSpread(SummaryTable):
    """Table repeats.peaks.NAME of a summary."""

    median: Number
    p16: Number
    p84: Number
    min: Number
    max: Number
    unit: str


class FoundRepeats(SummaryTable):
    """Table repeats of a summary, of a time history or of a fragility study."""

    peaks: dict[str, FoundSpread | None] | None = None
    runs: Count | None = None
    collapsed: Count | None = None
    still_moving: Count | None = None
    dispersion: dict[str, Number] | None = None
    collapse_intensities: list[list[Maybe]] | None = None


class FoundTurn(SummaryTable):
    """Table turning_points.N of a summary."""

    load: Number
    displacement: Number
    live_displacement: Number = 0.0
    controlled: Number = 0.0


class FoundLoad(SummaryTable):
    """Table capacity_curve.loads_at.N of a summary."""

    load: Maybe
    displacement: Number


class FoundSystem(SummaryTable):
    """Table capacity_curve.bilinear of a summary."""

    drop: Number
    ductility: Number
    softened: bool
    ultimate_displacement: Number
    yield_displacement: Number
    yield_load: Number


class FoundCurve(SummaryTable):
    """Table capacity_curve of a summary."""

    AS_LONG = {"displacements": ("loads",)}
    displacements: list[Number]
    loads: list[Number]
    last_displacement: Number
    last_load: Number
    peak_displacement: Number
    peak_load: Number
    loads_at: list[FoundLoad] | None = None
    bilinear: FoundSystem | None = None
    residual_share: Maybe = None
    of: str | None = None


class FoundCheck(SummaryTable):
    """Table check of a summary: capacity against a response spectrum."""

    method: str
    period: Number
    target_displacement: Number
    displacement_capacity: Number
    demand_over_capacity: Number
    ground_acceleration_at_capacity: Number
    force_ratio: Number = 0.0
    activation_acceleration: Number = 0.0
    required_acceleration: Number = 0.0
    linear_demand_over_capacity: Number = 0.0


class FoundLoop(SummaryTable):
    """Table loops.N of a summary."""

    energy: Number
    damping: Number
    filled: Number = 0.0
    residual: Maybe = None


class FoundLimits(SummaryTable):
    """Table limit_analysis of a summary."""

    associated: Maybe = None
    associated_back: Maybe = None
    associated_bounds: Range | None = None
    associated_status: str | None = None
    associated_head_friction: Maybe = None
    non_associated: Maybe = None
    non_associated_residual: Maybe = None
    non_associated_at_least: Maybe = None
    least: Maybe = None
    lower_bound: Maybe = None
    seconds: Number = 0.0
    heads: str = ""
    impossible_at: Maybe = None
    carried_at: Maybe = None
    note: str = ""


class FoundCount(SummaryTable):
    """Number of blocks with the names of the first, in a summary."""

    count: Count
    first: list[Any]


class FoundReference(SummaryTable):
    """Table reference of a summary, or one of several."""

    AS_LONG = {"displacements": ("value",)}
    value: Number | bool | str | list[Number]
    tolerance: Maybe
    passed: bool
    found: Number | bool | str | list[Number] | None = None
    quantity: str = ""
    kind: str = ""
    missed: str = ""
    problem: str = ""
    displacements: list[Number] | None = None
    mean_error: Maybe = None
    largest_error: Maybe = None


class FoundRun(SummaryTable):
    """Table runs.N of a summary of a safety analysis."""

    value: Number
    stands: bool | None
    displacement: Maybe = None
    why: str = ""


class FoundFragility(SummaryTable):
    """Table curve of a summary of a fragility study."""

    AS_LONG = {"intensity": ("share", "low", "high")}
    intensity: Annotated[list[Number], Field(min_length=2)]
    share: list[Maybe]
    low: list[Maybe] | None = None
    high: list[Maybe] | None = None


class FoundConfidence(SummaryTable):
    """Table confidence of a summary of a fragility study."""

    level: Number
    median: Range
    dispersion: Range


class FoundGap(SummaryTable):
    """Table non_monotone.N of a summary of a fragility study."""

    record: str
    structure: Count
    collapsed: Number
    survived: list[Number]


class FoundReach(SummaryTable):
    """Table reached of a summary of an interrupted run."""

    stage: str
    load: Number = 0.0
    displacement: Number
    time: Number = 0.0


class FoundHistory(SummaryTable):
    """Table histories.N of a summary of a search for a failure load."""

    finished: bool


class FoundStart(SummaryTable):
    """Table start of a summary of a search for a failure load."""

    kind: str = ""
    load: Maybe = None
    seconds: Number = 0.0


class FoundReweighting(SummaryTable):
    """Table reweighting of a summary of a search in space."""

    net: Number
    sum: Number


class FoundSprings(SummaryTable):
    """Table springs of a summary of a modal analysis."""

    pressed: Count
    touching: Count


class FoundFirst(SummaryTable):
    """Table first_frequency of a summary of a modal analysis."""

    pressed: Maybe
    touching: Maybe


class FoundCollapse(SummaryTable):
    """Table settlement_at_collapse of a summary."""

    bracket: Range


class RunSummary(SummaryTable):
    """Complete summary.json."""

    TOGETHER = {
        "frequencies": ("total_mass", "effective_masses", "springs", "first_frequency"),
        "collapse_intensities": ("unit_acceleration", "stood_up_to", "non_monotone", "runs", "runs_done_before",
                                 "seconds"),
        "median": ("dispersion",),
        "safety_factor": ("vary",),
        "contacts": ("joints",),
    }  # fmt: skip
    AS_LONG = {"frequencies": ("effective_masses",), "levels": ("share",)}
    title: str
    kind: str
    status: str
    version: str = ""
    failure_load: Maybe = None
    failure_load_bracket: Pair | None = None
    failure_mode: str | None = None
    displacement_at_failure: Maybe = None
    equilibrium_load: Maybe = None
    onset_of_displacements: Maybe = None
    peak_of_curve: Maybe = None
    curve_off_the_load: bool | None = None
    curve_joint_stiffness: Maybe = None
    capacity_curve: FoundCurve | None = None
    check: FoundCheck | None = None
    highest_load: Maybe = None
    lowest_load: Maybe = None
    turning_points: list[FoundTurn] | None = None
    loops: list[FoundLoop] | None = None
    settlement_at_collapse: FoundCollapse | None = None
    reached: FoundReach | None = None
    histories: list[FoundHistory] | None = None
    start: FoundStart | None = None
    load_range: dict[str, Any] | None = None
    vary: str | None = None
    reduce: list[str] | None = None
    load: Maybe = None
    safety_factor: Maybe = None
    critical_value: Maybe = None
    stands_at: Maybe = None
    fails_at: Maybe = None
    strengths_needed: dict[str, dict[str, Number]] | None = None
    runs: list[FoundRun] | Count | None = None
    collapsed: bool | Count | None = None
    collapse_time: Maybe = None
    followed: Maybe = None
    ending: str | None = None
    at_rest: bool = True
    fallen_blocks: FoundCount | None = None
    peaks: dict[str, FoundPeak] | None = None
    monitors: dict[str, FoundValue] | None = None
    repeats: FoundRepeats | None = None
    energy_shares: dict[str, Number] | None = None
    impacts: Count | None = None
    peak_ground_acceleration: Maybe = None
    median: Maybe = None
    median_between: Pair | None = None
    dispersion: Maybe = None
    confidence: FoundConfidence | None = None
    curve: FoundFragility | None = None
    levels: list[Number] | None = None
    share: list[Maybe] | None = None
    unit_acceleration: Maybe = None
    collapse_intensities: list[Maybe] | None = None
    stood_up_to: list[Maybe] | None = None
    non_monotone: list[FoundGap] | None = None
    runs_done_before: Count | None = None
    seconds: Maybe = None
    frequencies: list[Number] | None = None
    highest_frequency: Maybe = None
    total_mass: Annotated[float, Field(strict=True, gt=0.0, le=LARGEST)] | None = None
    effective_masses: dict[str, list[Number]] | None = None
    springs: FoundSprings | None = None
    first_frequency: FoundFirst | None = None
    calibration: dict[str, Any] | None = None
    limit_analysis: FoundLimits | None = None
    reference: FoundReference | list[FoundReference] | None = None
    blocks: Count | None = None
    joints: Count | None = None
    contacts: Count | None = None
    steps: Count | None = None
    solve_seconds: Maybe = None
    solve_cpu_seconds: Maybe = None
    energy_closure: Maybe = None
    reweighting: FoundReweighting | None = None
    largest_overlap: Maybe = None
    largest_displacement: Maybe = None
    moved_far: FoundMotion | None = None
    no_bound: str | None = None
    certificates: str | None = None
    bound_where_it_rests: FoundMovedBound | None = None
    above_the_bound: FoundAbove | None = None
    unbalanced_force: Maybe = None
    warnings: list[str] | None = None
    contradictions: list[str] | None = None
    skipped: list[str] | None = None
