"""Study of artificial accelerograms and response spectra: the tables of docs/motion.md and its pictures."""

from __future__ import annotations

import argparse
import re
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from dem_cli.case.tables.base_motion import ArtificialTable
from dem_cli.core.motion.eurocode import SOILS
from dem_cli.core.motion.intensity_measures import fit
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.spectrum import response_spectrum
from dem_cli.core.motion.synthetic import suite
from dem_cli.results.post.spectra import MotionSuite, draw_motions, draw_spectra
from studies.places import DOCS
from studies.study import StudyRunner
from studies.template import table as markdown

PAGE = DOCS / "motion.md"
OF_SEVEN, SUITES = 7, 8  # records of a suite, suites per ground type


def suites(count: int = SUITES) -> str:
    """How suites of seven fit Eurocode 8, by spectrum and ground type."""
    suite(ArtificialTable(spectrum="EC8-1", soil="A", ag=1.0).asked, 0)  # imports
    headings = ("spectrum", "ground", "damping", "suites that meet it", "lowest mean ratio", "mean ratio",
                "scatter of records", "mean peak / (ag S)", "CPU per record")  # fmt: skip
    rows = []
    plan = [(kind, soil, 0.05) for kind in SOILS for soil in SOILS[kind]] + [("EC8-1", "B", 0.02), ("EC8-1", "B", 0.1)]
    for kind, soil, damping in plan:
        table = ArtificialTable(spectrum=kind, soil=soil, ag=2.0, damping=damping, count=OF_SEVEN * count)
        started = time.process_time()
        motions = [Motion(record) for record in suite(table.asked, 1)]
        each = (time.process_time() - started) / len(motions)
        found = [fit(motions[i : i + OF_SEVEN], table.target) for i in range(0, len(motions), OF_SEVEN)]
        ratios = np.concatenate([one.ratios for one in found])
        rows.append((
            kind, soil, f"{100 * damping:g} %", f"{sum(one.meets for one in found)} of {count}",
            f"{min(one.least_mean for one in found):.3f}", f"{ratios.mean():.3f}", f"{np.log(ratios).std():.3f}",
            f"{np.mean([one.mean_peak for one in found]):.3f}", f"{each:.3f} s",
        ))  # fmt: skip
    return markdown(headings, rows) + "\n"


def spectrum_errors() -> str:
    """Largest relative error of each spectrum over periods from 0.03 s to 4 s, against 40 times as many points."""
    (record,) = suite(ArtificialTable(spectrum="EC8-1", soil="B", ag=2.0).asked, 1)
    history, step, periods = record.acceleration(record.times), record.step, np.geomspace(0.03, 4.0, 40)
    exact = response_spectrum(history, step, periods, points=2400)
    rows = []
    for points in (10, 20, 60, 120):
        found = response_spectrum(history, step, periods, points=points)
        errors = [
            np.abs(getattr(found, field) / getattr(exact, field) - 1.0).max()
            for field in ("displacement", "velocity", "acceleration")
        ]
        rows.append((str(points), *(f"{error:.0e}" for error in errors)))
    return markdown(("points per period, at least", "SD", "SV", "SA"), rows) + "\n"


class MotionStudy(StudyRunner):
    """Two sections, each a table of docs/motion.md between its marks."""

    solves = False

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--suites", type=int, default=SUITES, help=f"suites of seven per ground type ({SUITES})")

    def measure(self, section: str, options: argparse.Namespace) -> str:
        return suites(options.suites) if section == "suites" else spectrum_errors()

    def said(self, section: str, found: Any) -> str:
        return found

    def write(self, found: Mapping[str, Any]) -> None:
        text = PAGE.read_text(encoding="utf-8")
        for name, table in found.items():
            mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
            text = mark.sub(lambda old, table=table: old[1] + table + old[2], text)
        PAGE.write_text(text, encoding="utf-8")
        self.redraw()

    def redraw(self) -> None:
        table = ArtificialTable(spectrum="EC8-1", soil="B", ag=2.0, count=OF_SEVEN)
        motions = [Motion(record, name=f"artificial {i}") for i, record in enumerate(suite(table.asked, 1), 1)]
        made = [MotionSuite(motions, table.target)]
        draw_spectra(made, PAGE.with_name("motion_spectra.png"), "Suite of seven")
        draw_motions(made, PAGE.with_name("motion_records.png"), "Suite of seven")


STUDY = MotionStudy(
    "motions", "Artificial accelerograms and the response spectrum", {"suites": suites, "spectrum": spectrum_errors}
)
