"""Names of the user's in CSV: no formulas, one line per row, and the name comes back."""

from __future__ import annotations

import csv
import io

import pytest

from dem_cli.core.records.history_rows import RunRow
from dem_cli.results.output.csv_cells import cell, text_of
from dem_cli.results.output.run_tables import write_runs


@pytest.mark.parametrize("name", ["=1+1", "+20 %", "-cmd|' /C calc'!A0", "@SUM(A1)", "=", "−5 (a true minus)"])
def test_no_formula_and_back(name):
    assert not cell(name).startswith(("=", "+", "-", "@"))
    assert text_of(cell(name)) == name


@pytest.mark.parametrize("value", ["-5", "+0.5", "-1e-3", "weak", "'quoted'", "", -5, -0.5, None, True])
def test_what_is_no_formula_stays(value):
    assert cell(value) == value


@pytest.mark.parametrize("name", ["a\nb", "a\r\nb", "a\tb", "a\x00b", "a\u2028b", "\n=a\n"])
def test_one_line(name):
    written = cell(name)
    assert len(written.splitlines()) == 1
    assert text_of(written).split() == name.replace("\x00", " ").split()
    assert not written.startswith("=")


def test_the_table_of_runs(tmp_path):
    rows = [RunRow(0, "=HYPERLINK(1)", 1.0, 2.0, True, None, "first line\nsecond", (-0.5,))]
    write_runs(tmp_path / "runs.csv", rows, ["@top\n"])
    lines = (tmp_path / "runs.csv").read_text(encoding="utf-8").split("\n")
    assert len(lines) == 3
    assert lines[2] == ""
    head, row = csv.reader(io.StringIO("\n".join(lines[:2])))
    assert head[-1] == "peak @top"
    assert row[1:] == ["'=HYPERLINK(1)", "1.0", "2.0", "1", "", "first line second", "-0.5"]
