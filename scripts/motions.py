"""Measures artificial accelerograms and the response spectrum; writes the tables of docs/motion.md and its pictures."""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
PAGE = ROOT / "docs" / "motion.md"
OF_SEVEN = 7


def main(words: Sequence[str] | None = None) -> int:
    """0 always."""
    parser = argparse.ArgumentParser(prog="scripts/motions", description=__doc__)
    parser.add_argument("--suites", type=int, default=8, help="suites of seven per ground type (8)")
    options = parser.parse_args(words)
    text = PAGE.read_text(encoding="utf-8")
    for name, table in (("suites", suites(options.suites)), ("spectrum", spectrum_errors())):
        mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        text = mark.sub(lambda found, table=table: found[1] + table + found[2], text)
    PAGE.write_text(text, encoding="utf-8")
    draw()
    return 0


def suites(count: int) -> str:
    """How suites of seven fit Eurocode 8, by spectrum and ground type."""
    from dem_cli.motion.eurocode import SOILS
    from dem_cli.motion.intensity_measures import fit
    from dem_cli.motion.motion import Motion
    from dem_cli.motion.synthetic import suite, target_of
    from dem_cli.motion.table import ArtificialTable

    suite(ArtificialTable(spectrum="EC8-1", soil="A", ag=1.0), 0)  # imports
    headings = ("spectrum", "ground", "damping", "suites that meet it", "lowest mean ratio", "mean ratio",
                "scatter of records", "mean peak / (ag S)", "CPU per record")  # fmt: skip
    lines = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    plan = [(kind, soil, 0.05) for kind in SOILS for soil in SOILS[kind]] + [("EC8-1", "B", 0.02), ("EC8-1", "B", 0.1)]
    for kind, soil, damping in plan:
        table = ArtificialTable(
            spectrum=kind,
            soil=soil,
            ag=2.0,
            damping=damping,
            count=OF_SEVEN * count,  # type: ignore[arg-type]
        )
        started = time.process_time()
        motions = [Motion(record) for record in suite(table, 1)]
        each = (time.process_time() - started) / len(motions)
        found = [fit(motions[i : i + OF_SEVEN], target_of(table)) for i in range(0, len(motions), OF_SEVEN)]
        ratios = np.concatenate([one.ratios for one in found])
        lines.append(
            f"| {kind} | {soil} | {100 * damping:g} % | {sum(one.meets for one in found)} of {count} "
            f"| {min(one.least_mean for one in found):.3f} | {ratios.mean():.3f} | {np.log(ratios).std():.3f} "
            f"| {np.mean([one.mean_peak for one in found]):.3f} | {each:.3f} s |"
        )
    return "\n".join(lines) + "\n"


def spectrum_errors() -> str:
    """Largest relative error of each spectrum over periods from 0.03 s to 4 s, against 40 times as many points."""
    from dem_cli.motion.spectrum import response_spectrum
    from dem_cli.motion.synthetic import suite
    from dem_cli.motion.table import ArtificialTable

    (record,) = suite(ArtificialTable(spectrum="EC8-1", soil="B", ag=2.0), 1)
    history, step, periods = record.acceleration(record.times), record.step, np.geomspace(0.03, 4.0, 40)
    exact = response_spectrum(history, step, periods, points=2400)
    lines = ["| points per period, at least | SD | SV | SA |", "|---|---|---|---|"]
    for points in (10, 20, 60, 120):
        found = response_spectrum(history, step, periods, points=points)
        errors = [
            np.abs(getattr(found, field) / getattr(exact, field) - 1.0).max()
            for field in ("displacement", "velocity", "acceleration")
        ]
        lines.append(f"| {points} | " + " | ".join(f"{error:.0e}" for error in errors) + " |")
    return "\n".join(lines) + "\n"


def draw() -> None:
    """The pictures of a suite of seven."""
    from dem_cli.motion.motion import Motion
    from dem_cli.motion.synthetic import suite, target_of
    from dem_cli.motion.table import ArtificialTable
    from dem_cli.post.spectra import MotionSuite, draw_motions, draw_spectra

    table = ArtificialTable(spectrum="EC8-1", soil="B", ag=2.0, count=OF_SEVEN)
    motions = [Motion(record, name=f"artificial {i}") for i, record in enumerate(suite(table, 1), 1)]
    made = [MotionSuite(motions, target_of(table))]
    draw_spectra(made, PAGE.with_name("motion_spectra.png"), "Suite of seven")
    draw_motions(made, PAGE.with_name("motion_records.png"), "Suite of seven")


if __name__ == "__main__":
    sys.exit(main())
