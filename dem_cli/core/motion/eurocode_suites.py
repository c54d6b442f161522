"""Suites of artificial accelerograms by Eurocode 8: every clause of EN 1998-1:2004, 3.2.3.1.2 that numbers decide.

(3) the stationary part lasts 10 s at least, where no data of the site say otherwise; (4)a three accelerograms; (4)b the
mean of their accelerations at period zero is not below ag S; (4)c between 0.2 T1 and 2 T1 no value of their mean
spectrum for a damping of 5 % is below 90 % of the elastic spectrum for 5 %. Clause (2), agreement with magnitude and
source, is left to the user.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from dem_cli.core.motion.eurocode import TargetSpectrum
from dem_cli.core.motion.intensity_measures import LEAST_MEAN, fit
from dem_cli.core.motion.motion import Motion

FEWEST = 3  # (4)a
STATIONARY = 10.0  # s: (3)
DAMPING = 0.05  # (4)c: of both spectra


class Clause(NamedTuple):
    """Clause of EN 1998-1:2004, 3.2.3.1.2, and whether a suite meets it."""

    number: str  # "(4)b"
    met: bool | None  # None: cannot be judged
    found: str  # in words


def clauses(
    motions: Sequence[Motion],
    plateau: float,
    target: TargetSpectrum,
    elastic: TargetSpectrum | None,
    first_period: float | None = None,
) -> list[Clause]:
    """Check a suite of motions against each clause of EN 1998-1:2004, 3.2.3.1.2.

    plateau: how long they stay strong [s]; target: the spectrum that they were made for, as strong as they are;
    elastic: that for a damping of 5 %, None where it is not known; first_period: T1 of the structure [s].
    """
    few = f"{len(motions)} record{'s' * (len(motions) != 1)}, at least {FEWEST} are required"
    found = [
        Clause("(3)", plateau >= STATIONARY, f"strong for {plateau:g} s, {STATIONARY:g} s are required"),
        Clause("(4)a", len(motions) >= FEWEST, few),
    ]
    if elastic is None:
        mean = fit(motions, target, first_period).mean_peak
        unknown = f"the spectrum is for {100.0 * target.damping:g} %, that for {100.0 * DAMPING:g} % is not given"
        return [*found, _peaks(mean), Clause("(4)c", None, unknown)]
    compared = fit(motions, elastic, first_period)
    low, high = compared.periods[[0, -1]].tolist()
    least = f"the mean is {compared.least_mean:.3f} of the spectrum at least, {low:.3g} to {high:.3g} s, "
    least += f"{LEAST_MEAN:.2f} are required"
    return [*found, _peaks(compared.mean_peak), Clause("(4)c", compared.least_mean >= LEAST_MEAN, least)]


def _peaks(mean: float) -> Clause:
    return Clause("(4)b", mean >= 1.0 - 1e-9, f"mean peak {mean:.3f} of ag S, 1 is required")


def meets(found: Sequence[Clause]) -> bool | None:
    """Test whether a suite meets all clauses; None where that cannot be judged."""
    if any(clause.met is False for clause in found):
        return False
    return None if any(clause.met is None for clause in found) else True


def verdict(found: Sequence[Clause]) -> str:
    """Describe the clauses that are met, or what the others require."""
    numbers = ", ".join(clause.number for clause in found)
    if meets(found):
        return f"meets EN 1998-1 3.2.3.1.2 {numbers}"
    begins = "DOES NOT MEET" if meets(found) is False else "is not judged by all of"
    missed = "; ".join(f"{clause.number}: {clause.found}" for clause in found if not clause.met)
    return f"{begins} EN 1998-1 3.2.3.1.2 {numbers}: {missed}"
