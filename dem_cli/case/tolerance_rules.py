"""Tolerances of references that give none: one rule for each kind, whatever the case.

exact: what the analysis itself leaves open. A failure load is known to the width of its bracket,
`analysis.resolution`, and joints that are springs take half as much again; a safety factor or a critical value to the
width of its bracket; any other number, which springs and samples bound, to a thousandth. code: 5 %, as another
program has joints, damping and steps of its own. experiment: two standard deviations, `scatter`, of at least four
repeated tests, or the interval between them; of fewer 5 %, two standard deviations of the one wall that was tilted ten
times (thesis 7.5.3: 2.5 %): two tests say next to nothing of how much they scatter. bounded: the interval between two
bounds of mechanics, and nothing beyond. inference: as of a code. blind: the band of its prediction.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

ReferenceKind = Literal["exact", "bounded", "experiment", "code", "inference", "blind"]
KINDS: tuple[str, ...] = get_args(ReferenceKind)

OF_A_LOAD = 1.5  # resolutions of a pushover: the bracket, and half of it for joints that are springs
OF_A_FACTOR = 1.0  # resolutions of a safety analysis
FACTORS = ("safety_factor", "critical_value")
OF_OTHER_NUMBERS = 1e-3  # of an exact value, by springs and samples
OF_A_CODE = 0.05  # of what another program found, beyond the ends of its bracket
OF_ONE_TEST = 0.05  # of what was measured once: two standard deviations of thesis 7.5.3
DEVIATIONS = 2.0  # standard deviations of repeated tests that pass
ENOUGH = 4  # specimens from which on their scatter decides; below, that of thesis 7.5.3

RULES = {
    "exact": f"of a failure load {OF_A_LOAD:g} × the resolution of the analysis, of a safety factor or critical value "
    f"the resolution, of other numbers {100.0 * OF_OTHER_NUMBERS:g} %",
    "bounded": "the interval between two bounds of mechanics, and nothing beyond; it says less than a value does",
    "experiment": f"two standard deviations of {ENOUGH} or more repeated tests, or the interval between tests; of "
    f"fewer {100.0 * OF_ONE_TEST:g} %, with their scatter beside it",
    "code": f"{100.0 * OF_A_CODE:g} %, of a bracket beyond its ends",
    "inference": f"{100.0 * OF_A_CODE:g} %, which says no more than that the arithmetic was done",
    "blind": "the band of its prediction, written before anything was measured",
}


def kind_of(kind: str, interval: bool) -> str:
    """Return the kind of a reference: an exact one that is an interval is bounded."""
    return "bounded" if kind == "exact" and interval else kind


def allowance(
    kind: str, quantity: str, bounds: tuple[float, ...], scatter: float | None, specimens: int | None, resolution: Any
) -> float:
    """Return the default absolute tolerance of a reference value, in the unit of the quantity.

    bounds: the value, or both ends of an interval. scatter: a standard deviation, of experiments, and specimens, how
    many were tested; None counts as fewer than four. resolution: that of the analysis, a share of the answer; None
    where it has none.
    """
    size = max(map(abs, bounds))
    if kind in ("code", "inference"):
        return OF_A_CODE * size
    if kind == "experiment" and scatter is not None and (specimens or 0) >= ENOUGH:
        return DEVIATIONS * scatter
    if len(bounds) > 1:
        return 0.0
    return (OF_ONE_TEST if kind == "experiment" else _share(quantity, resolution)) * size


def _share(quantity: str, resolution: Any) -> float:
    """Return the relative tolerance of an exact reference value."""
    if quantity == "failure_load" and resolution is not None:
        return OF_A_LOAD * float(resolution)
    if quantity in FACTORS and resolution is not None:
        return OF_A_FACTOR * float(resolution)
    return OF_OTHER_NUMBERS
