"""`dem plot -x -y`: columns of runs and sweeps by name, families, maps; what is drawn from which numbers."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic import history_rows, wall_frames, wall_model, wall_summary
from synthetic.shaking import AMPLITUDE, FREQUENCY, write_shaking

from dem_cli.app.cli.main import main
from dem_cli.results.output.store import ResultWriter

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure

CASE = """\
title = "A wall"
[materials.stone]
density = 2000.0
[joints.dry]
friction = {friction}
[[structure]]
kind = "wall"
block = [0.04, 0.02]
courses = 3
blocks_per_course = 2
[analysis]
kind = "pushover"
"""


def write_run(folder, friction=0.6, factor=1.0):
    """A made-up pushover whose loads are `factor` times those of others."""
    folder.mkdir(parents=True)
    model = wall_model()
    frames = [frame._replace(load=factor * frame.load) for frame in wall_frames(model, 6)]
    writer = ResultWriter(folder, model, CASE.format(friction=friction), {}, ["top displacement"])
    for row in history_rows(frames):
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    writer.close(wall_summary() | {"monitors": {"top displacement": {"value": 0.02, "unit": "m"}}})
    return folder


@pytest.fixture
def runs(tmp_path):
    return [write_run(tmp_path / "a", 0.5, 1.0), write_run(tmp_path / "b", 0.7, 2.0)]


SWEEP = """\
run,joints.dry.friction,structure.0.courses,status,reason,failure_load,failure_load_bracket.0,failure_load_bracket.1,failure_mode,displacement_at_failure
r1,0.5,3,ok,,0.5,0.49,0.51,sliding,0.0001
r2,0.7,3,ok,,0.6,0.59,0.62,rocking,0.0002
r3,0.9,3,ok,,0.7,0.69,0.71,rocking,0.0003
r4,0.5,6,ok,,0.4,0.39,0.41,sliding,0.0002
r5,0.7,6,failed,no equilibrium,,,,,
r6,0.9,6,ok,,0.45,0.44,0.46,rocking,0.0004
"""


def write_sweep(folder, text=SWEEP, keys=("joints.dry.friction", "structure.0.courses")):
    folder.mkdir()
    (folder / "sweep.csv").write_text(text)
    (folder / "sweep.json").write_text(json.dumps({"kind": "sweep", "title": "Walls", "keys": list(keys)}))
    return folder


@pytest.fixture
def sweep(tmp_path):
    return write_sweep(tmp_path / "sweep")


@pytest.fixture
def figures(monkeypatch):
    """Figures as they are when they are saved."""
    kept: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *args, **options: kept.append(figure))
    return kept


def dem(*arguments):
    result = CliRunner().invoke(main, ["plot", *(str(a) for a in arguments)])
    return result.exit_code, result.output


def lines(axis):
    """Curves of an axis, without the line at zero."""
    return [line for line in axis.get_lines() if len(line.get_xdata()) > 2]


def legend(figure):
    return [text.get_text() for box in figure.legends for text in box.get_texts()]


def test_two_columns_of_a_run(runs, figures):
    assert dem(runs[0], "-x", "Top_Displacement", "-y", "load") == (0, f"{runs[0] / 'plot.png'}\n")
    axis = figures[0].axes[0]
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("top displacement [mm]", "load multiplier λ")
    (curve,) = lines(axis)
    assert np.nanmax(curve.get_ydata()) == pytest.approx(0.64)
    assert np.nanmax(curve.get_xdata()) == pytest.approx(20.0)  # mm


def test_columns_of_other_units_have_their_own_panels(runs, figures):
    assert dem(runs[0], "-x", "displacement", "-y", "load", "-y", "friction energy", "-y", "gravity energy")[0] == 0
    load, energies = figures[0].axes
    assert len(lines(load)) == 1
    assert len(lines(energies)) == 2
    assert energies.get_ylabel() == "[mJ]"
    assert legend(figures[0]) == ["load multiplier λ", "friction energy", "gravity energy"]


def test_a_family_by_a_key_of_the_case(runs, figures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert dem(*runs, "--by", "joints.dry.friction") == (0, "plot.png\n")
    a, b = lines(figures[0].axes[0])
    assert np.nanmax(b.get_ydata()) == pytest.approx(2 * np.nanmax(a.get_ydata()))
    assert legend(figures[0]) == ["0.5", "0.7"]
    assert "friction coefficient" in figures[0].legends[0].get_title().get_text()
    assert a.get_color() != b.get_color()


def test_a_family_by_folder(runs, figures, tmp_path):
    assert dem(*runs, "-o", tmp_path / "c.svg")[0] == 0
    assert legend(figures[0]) == ["a", "b"]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_formats(runs, tmp_path, suffix):
    target = tmp_path / f"chart{suffix}"
    assert dem(runs[0], "-y", "load", "-o", target, "--size", "800x500", "--log", "x")[0] == 0
    assert target.read_bytes()[:5] in (b"\x89PNG\r", b"<?xml", b"%PDF-")


def test_spectrum_of_the_base(tmp_path, figures):
    folder = write_shaking(tmp_path, 4)
    assert dem(folder, "-x", "period", "-y", "spectral acceleration x")[0] == 0
    (curve,) = lines(figures[0].axes[0])
    at, values = curve.get_xdata(), curve.get_ydata()
    assert values[0] == pytest.approx(AMPLITUDE, rel=0.05)  # a stiff oscillator moves with the base
    assert at[values.argmax()] == pytest.approx(1.0 / FREQUENCY, rel=0.05)  # resonance
    assert figures[0].axes[0].get_ylabel() == "pseudo-acceleration x, 5 % damping [m/s²]"


def test_time_history_over_time(tmp_path, figures):
    folder = write_shaking(tmp_path, 4)
    assert dem(folder, "-x", "time", "--xlim", "0:4")[0] == 0
    axis = figures[0].axes[0]
    assert axis.get_xlim() == (0.0, 4.0)
    values = lines(axis)[0].get_ydata()[lines(axis)[0].get_xdata() <= 4.0]
    assert axis.get_ylim()[0] == pytest.approx(values.min(), rel=0.1)  # the fall after 4 s flattens nothing


def test_a_sweep_without_options(sweep, figures):
    """The key with most values to the right, the answer upwards, the other keys as families; no answer: a cross."""
    assert dem(sweep) == (0, f"{sweep / 'sweep.png'}\n")
    axis = figures[0].axes[0]
    assert axis.get_xlabel() == "friction coefficient tan φ (dry)"
    curves = [line for line in axis.get_lines() if line.get_marker() in "osD" and len(line.get_xdata()) > 1]
    assert [list(line.get_ydata()) for line in curves] == [[0.5, 0.6, 0.7], [0.4, 0.45]]
    brackets = [list(line.get_ydata()) for line in axis.get_lines() if line.get_marker() == "_"]
    assert sorted(brackets)[:2] == [[0.39, 0.41], [0.44, 0.46]]
    (cross,) = [line for line in axis.get_lines() if line.get_marker() == "x"]
    assert list(cross.get_xdata()) == [0.7]
    assert legend(figures[0]) == ["courses", "3", "6", "no answer"]


def test_a_run_without_failure_load_is_drawn_as_its_bracket(tmp_path, figures):
    """Runs that ended between two loads were crosses on the axis, as if nothing were known of them."""
    text = SWEEP.replace("failed,no equilibrium,,,,,", "not converged,no steps left,,0.3,0.5,,")
    text = text.replace("ok,,0.45,0.44,0.46,rocking,0.0004", "not converged,no steps left,,0.35,,,")
    assert dem(write_sweep(tmp_path / "sweep", text))[0] == 0
    drawn = figures[0].axes[0].get_lines()
    found = {line.get_marker(): (list(line.get_xdata()), list(line.get_ydata())) for line in drawn if line.is_dashed()}
    assert found == {"_": ([0.7, 0.7], [0.3, 0.5]), "^": ([0.9], [0.35])}
    assert legend(figures[0]) == ["courses", "3", "6", "bracket, no answer"]


def test_columns_of_a_sweep(sweep, figures):
    assert dem(sweep, "-x", "courses", "-y", "displacement at failure", "--by", "friction")[0] == 0
    axis = figures[0].axes[0]
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("courses", "displacement at failure [mm]")
    first = next(line for line in axis.get_lines() if len(line.get_xdata()) == 2)
    assert first.get_ydata() == pytest.approx([0.1, 0.2])


def test_map_of_numbers_and_of_words(sweep, figures, tmp_path):
    assert dem(sweep, "--map")[0] == 0
    texts = [text.get_text() for text in figures[0].axes[0].texts]
    assert texts == ["0.500", "0.600", "0.700", "0.400", "–", "0.450"]
    assert dem(sweep, "--map", "-y", "failure_mode")[0] == 0
    assert [tick.get_text() for tick in figures[1].axes[1].get_yticklabels()] == ["sliding", "rocking"]


def test_an_answer_in_words_becomes_a_map(tmp_path, figures):
    text = "run,a,b,status,reason,collapsed\n" + "".join(
        f"r{i},{i % 3},{i // 3},ok,,{'true' if i > 4 else 'false'}\n" for i in range(9)
    )
    folder = write_sweep(tmp_path / "s", text, ("a", "b"))
    assert dem(folder)[0] == 0
    values = figures[0].axes[0].collections[0].get_array()
    assert np.asarray(values).ravel().tolist() == [0, 0, 0, 0, 0, 1, 1, 1, 1]


def test_random_keys_are_points(tmp_path, figures):
    rows = "".join(f"r{i},{0.1 * i},{7 - 0.3 * i},{i * i},ok,,{i}\n" for i in range(30))
    folder = write_sweep(tmp_path / "s", "run,a,b,c,status,reason,failure_load\n" + rows, ("a", "b", "c"))
    assert dem(folder)[0] == 0
    assert {line.get_linestyle() for line in figures[0].axes[0].get_lines()} == {"None"}
    assert len(figures[0].axes) == 2  # a colour bar


def test_curves_of_the_runs_of_a_sweep(sweep, figures):
    write_run(sweep / "runs" / "r1", 0.5, 1.0)
    write_run(sweep / "runs" / "r3", 0.9, 3.0)
    assert dem(sweep, "-x", "displacement", "-y", "load", "--where", "courses=3")[0] == 0
    a, b = lines(figures[0].axes[0])
    assert np.nanmax(b.get_ydata()) == pytest.approx(3 * np.nanmax(a.get_ydata()))
    assert legend(figures[0]) == ["0.5", "0.9"]


def test_lists(runs, sweep):
    code, output = dem(runs[0], "--list")
    assert code == 0
    assert output.startswith("history\n")
    assert ["top", "displacement", "m"] in [line.split() for line in output.splitlines()]
    code, output = dem(sweep, "--list")
    assert code == 0
    assert "swept: 0.5 to 0.9" in output


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("-y", "laod"), "no column 'laod', did you mean 'load'? (--list shows all)"),
        (("--where", "a=1"), "--where and --map are for the folder of a sweep"),
        (("--map",), "--where and --map are for the folder of a sweep"),
        (("--size", "800"), "choose columns with -x and -y"),
        (("-y", "load", "-o", "a.jpg"), "has to end in .png, .svg or .pdf"),
        (("-y", "load", "--xlim", "3:1"), "the lower one first"),
        (("-y", "load", "--animate"), "--animate comes with all pictures"),
        (("-y", "load", "--by", "joints.wet.friction"), "has no such key"),
        (("--picture", "modes"), "nothing to draw for modes"),
        (("--picture", "modes", "-y", "load"), "--picture is for one run"),
    ],
)
def test_wrong_arguments_for_a_run(runs, arguments, says):
    code, output = dem(runs[0], *arguments)
    assert code == 2
    assert says in output


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("-y", "failure_laod"), "no column 'failure_laod', did you mean 'failure_load'?"),
        (("--where", "courses"), "must be KEY=VALUE"),
        (("--where", "courses=4"), "no run has these values (structure.0.courses: 3, 6)"),
        (("--map", "--where", "courses=3"), "--map needs two keys"),
    ],
)
def test_wrong_arguments_for_a_sweep(sweep, arguments, says):
    code, output = dem(sweep, *arguments)
    assert code == 2
    assert says in output


def test_a_sweep_is_drawn_alone(sweep, runs):
    assert "a sweep is drawn alone" in dem(sweep, runs[0])[1]


def test_columns_of_different_length(tmp_path):
    folder = write_shaking(tmp_path, 4)
    code, output = dem(folder, "-x", "base acceleration x", "-y", "kinetic energy")
    assert code == 2
    assert "not of one length" in output


@pytest.mark.parametrize("text", ["nothing\n", "run,a,status\nr1,2\n", "run,a,status\n", ""])
def test_a_table_that_is_none(tmp_path, text):
    folder = write_sweep(tmp_path / "s", text)
    code, output = dem(folder)
    assert code == 2
    assert "these results are damaged: sweep.csv" in output
    assert len(output.splitlines()) == 1


def test_one_picture(runs, tmp_path):
    target = tmp_path / "energy.pdf"
    assert dem(runs[0], "--picture", "energy", "-o", target) == (0, f"{target}\n")
    assert target.read_bytes().startswith(b"%PDF-")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("run,a,status,reason,blocks\nr1,1,ok,,2\nr2,2,ok,,2\n", "no column is the answer; choose one with -y"),
        ("run,a,status,reason,blocks\nr1,1,waiting,,\n", "no run has an answer yet"),
        ("", "the column 'run' is missing"),
        (None, "no sweep.csv yet"),
    ],
)
def test_a_sweep_without_an_answer(tmp_path, text, says):
    folder = write_sweep(tmp_path / "s", text or "", ("a",))
    if text is None:
        (folder / "sweep.csv").unlink()
    code, output = dem(folder)
    assert (code, says in output) == (2, True)
