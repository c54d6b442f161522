"""What `dem run` does around the solver: results, verdicts, interruptions, messages."""

from __future__ import annotations

import io
import json
import time

import pytest
from synthetic import wall_model, wall_summary
from synthetic.runs import CASE, load, solver

from dem_cli.app.cli.run import execute
from dem_cli.app.cli.words import console
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.monitor_names import monitor_names
from dem_cli.results.output.folder import OutputFolder
from dem_cli.results.output.reader import read
from dem_cli.results.output.summary import exit_code
from dem_cli.results.report import facts


def run(tmp_path, solve, text=CASE, **options):
    loaded = load(tmp_path / "wall_21.toml", text)
    return execute(loaded, wall_model(), tmp_path / "out", time.perf_counter(), solve=solve, **options)


def test_results_and_verdict(tmp_path, capsys):
    summary, folder = run(tmp_path, solver())
    capsys.readouterr()
    assert summary == json.loads((folder / "summary.json").read_text())
    assert list(summary)[:5] == ["title", "kind", "version", "status", "failure_load"]
    assert summary["reference"] == {"value": 0.64, "tolerance": 0.001, "passed": True}
    assert summary["wall_seconds"] > 0
    assert exit_code(summary) == 0
    assert exit_code({**summary, "reference": {"passed": False}}) == 1
    results = read(folder)
    assert (len(results.frames), len(results.history["load"])) == (6, 60)
    assert list(results.monitors) == ["base displacement"]
    text = console.answer(summary, folder, ["summary.json"], verbose=True)
    assert "failure load   0.6402  (between 0.6395 and 0.6409)" in text
    assert (
        "how sure       ±0.11 % under this history, no history carries more than 0.6520, energy closes to 1e-09" in text
    )
    assert "reference      0.64 ± 0.001: passed" in text
    assert "skipped        large displacements: not needed" in text


def test_no_failure_load_never_passes_a_reference(tmp_path):
    def solve(case, model, observer):
        outcome = solver(1)(case, model, observer)
        outcome.summary |= {
            "status": "no failure up to 10",
            "failure_load": None,
            "failure_load_bracket": [10.0, None],
        }
        return outcome

    summary, folder = run(tmp_path, solve)
    assert summary["reference"]["passed"] is False
    assert exit_code(summary) == 1
    assert "status         no failure up to 10" in console.answer(summary, folder, [])


def test_a_solver_that_gives_up_keeps_what_it_has(tmp_path):
    summary, folder = run(tmp_path, solver(fail_at=3))
    assert exit_code(summary) == 3
    assert summary["status"] == read(folder).status == "not converged"
    assert summary["warnings"] == ["step 300: no equilibrium within 1,000 steps at load 0.4"]
    assert len(read(folder).frames) == 3
    assert summary["reached"]["stage"] == "loading"


def interrupted(n_frames):
    def solve(case, model, observer):
        solver(n_frames)(case, model, observer)
        raise KeyboardInterrupt

    return solve


def test_interrupted(tmp_path):
    summary, folder = run(tmp_path, interrupted(4))
    assert exit_code(summary) == 130
    assert summary["status"] == read(folder).status == "interrupted"
    assert "reference" not in summary
    assert len(read(folder).frames) == 4


def test_interrupted_before_anything_was_solved_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, interrupted(0))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["wall_21.toml"]


def test_interrupted_results_do_not_replace_complete_ones(tmp_path):
    run(tmp_path, solver())
    _, folder = run(tmp_path, interrupted(2))
    assert folder.name == "out.interrupted"
    assert read(tmp_path / "out").status == "ok"
    assert len(read(folder).frames) == 2
    _, folder = run(tmp_path, solver(3))
    assert len(read(folder).frames) == 3


def test_a_bug_in_the_solver_leaves_nothing(tmp_path):
    def solve(case, model, observer):
        observer.frame(None)

    with pytest.raises(AttributeError):
        run(tmp_path, solve)
    assert not (tmp_path / "out").exists()
    OutputFolder(tmp_path / "out").discard()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["wall_21.toml"]


def test_pictures_on_demand(tmp_path):
    pytest.importorskip("matplotlib")
    _, folder = run(tmp_path, solver(), plot=True)
    for name in ("capacity.png", "collapse.png"):
        assert (folder / name).read_bytes()[:4] == b"\x89PNG"


def test_a_picture_that_cannot_be_drawn_costs_no_results(tmp_path, monkeypatch, capsys):
    def fault(*_):
        raise ZeroDivisionError("in a picture")

    monkeypatch.setattr("dem_cli.results.post.run_pictures.draw_all", fault)
    summary, folder = run(tmp_path, solver(), plot=True)
    assert (summary["status"], (folder / "results.h5").is_file()) == ("ok", True)
    assert "no pictures: internal error: ZeroDivisionError: in a picture" in capsys.readouterr().err


