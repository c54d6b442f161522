"""Create the ground motions of a case from its [motion] tables."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from dem_cli.case.base import Vector
from dem_cli.case.tables.base_motion import (
    ArtificialTable,
    HarmonicTable,
    MotionTable,
    NoMotion,
    PulseTable,
    RecordTable,
)
from dem_cli.core.motion import pulses
from dem_cli.core.motion.motion import Motion, Waveform, moving_at_the_end
from dem_cli.core.motion.record import Accelerogram, record
from dem_cli.core.motion.record_file import read_series
from dem_cli.core.motion.record_text import RecordError
from dem_cli.core.motion.units import SI_FACTORS, STANDARD_GRAVITY
from dem_cli.errors import CaseError, CaseProblem
from dem_cli.input_limits import LONGEST, STRONGEST_MOTION

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

STRONGEST, WEAKEST = 10.0, 1e-4  # g: beyond these a record most likely has another unit
FAINTEST = 1e-30  # m/s2: the factor that scales a fainter record to its `peak` overflows
NOTHING = 1e-9  # of the peak of a record: what a baseline leaves of it is round-off
LIKELY = (0.005, 3.0)  # g: peaks of a unit that is proposed instead


def motions_of(case: Case) -> list[Motion]:
    """Create the ground motions of a case, one for each [[motion]] except kind "none"; of a suite the record `number`.

    Motions of the same block add up. Raises CaseError on a record that cannot be used.
    """
    return [
        suite[table.number - 1 if isinstance(table, ArtificialTable) else 0]
        for table, suite in zip(_moving(case), suites_of(case))
    ]


def suites_of(case: Case) -> list[list[Motion]]:
    """Create all records of each [[motion]] except kind "none": one, or `count` of an artificial suite.

    Raises CaseError on a record that cannot be used.
    """
    return [_suite(table, i, case.seed) for i, table in enumerate(case.motion) if not isinstance(table, NoMotion)]


def check(case: Case) -> list[CaseProblem]:
    """Read every ground motion record and return warnings about it. Raises CaseError on one that cannot be used."""
    found = []
    for i, table in enumerate(case.motion):
        if isinstance(table, PulseTable) and (length := _pulse(table).duration) > LONGEST:
            raise CaseError([CaseProblem(("motion", i), f"lasts {length:.3g} s; at most {LONGEST:g} s are shaken")])
        if isinstance(table, RecordTable):
            for motion in _suite(table, i, case.seed):
                found += [CaseProblem(("motion", i, "file"), warning) for warning in motion.warnings]
    return found


def _moving(case: Case) -> list[MotionTable]:
    return [table for table in case.motion if not isinstance(table, NoMotion)]


def _suite(table: MotionTable, i_table: int, seed: int) -> list[Motion]:
    """Create the records of one [motion] table with direction, blocks and start."""
    factor, titles, shapes = 1.0, [""], list[Waveform]()
    if isinstance(table, PulseTable):
        shapes, titles = [_pulse(table)], [table.shape]
    elif isinstance(table, HarmonicTable):
        shapes, titles = [_harmonic(table)], [f"{table.frequency:g} Hz"]
    elif isinstance(table, RecordTable):
        shapes, titles = [_record(table, i_table)], [Path(table.file).stem]
        factor = table.peak / shapes[0].peak if table.peak is not None else table.scale or 1.0
    elif isinstance(table, ArtificialTable):
        from dem_cli.core.motion.synthetic import suite

        shapes = [*suite(table.asked, seed if table.seed is None else table.seed, i_table)]
        titles, factor = [f"artificial {k}" for k in range(1, table.count + 1)], table.scale
    along = _unit(table.direction)
    motions = [Motion(shape, along, table.blocks, table.start, factor, title) for shape, title in zip(shapes, titles)]
    strongest = max(motion.peak for motion in motions)
    if not strongest <= STRONGEST_MOTION:
        message = f"a peak acceleration of {strongest:.3g} m/s2 is not allowed; at most {STRONGEST_MOTION:g} m/s2"
        raise CaseError([CaseProblem(("motion", i_table), message)])
    return [_with_warnings(motions[0], table)] if isinstance(table, RecordTable) else motions


def _with_warnings(motion: Motion, table: RecordTable) -> Motion:
    """Add warnings to a record that begins at another time than 0 or leaves the base moving."""
    assert isinstance(motion.shape, Accelerogram)
    warnings = [shifted(motion.shape, table.start)]
    peak = motion.peak / STANDARD_GRAVITY
    if table.unit and table.scale is None and table.peak is None and not LIKELY[0] <= peak <= LIKELY[1]:
        warnings.append(f"{odd_peak(table.quantity, table.unit, peak)}; scale = 1.0 says that it is meant")
    if moving := moving_at_the_end(motion):
        warnings.append(moving + ("; baseline = true, or 2, may take a drift out" if table.baseline is False else ""))
    return replace(motion, warnings=tuple(filter(None, warnings)))


def shifted(shape: Accelerogram, start: float) -> str:
    """Return a remark about a record that begins at another time than 0 by more than a step; empty otherwise."""
    if abs(shape.first) <= 1.5 * shape.step:  # many begin at 0, or a step later
        return ""
    keeps = f"; start = {shape.first:g} keeps the times of the file" if shape.first > 0.0 and start == 0.0 else ""
    return f"begins at {shape.first:g} s in the file, and here at {start:g} s{keeps}"


def _unit(direction: Vector) -> Vector:
    length = math.hypot(*direction)
    return tuple(x / length for x in direction)


def _pulse(table: PulseTable) -> Waveform:
    if table.shape == "impulse":
        assert table.duration is not None
        return pulses.impulse(table.amplitude, table.duration, table.rebound)
    assert table.frequency is not None
    if table.shape == "ricker":
        return pulses.RickerWavelet(table.amplitude, table.frequency)
    cycles = 0.5 if table.shape == "half-sine" else 1.0
    phase = 0.5 * math.pi if table.shape == "cosine" else 0.0
    return pulses.SineWave(table.amplitude, table.frequency, cycles / table.frequency, phase)


def _harmonic(table: HarmonicTable) -> Waveform:
    ramp = min(table.ramp / table.frequency, 0.5 * table.length)
    return pulses.SineWave(table.amplitude, table.frequency, table.length, math.radians(table.phase_deg), ramp)


def _record(table: RecordTable, i_table: int) -> Accelerogram:
    """Read, convert and correct a record, leaving `scale` and `peak` to the motion. Raises CaseError."""
    try:
        series = read_series(Path(table.file), table.step, table.column, table.uneven)
    except RecordError as error:
        raise CaseError([CaseProblem(("motion", i_table, "file"), str(error))]) from None
    unit = _unit_of(table, series.quantity, series.unit, i_table)
    values = SI_FACTORS[table.quantity][unit] * series.values
    try:
        made = record(series.times, values, table.quantity, table.baseline_order)
    except RecordError as error:
        message = f"{str(table.baseline).lower()} is not allowed for {Path(table.file).name}: {error}"
        raise CaseError([CaseProblem(("motion", i_table, "baseline"), message)]) from None
    if table.baseline_order is not None and made.peak <= NOTHING * record(series.times, values, table.quantity).peak:
        message = f"takes out the whole motion of {Path(table.file).name}; leave it out, or take a lower order"
        raise CaseError([CaseProblem(("motion", i_table, "baseline"), message)])
    if made.peak == 0.0:
        message = f"{Path(table.file).name}: no motion, every {table.quantity} is the same"
        raise CaseError([CaseProblem(("motion", i_table, "file"), message)])
    if made.peak < FAINTEST:
        message = f"{Path(table.file).name}: a peak acceleration of {made.peak:.3g} m/s2 is not allowed; at least "
        raise CaseError([CaseProblem(("motion", i_table, "file"), f"{message}{FAINTEST:g} m/s2")])
    _check_peak(table, unit, made.peak / STANDARD_GRAVITY, i_table)
    return made


def _unit_of(table: RecordTable, quantity: str | None, unit: str | None, i_table: int) -> str:
    """Return the unit of a record from the case or the file. Raises CaseError where they disagree or give none."""
    name, allowed = Path(table.file).name, ", ".join(f"'{unit}'" for unit in SI_FACTORS[table.quantity])
    if quantity is not None and quantity != table.quantity:
        message = f"'{table.quantity}' is not allowed; {name} says that it holds {quantity}"
        raise CaseError([CaseProblem(("motion", i_table, "quantity"), message)])
    if (found := table.unit or unit) is None:
        message = f"missing; {name} does not say what its values are in (allowed: {allowed})"
        raise CaseError([CaseProblem(("motion", i_table, "unit"), message)])
    factors = SI_FACTORS[table.quantity]
    if table.unit is not None and unit is not None and factors[table.unit] != factors[unit]:
        message = f"'{table.unit}' is not allowed; {name} says that its values are in {unit}"
        raise CaseError([CaseProblem(("motion", i_table, "unit"), message)])
    return found


def _check_peak(table: RecordTable, unit: str, peak: float, i_table: int) -> None:
    """Raise CaseError where the peak [g] is implausible for an earthquake and neither scale nor peak is given."""
    if table.scale is not None or table.peak is not None or WEAKEST <= peak <= STRONGEST:
        return
    message = f"{odd_peak(table.quantity, unit, peak)}; if it is meant, add scale = 1.0"
    raise CaseError([CaseProblem(("motion", i_table, "unit"), message)])


def odd_peak(quantity: str, unit: str, peak: float) -> str:
    """Return a message about an implausible peak acceleration [g] and the units in which it would be plausible."""
    factors = SI_FACTORS[quantity]
    others = {other: peak * factor / factors[unit] for other, factor in factors.items()}
    likely = [f"'{other}' would give {g:.3g} g" for other, g in others.items() if LIKELY[0] <= g <= LIKELY[1]]
    return f"'{unit}' gives a peak acceleration of {peak:.3g} g" + (f"; {' and '.join(likely)}" if likely else "")
