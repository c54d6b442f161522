"""From [motion] tables to motions, and what is said about tables that are wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dem_cli.app.api import build_model, load_case, make_case_model
from dem_cli.case.reader import CaseSource, LoadedCase, parse_toml, validate
from dem_cli.case.writer import case_text
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.ground_motions import motions_of, suites_of

CASE = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "column"
block = [0.5, 0.25]
courses = 2
base = true
"""
FIRST = CASE.count("\n") + 1  # line of the first [motion]
RECORD = """[motion]
kind = "record"
file = "records/east.csv"
unit = "g"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "records").mkdir()
    rows = [f"{0.01 * i:.2f},{0.3 * np.sin(0.1 * i):.6f}" for i in range(200)]
    (tmp_path / "records" / "east.csv").write_text("\n".join(rows))
    return tmp_path


def loaded(folder, text, *overrides):
    (folder / "case.toml").write_text(CASE + text)
    return load_case(folder / "case.toml", overrides)


def refused(folder, text, *overrides):
    """What is said, without the name of the file."""
    with pytest.raises(CaseError) as error:
        build_model(loaded(folder, text, *overrides))
    return str(error.value).removeprefix(f"{folder / 'case.toml'}:")


def test_one_table_or_several(folder):
    pulse = 'kind = "pulse"\namplitude = 2.0\nfrequency = 1.5\n'
    assert len(motions_of(loaded(folder, f"[motion]\n{pulse}").case)) == 1
    two = motions_of(loaded(folder, f"[[motion]]\n{pulse}[[motion]]\n{pulse}direction = [0.0, -2.0]\nstart = 1.0").case)
    assert [m.direction for m in two] == [(1.0, 0.0), (0.0, -1.0)]
    assert [m.duration for m in two] == pytest.approx([1 / 1.5, 1 + 1 / 1.5])
    assert motions_of(loaded(folder, "").case) == []
    assert motions_of(loaded(folder, '[motion]\nkind = "none"').case) == []


@pytest.mark.parametrize(
    ("keys", "duration", "at", "value"),
    [
        ('shape = "sine"\nfrequency = 2.0', 0.5, 0.125, 3.0),
        ('shape = "cosine"\nfrequency = 2.0', 0.5, 0.25, -3.0),
        ('shape = "half-sine"\nfrequency = 2.0', 0.25, 0.125, 3.0),
        ('shape = "ricker"\nfrequency = 2.0', 1.5, 0.75, 3.0),
        ('shape = "impulse"\nduration = 0.4', 0.4, 0.2, 3.0),
        ('shape = "impulse"\nduration = 0.4\nrebound = 0.5', 1.2, 0.8, -1.5),
    ],
)
def test_pulses(folder, keys, duration, at, value):
    (motion,) = motions_of(loaded(folder, f'[motion]\nkind = "pulse"\namplitude = 3.0\n{keys}').case)
    assert motion.duration == pytest.approx(duration)
    assert motion.acceleration(at) == pytest.approx(value)


def test_harmonic(folder):
    text = '[motion]\nkind = "harmonic"\namplitude = 1.0\nfrequency = 5.0\ncycles = 10\nramp = 2\nphase_deg = 90'
    (motion,) = motions_of(loaded(folder, text).case)
    assert motion.duration == pytest.approx(2.0)
    assert motion.acceleration(np.array([0.2, 1.0, 1.8])) == pytest.approx([0.5, 1.0, 0.5])


def test_records_are_scaled(folder):
    (plain,) = motions_of(loaded(folder, RECORD).case)
    assert plain.peak == pytest.approx(0.3 * 9.80665, rel=1e-3)
    (doubled,) = motions_of(loaded(folder, RECORD, "motion.scale=-2.0").case)
    assert doubled.acceleration(0.5) == pytest.approx(-2.0 * plain.acceleration(0.5))
    (set_to,) = motions_of(loaded(folder, RECORD, "motion.peak=1.5").case)
    assert set_to.peak == pytest.approx(1.5)


@pytest.mark.parametrize(("quantity", "unit", "factor"), [("velocity", "cm/s", 0.01), ("displacement", "mm", 0.001)])
def test_units_of_other_quantities(folder, quantity, unit, factor):
    text = RECORD.replace('"g"', f'"{unit}"') + f'quantity = "{quantity}"\nscale = 1.0'
    (motion,) = motions_of(loaded(folder, text).case)
    assert getattr(motion, quantity)(1.57) == pytest.approx(0.3 * factor * np.sin(15.7), rel=1e-4)


def test_the_effective_case_finds_its_record_from_anywhere(folder, monkeypatch):
    case = loaded(folder, RECORD).case
    monkeypatch.chdir("/")
    again = folder / "elsewhere.toml"
    again.write_text(case_text(case))
    (folder / "deeper").mkdir()
    moved = again.rename(folder / "deeper" / "elsewhere.toml")
    assert motions_of(load_case(moved).case)[0].peak == motions_of(case)[0].peak
    source = CaseSource(Path("case.toml"), case_text(case))
    assert validate(parse_toml(source.path, source.text), make_case_model(), source).motion == case.motion


def test_a_relative_case_in_the_current_folder(folder, monkeypatch):
    loaded(folder, RECORD)
    monkeypatch.chdir(folder)
    assert Path(load_case("case.toml").case.motion[0].file) == folder / "records" / "east.csv"


@pytest.mark.parametrize(
    ("samples", "order", "said"),
    [
        ("0,0.1\n1,0.2\n2,0.1\n", "2", "2 is not allowed for east.csv: a baseline of order 2 needs at least 4 samples"),
        ("0,0.1\n1,0.2\n2,0.3\n3,0.4\n", "true", "takes out the whole motion of east.csv"),
    ],
)
def test_a_baseline_that_cannot_be_taken_out_is_refused(folder, samples, order, said):
    (folder / "records" / "east.csv").write_text(samples)
    with pytest.raises(CaseError, match=f"motion.0.baseline: {said}"):
        motions_of(loaded(folder, RECORD + f"peak = 2.0\nbaseline = {order}").case)


def test_a_suite_and_the_record_of_it_that_is_used(folder):
    text = '[motion]\nkind = "artificial"\nspectrum = "EC8-1"\nsoil = "B"\nag = 2.0\ncount = 3\nnumber = 2\nscale = 0.5'
    case = loaded(folder, text).case
    (suite,) = suites_of(case)
    (used,) = motions_of(case)
    assert [m.name for m in suite] == ["artificial 1", "artificial 2", "artificial 3"]
    assert used.name == "artificial 2"
    assert used.acceleration(7.77) == suite[1].acceleration(7.77)
    assert used.peak >= 0.5 * 2.0 * 1.2


def test_two_suites_of_a_case_differ_and_seeds_change_them(folder):
    table = '[[motion]]\nkind = "artificial"\nspectrum = "EC8-1"\nsoil = "B"\nag = 2.0\n'
    x, y = motions_of(loaded(folder, table + table).case)
    (other,) = motions_of(loaded(folder, table, "seed=2").case)
    (own,) = motions_of(loaded(folder, table + "seed = 2").case)
    assert x.acceleration(7.0) != y.acceleration(7.0)
    assert x.acceleration(7.0) != other.acceleration(7.0)
    assert own.acceleration(7.0) == other.acceleration(7.0)


def test_a_record_that_ends_in_motion_is_a_warning(folder):
    (folder / "records" / "east.csv").write_text("0,0\n1,0.2\n2,0.2\n3,0\n")
    case = loaded(folder, RECORD)
    build_model(case)
    (warning,) = [line for line in case.warnings if "motion.file" in line]
    assert warning.startswith(f"{folder / 'case.toml'}:{FIRST + 2}:")
    assert "ends with a velocity of 3.92 m/s" in warning
    assert "baseline = true, or 2, may take a drift out" in warning


ARTIFICIAL = '[motion]\nkind = "artificial"\n'
HARMONIC = '[motion]\nkind = "harmonic"\namplitude = 1.0\nfrequency = 1.0\n'
PULSE = '[motion]\nkind = "pulse"\namplitude = 1.0\n'
WRONG = {  # text, line after the first [motion], what is said
    "kind": ('[motion]\nkind = "puls"', 1, "motion.kind: unknown kind 'puls', did you mean 'pulse'?"),
    "no kind": ("[motion]\namplitude = 1.0", 0, "motion.kind: missing; must be 'pulse', 'harmonic', 'record'"),
    "key": (PULSE + "freqency = 1.0", 3, "motion.freqency: unknown key, did you mean 'frequency'?"),
    "amplitude 0": ('[motion]\nkind = "pulse"\namplitude = 0.0\nfrequency = 1.0', 2, "0 is not allowed"),
    "no frequency": (PULSE, 0, "motion.frequency: missing; shape = 'sine' needs it: a number > 0"),
    "duration": (PULSE + "frequency = 1.0\nduration = 2.0", 4, "motion.duration: not allowed with shape = 'sine'"),
    "rebound": (PULSE + "frequency = 1.0\nrebound = 0.5", 4, "motion.rebound: not allowed with shape = 'sine'"),
    "direction": (PULSE + "frequency = 1.0\ndirection = [0, 0]", 4, "motion.direction: [0, 0] is not allowed"),
    "support": (PULSE + 'frequency = 1.0\nblocks = ["bse"]', 4, "motion.blocks.0: unknown block 'bse', did you mean"),
    "free block": (
        PULSE + 'frequency = 1.0\nblocks = ["base", "column-1"]', 4,
        "motion.blocks.1: block 'column-1' is not fixed; only a fixed block can be moved (fixed: 'column-base', ",
    ),
    "no length": (HARMONIC, 0, "motion: neither 'cycles' nor 'duration' is given"),
    "two lengths": (HARMONIC + "cycles = 3\nduration = 1.0", 0, "motion: 'cycles' and 'duration' are given"),
    "ramp": (HARMONIC + "cycles = 3\nramp = 2", 5, "motion.ramp: 2 is not allowed; must be at most half of all cycles"),
    "no file": (RECORD.replace("east", "est"), 2, "did you mean 'east.csv'?"),
    "no folder": (RECORD.replace("records", "recs"), 2, "(there is no folder '"),
    "unit of another": (RECORD.replace('"g"', '"cm/s"'), 3, "motion.unit: 'cm/s' is not a unit of acceleration"),
    "unknown unit": (RECORD.replace('"g"', '"G"'), 3, "motion.unit: unknown unit 'G'"),
    "no unit": (RECORD.replace('unit = "g"\n', ""), 0, "motion.unit: missing; east.csv does not say"),
    "both": (RECORD + "scale = 1.0\npeak = 2.0", 0, "motion: 'scale' and 'peak' are given"),
    "scale 0": (RECORD + "scale = 0", 4, "motion.scale: 0 is not allowed"),
    "baseline": (RECORD + "baseline = 4", 4, "motion.baseline: 4 is not allowed"),
    "soil": (ARTIFICIAL + 'spectrum = "EC8-1"\nag = 2.0', 0, "motion.soil: missing; spectrum = 'EC8-1' needs it"),
    "ag": (ARTIFICIAL + "spectrum = [[0.0, 1.0], [1.0, 2.0]]\nag = 2.0", 3, "motion.ag: not allowed beside a spectrum"),
    "periods": (
        ARTIFICIAL + "spectrum = [[0.0, 1.0], [1.0, 2.0], [0.5, 1.0]]", 2,
        "motion.spectrum.2.0: 0.5 is not allowed; periods increase",
    ),
    "number": (
        ARTIFICIAL + 'spectrum = "EC8-1"\nsoil = "B"\nag = 2.0\ncount = 3\nnumber = 4', 6,
        "motion.number: 4 is not allowed; must be at most count = 3",
    ),
    "too short": (
        ARTIFICIAL + 'spectrum = "EC8-1"\nsoil = "B"\nag = 2.0\nduration = 8.0', 5,
        "motion.duration: 8 s is not allowed; rise + plateau = 12 s is longer than that "
        "(rise = 2 and plateau = 10 where the case gives none: shorten them too)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_said_about_a_wrong_table(folder, name):
    text, line, message = WRONG[name]
    said = refused(folder, text)
    assert said.startswith(f"{FIRST + line}:"), said
    assert message in said
    assert len(said.splitlines()) == 1


def test_the_second_of_two_tables_is_named_by_its_number(folder):
    text = f"[[motion]]\n{PULSE.removeprefix('[motion]')}frequency = 1.0\n[[motion]]\nkind = 'pulse'\namplitude = 0.0"
    said = refused(folder, text + "\nfrequency = 1.0")
    assert said.startswith(f"{FIRST + 7}:"), said
    assert "motion.1.amplitude: 0 is not allowed" in said


@pytest.mark.parametrize(
    ("unit", "values", "message"),
    [
        ("g", "0,0 1,320 2,0", "'g' gives a peak acceleration of 320 g; 'cm/s2' would give 0.326 g"),
        ("mm/s2", "0,0 1,0.2 2,0", "'mm/s2' gives a peak acceleration of 2.04e-05 g; 'g' would give 0.2 g"),
        ("g", "0,0 1,1e9 2,0", "gives a peak acceleration of 1e+09 g; if it is meant, add scale = 1.0"),
    ],
)
def test_units_that_make_no_earthquake(folder, unit, values, message):
    (folder / "records" / "east.csv").write_text(values.replace(" ", "\n"))
    said = refused(folder, RECORD.replace('"g"', f'"{unit}"'))
    assert said.startswith(f"{FIRST + 3}:8: motion.unit: ")
    assert message in said
    build_model(loaded(folder, RECORD.replace('"g"', f'"{unit}"') + "scale = 1.0"))
    assert motions_of(loaded(folder, RECORD + "peak = 2.0").case)[0].peak == pytest.approx(2.0)


def test_units_that_make_a_faint_earthquake_are_doubted(folder):
    (folder / "records" / "east.csv").write_text("0,0\n1,0.2\n2,-0.2\n3,0\n")
    text = RECORD.replace('"g"', '"cm/s2"')
    faint = "'cm/s2' gives a peak acceleration of 0.000204 g; 'g' would give 0.2 g and 'm/s2' would give 0.0204 g; "
    for more, said in (("", [faint + "scale = 1.0 says that it is meant"]), ("scale = 1.0", []), ("peak = 2.0", [])):
        case = loaded(folder, text + more)
        build_model(case)
        assert [line.partition("motion.file: ")[2] for line in case.warnings if "peak" in line] == said


def test_what_is_wrong_in_a_record_is_told_with_both_lines(folder):
    (folder / "records" / "east.csv").write_text("t,a\n0,0\n0.01,zero\n")
    assert refused(folder, RECORD) == f"{FIRST + 2}:8: motion.file: east.csv:3: 'zero' is not a number"
    (folder / "records" / "east.csv").write_text("0,1\n1,1\n", encoding="utf-8")
    case = loaded(folder, RECORD + 'quantity = "velocity"', 'motion.unit="m/s"')
    with pytest.raises(CaseError, match="no motion, every velocity is the same"):
        build_model(case)


def test_a_peer_file_says_its_unit_itself(folder):
    text = "PEER\nFriuli\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 4, DT= 0.01\n0 0.1 -0.2 0\n"
    (folder / "records" / "east.csv").write_text(text)
    silent = RECORD.replace('unit = "g"\n', "")
    assert motions_of(loaded(folder, silent).case)[0].peak == pytest.approx(0.2 * 9.80665)
    said = refused(folder, RECORD.replace('"g"', '"m/s2"'))
    assert "motion.unit: 'm/s2' is not allowed; east.csv says that its values are in g" in said
    said = refused(folder, RECORD.replace('"g"', '"m/s"') + 'quantity = "velocity"')
    assert "motion.quantity: 'velocity' is not allowed; east.csv says that it holds acceleration" in said


def test_overrides_reach_one_table(folder):
    said = refused(folder, RECORD, "motion.unit=lb")
    assert "--set motion.unit: unknown unit 'lb'" in str(said)


def test_a_case_without_files_is_loaded_from_its_text_alone():
    source = CaseSource(Path("case.toml"), CASE + PULSE + "frequency = 1.0")
    case = validate(parse_toml(source.path, source.text), make_case_model(), source)
    assert LoadedCase(case, source).case.motion[0].frequency == 1.0


@pytest.mark.parametrize(
    ("first", "start", "remark"),
    [
        (5.0, 0.0, "begins at 5 s in the file, and here at 0 s; start = 5 keeps the times of the file"),
        (5.0, 2.0, "begins at 5 s in the file, and here at 2 s"),
        (-1.5, 0.0, "begins at -1.5 s in the file, and here at 0 s"),
        (0.01, 0.0, None),  # one step: nothing is meant by it
        (0.0, 0.0, None),
    ],
)
def test_a_record_that_begins_elsewhere_is_shifted_with_a_remark(folder, first, start, remark):
    rows = [f"{first + 0.01 * i:.2f},{0.3 * np.sin(0.1 * np.pi * i):.6f}" for i in range(201)]
    (folder / "records" / "east.csv").write_text("\n".join(rows))
    case = loaded(folder, RECORD + f"start = {start}\nbaseline = true\n")
    build_model(case)
    (motion,) = motions_of(case.case)
    assert motion.samples()[-1] == pytest.approx(start + 2.0)
    said = [line.partition("motion.file: ")[2] for line in case.warnings if "motion.file: begins" in line]
    assert said == ([remark] if remark else [])


def test_values_that_go_on_from_line_to_line(folder):
    (folder / "records" / "east.csv").write_text("0.1 0.2 -0.1\n0.3 0.05\n")
    (motion,) = motions_of(loaded(folder, RECORD + 'step = 0.01\ncolumn = "all"\n').case)
    assert motion.samples().tolist() == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])
    assert "column: 'some' is not allowed" in refused(folder, RECORD + 'step = 0.01\ncolumn = "some"\n')
    assert "column = 'all' needs a step" in refused(folder, RECORD + 'column = "all"\n')