def test_threads_without_work_are_said(tmp_path, capsys):
    summary, _ = run(tmp_path, solver(), options=BatchOptions(threads=2))
    assert "threads" not in json.dumps(summary)
    assert "1 of 2 threads had work: several step a structure where" in capsys.readouterr().err
    run(tmp_path, solver(), options=BatchOptions(threads=1))
    assert "threads" not in capsys.readouterr().err


def test_monitor_names_differ(tmp_path):
    tables = ('block = "base"\ncomponent = "x"', 'block = "base"', "point = [0.5, 0.1]")
    more = "".join(f"[[monitor]]\n{table}\n" for table in tables)
    loaded = load(tmp_path / "case.toml", CASE + more)
    assert monitor_names(loaded.case.monitor) == [
        "base displacement",
        "base displacement x",
        "base displacement #2",
        "(0.5, 0.1) displacement",
    ]


def test_plain_progress_lines(monkeypatch):
    clock = iter((0.0, 1.0, 11.0, 12.0, 25.0))
    monkeypatch.setattr("dem_cli.app.cli.words.console.time.monotonic", lambda: next(clock))
    stream = io.StringIO()
    bar = console.Progress(stream=stream)
    for fraction in (0.1, 0.25, 0.3, None):
        bar.update("loading", 0.3125, 1.25e-5, fraction)
    assert stream.getvalue().splitlines() == [
        "loading: load 0.3125, displacement 12.5 µm, 25 %, 11 s so far",  # two looks say nothing of a pace
        "loading: load 0.3125, displacement 12.5 µm, 25 s so far",
    ]


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_bar_on_a_terminal(monkeypatch):
    monkeypatch.setattr("dem_cli.app.cli.words.console._FIRST_BAR", 0.0)
    stream = Terminal()
    with console.Progress(stream=stream) as bar:
        bar.update("loading", 0.3125, 1.25e-5, 0.5)
        time.sleep(0.15)
        bar.update("collapse", 0.3, 0.01, None)
    assert "loading" in stream.getvalue()
    assert "load 0.3125, displacement 12.5 µm" in stream.getvalue()


def test_quiet_says_nothing():
    stream = Terminal()
    with console.Progress(quiet=True, stream=stream) as bar:
        bar.start = bar._next = 0.0
        bar.update("loading", 0.3, 0.0, 0.5)
    assert stream.getvalue() == ""


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0 µm"), (1.2e-5, "12 µm"), (0.0123, "12.3 mm"), (2.0, "2 m"), (-0.5, "-500 mm")],
)
def test_metres(value, text):
    assert console.metres(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0123, "12 ms"), (1.0, "1.0 s"), (90, "90 s"), (600, "10 min"), (9000, "2.5 h")]
)
def test_seconds(value, text):
    assert console.seconds(value) == text


def test_answer_without_a_failure_load(tmp_path):
    summary = {
        **wall_summary("not converged"),
        "failure_load": None,
        "failure_load_bracket": None,
        "energy_closure": None,
    }
    summary["reached"] = {"stage": "loading", "load": 0.4, "displacement": 1e-5}
    text = console.answer(summary, tmp_path, ["summary.json"])
    assert "how sure" not in text
    assert "reached        loading, load 0.4000, displacement 10 µm" in text


@pytest.mark.parametrize(
    ("bracket", "known"), [([0.1, 0.9], "it stands at 0.1"), ([None, 0.9], "no equilibrium was proven")]
)
def test_a_load_that_was_not_found_is_the_answer(tmp_path, bracket, known):
    """The answer began with "status: not converged", and of the load only a warning spoke."""
    summary = {**wall_summary("not converged"), "failure_load": None, "failure_load_bracket": bracket}
    assert f"failure load   not found: {known}\n" in console.answer(summary, tmp_path, [])
    assert "0.9" not in console.answer({**summary, "limit_analysis": None}, tmp_path, [])
    assert facts.answer(summary)[:3] == ("failure load λ", "not found", f"not converged; {known}")


def test_compiling_is_said_at_once():
    stream = io.StringIO()
    progress = console.Progress(stream=stream)
    for _ in range(2):
        progress.update("compiling (once)", 0.0, 0.0, None)
    console.Progress(stream=stream, quiet=True).update("compiling (once)", 0.0, 0.0, None)
    assert stream.getvalue() == "compiling (once)\n"
