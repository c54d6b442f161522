"""`dem report`: what is in the page, without a browser. tests/cli/test_report_page.py opens it."""

from __future__ import annotations

import base64
import json
import re
import sys
import tomllib
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic import wall_model
from synthetic.pages import evil, sweep, wall
from synthetic.shaking import write_shaking
from synthetic.solid_runs import solid_frames, solid_wall, write_solid_run
from synthetic.tumbling import write_shaken_column

from dem_cli.analysis_kinds import KINDS
from dem_cli.app.cli.main import main
from dem_cli.core.records.frames import STATES
from dem_cli.results.output.store import ResultWriter
from dem_cli.results.report import facts
from dem_cli.results.report.page import ASSETS, SCRIPTS, STYLE_SHEET, TEMPLATE, THREE, policy, script_json
from dem_cli.results.report.view import turns, view

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch, request):
    """Still pictures take longer than all the rest: only the test that asks for them has them."""
    if "pictures" not in request.node.name:
        monkeypatch.setitem(sys.modules, "matplotlib", None)


class Page(HTMLParser):
    """Tags, and the text inside some of them."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.scripts, self.inside, self.texts = [], [], [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.inside.append(tag)

    def handle_endtag(self, tag):
        while self.inside and self.inside.pop() != tag:
            pass

    def handle_data(self, data):
        if self.inside and self.inside[-1] == "script":
            self.scripts.append(data)
        elif "style" not in self.inside:
            self.texts.append(data)

    def data(self):
        return json.loads(next(text for text in self.scripts if text.startswith("{")))

    def named(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


def unpacked(array):
    """What `pack` packed."""
    return np.frombuffer(base64.b64decode(array["data"]), f"<{array['type']}")


def dem(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    return result.exit_code, result.output


def report(folder, *options):
    code, output = dem("report", folder, *options)
    assert code == 0, output
    return Page(folder / "report.html")


def test_the_page_is_beside_the_results_or_where_one_says(tmp_path):
    folder = wall(tmp_path / "wall")
    code, output = dem("report", folder)
    size = (folder / "report.html").stat().st_size
    assert (code, output) == (0, f"{folder / 'report.html'}  ({size / 1e6:.1f} MB)\n")
    assert dem("report", folder, "-o", tmp_path / "page.html")[0] == 0
    assert (tmp_path / "page.html").read_bytes() == (folder / "report.html").read_bytes()
    assert not list(folder.glob(".*"))


def test_nothing_in_the_page_points_outside(tmp_path):
    page = report(wall(tmp_path / "wall"))
    for _, attributes in page.tags:
        for name in ("src", "href", "action", "data", "poster", "srcset"):
            assert attributes.get(name, "data:").startswith("data:")
    (content,) = [meta["content"] for meta in page.named("meta") if "Security" in meta.get("http-equiv", "")]
    assert content.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in content
    assert "http" not in content


def test_it_opens_in_the_browser_where_one_asks(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr("webbrowser.open", seen.append)
    folder = wall(tmp_path / "a wall")
    report(folder)
    assert seen == []
    report(folder, "--open")
    assert seen == [(folder / "report.html").as_uri()]


def test_the_policy_knows_scripts_by_what_is_in_them():
    # printf 'x' | openssl dgst -sha256 -binary | base64
    assert "'sha256-LXEWQrcmsEQBYnyp+6wy9chTD7GQPMTbAiWHF5IaSIE='" in policy(["x"], [])


def test_texts_of_the_user_are_texts(tmp_path):
    page = report(evil(tmp_path / "evil"))
    assert len(page.scripts) == 3  # data, three.js, ours
    assert not [attributes for attributes in page.named("img") if attributes["src"] == "x"]
    assert any("<script>document.title" in text for text in page.texts)
    assert any("</pre><script>" in text for text in page.texts)
    assert page.data()["view"]["ids"][3] == "</script><img src=x onerror=document.title='hacked'>"


def test_data_cannot_leave_its_element():
    text = script_json({"a": "</script><!--\u2028", "b": float("nan")})
    assert "<" not in text
    assert "\u2028" not in text
    assert json.loads(text) == {"a": "</script><!--\u2028", "b": None}


def test_a_run_that_was_killed_has_a_page(tmp_path):
    folder = wall(tmp_path / "wall")
    (folder / "summary.json").unlink()
    page = report(folder)
    assert "unfinished" in page.texts
    assert len(page.data()["view"]["frames"]) == 12


def test_a_run_of_which_only_the_summary_was_kept(tmp_path):
    folder = wall(tmp_path / "wall")
    (folder / "results.h5").unlink()
    page = report(folder)
    assert page.data() == {"view": None, "charts": []}
    assert "0.6402" in page.texts
    assert not page.named("canvas")


def test_still_pictures(tmp_path):
    pytest.importorskip("matplotlib")
    (image,) = report(wall(tmp_path / "wall")).named("img")
    assert image["src"].startswith("data:image/png;base64,iVBOR")
    assert image["alt"] == "The structure at failure and at the end"


def test_without_matplotlib_only_these_are_missing(tmp_path):
    page = report(wall(tmp_path / "wall"))
    assert not page.named("img")
    charts = page.data()["charts"]
    assert [chart["id"] for chart in charts] == ["capacity", "monitor-0", "energy"]
    assert charts[2]["x"].startswith("largest displacement of a block [")  # a solver step says nothing to a reader


def test_charts_of_a_time_history(tmp_path):
    folder = tmp_path / "shaken"
    folder.mkdir()
    page = report(write_shaking(folder))
    found = {chart["id"]: chart for chart in page.data()["charts"]}
    assert list(found) == ["displacement", "rotation", "opening", "acceleration", "base", "energy"]
    assert [line["name"] for line in found["displacement"]["lines"]] == ["top displacement x", "top displacement y"]
    assert found["displacement"]["verticals"][0]["value"] == 4.2
    assert any("collapsed at 4.2 s" in text for text in page.texts)
    scene = page.data()["view"]
    assert scene["frames"][scene["start"]]["time"] == pytest.approx(4.2, abs=0.1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), "nowhere: no such folder; `dem run CASE.toml` makes results/CASE"),
        (("wall.toml",), "wall.toml: a case, not a folder of results; `dem run wall.toml` makes results/wall"),
        (("wall/summary.json",), "wall/summary.json: a file, not a folder of results; give the folder that it is in"),
        (("empty",), "empty: holds no results of dem run or dem sweep"),
        (("wall", "-o", "empty"), "empty: a folder; -o takes the name of a file"),
        (("broken",), "broken: these results are damaged: sweep.csv: the column 'run' is missing"),
    ],
)
def test_mistakes(tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "sweep.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    (tmp_path / "wall.toml").touch()
    wall(tmp_path / "wall")
    assert dem("report", *arguments) == (2, f"error: {message}\n")


def test_a_page_that_cannot_be_written_leaves_nothing(tmp_path):
    folder = wall(tmp_path / "wall")
    code, output = dem("report", folder, "-o", tmp_path / "no" / "page.html")
    assert code == 2 or code == 3
    assert "cannot write" in output
    assert not (tmp_path / "no").exists()


def test_a_sweep(tmp_path):
    page = report(sweep(tmp_path / "sweep"))
    runs = page.data()["runs"]
    assert runs["axes"] == {"x": "joints.dry.friction", "y": "failure_load", "family": "structure.0.bond"}
    assert runs["main"][:5] == ["run", "joints.dry.friction", "structure.0.bond", "status", "reason"]
    assert runs["links"] == {"a0": "runs/a0/summary.json"}
    assert any("7 solved, 1 failed, failure load 0.3 to 0.7" in text for text in page.texts)
    assert "1 run failed: <i>too thin</i>" in page.texts


def test_links_of_a_sweep_follow_the_page(tmp_path):
    folder = sweep(tmp_path / "my sweep")
    assert dem("report", folder, "-o", tmp_path / "page.html")[0] == 0
    assert Page(tmp_path / "page.html").data()["runs"]["links"] == {"a0": "my%20sweep/runs/a0/summary.json"}


def test_rotation_vectors_of_quaternions():
    half = 0.5 * np.array([0.0, 0.3, -2.0])
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    quaternions = np.column_stack((np.cos(half), np.sin(half)[:, None] * axis))
    np.testing.assert_allclose(turns(quaternions), 2.0 * half[:, None] * axis, atol=1e-15)
    np.testing.assert_array_equal(turns(np.array([[0.2], [-1.0]])), [[0, 0, 0.2], [0, 0, -1.0]])


def test_a_long_run_is_thinned_and_keeps_what_matters(tmp_path):
    from dem_cli.results.output.reader import read

    folder = wall(tmp_path / "wall")
    results = read(folder)
    assert view(results)["left_out"] == 0
    few = view(results, 10_000)
    assert few["left_out"] > 5
    steps = [frame["step"] for frame in few["frames"]]
    assert (steps[0], steps[-1]) == (0, 1100)
    assert few["start"] == len(steps) - 1


def test_the_view_of_a_structure_in_space(tmp_path):
    """Faces as they are, closed joints left out, strokes on the block that carries them."""
    from dem_cli.results.output.reader import read

    model = solid_wall()
    frames = solid_frames(model)
    scene = view(read(write_solid_run(tmp_path, model, frames)))
    assert scene["dimension"] == 3
    assert scene["eye"][1] > 0.7  # it falls towards +y
    assert scene["along"] == [1.0, 0.0]
    assert len(unpacked(scene["corners"])) == 3 * 8 * model.n_blocks
    assert len(unpacked(scene["edges"])) == 2 * 12 * model.n_blocks
    last = scene["frames"][-1]
    np.testing.assert_allclose(unpacked(last["turns"]).reshape(-1, 3), turns(frames[-1].orientations), atol=1e-7)
    open_or_sliding = frames[-1].contacts.state != STATES.index("sticking")
    assert len(unpacked(last["states"])) == 2 * open_or_sliding.sum()  # two halves of edges meet in a corner
    assert STATES.index("sticking") not in unpacked(last["states"])


def test_a_load_that_is_round_off_of_none_is_none(tmp_path):
    """After a collapse the view said λ = 1.364e−09."""
    from dem_cli.results.output.reader import read

    results = read(wall(tmp_path / "wall"))
    last = results.frames[-1]
    shots = [last._replace(load=load) for load in (1.364e-9, -3e-10, 0.05, -0.05)]
    said = [frame["says"] for frame in view(replace(results, frames=shots))["frames"]]
    assert said == ["λ = 0", "λ = 0", "λ = 0.05", "λ = −0.05"]


def test_the_view_of_motion_in_space(tmp_path):
    """The ground moves in three components; the picture holds all places to which blocks come, carried along by it."""
    from dem_cli.results.output.reader import read

    results = read(write_shaken_column(tmp_path / "run", 60))
    scene = view(results)
    assert scene["carried"]
    assert scene["follows"]
    series, times = results.series, [frame.time for frame in results.frames]
    ground = np.stack([np.interp(times, series.time, path) for path in series.base[:, 2].T], axis=1)
    np.testing.assert_allclose(scene["ground"], ground, atol=1e-6)
    assert not view(read(write_shaken_column(tmp_path / "few", 12)))["follows"]  # who knows which way round
    places = np.stack([frame.positions[1:] for frame in results.frames]) + ground[:, np.newaxis]
    low, high = np.array(scene["window"])
    assert (places.min(axis=(0, 1)) > low).all()
    assert (places.max(axis=(0, 1)) < high).all()
    assert (high - low < 7.0).all()  # the slab is 5 m wide
    audit = {check.name: check for check in facts.audit(results.summary, results)}
    found = audit["energy of changing areas"]
    kinetic = results.energy["kinetic"].max()
    assert found.tone == "look"
    assert found.value == f"{0.9 / kinetic:.2g} of the largest kinetic energy, net −{0.5 / kinetic:.2g}"


def test_a_structure_in_space_without_frames(tmp_path):
    folder = tmp_path / "still"
    folder.mkdir()
    summary = {"title": "t", "kind": "fragility", "status": "ok"}
    ResultWriter(folder, solid_wall(), "", {}, (), "fragility").close(summary)
    assert [frame["stage"] for frame in report(folder).data()["view"]["frames"]] == ["as built"]


def test_a_run_without_frames_shows_what_was_built(tmp_path):
    folder = tmp_path / "still"
    folder.mkdir()
    summary = {"title": "t", "kind": "fragility", "status": "ok"}
    ResultWriter(folder, wall_model(), "", {}, (), "fragility").close(summary)
    page = report(folder)
    assert [frame["stage"] for frame in page.data()["view"]["frames"]] == ["as built"]


SURE = {"level": 0.9, "median": [1.44, 1.74]}
ANSWERS = [  # kind, what else is in the summary, label, value, more
    ("gravity", {"largest_displacement": 2e-6}, "result", "stands", "largest displacement 2 µm"),
    ("settlement", {"largest_displacement": 0.02}, "result", "followed to the end", "largest displacement 20 mm"),
    ("pushover", {"failure_load": 0.64, "failure_load_bracket": [0.64, 0.65], "failure_mode": "mixed"},
     "failure load λ", "0.6400", "between 0.6400 and 0.6500, failure by sliding and rocking"),
    ("cycle", {"failure_load": None, "turning_points": [{"load": 0.8}, {"load": -0.8}]},
     "load multiplier", "−0.8 … 0.8", "followed the load path without failure"),
    ("time-history", {"collapsed": False, "peaks": {"top": {"peak": -0.0123, "unit": "m"}}}, "result", "stood",
     "top: peak −12.3 mm"),
    ("time-history", {"collapsed": True, "collapse_time": 1.5}, "result", "collapsed at 1.5 s", ""),
    ("fragility", {"median": 1.6, "dispersion": 0.02, "confidence": SURE, "unit_acceleration": 3.2,
                   "collapse_intensities": [1.6, None]},
     "half collapse at intensity", "1.6", "5.12 m/s², dispersion 0.02, 90 % confidence 1.44 to 1.74, 2 records"),
    ("fragility", {"median": None}, "half collapse at", "no median", "ok"),
    ("modes", {"frequencies": [3.5, 7.0]}, "first frequency", "3.5 Hz", "2 modes"),
    ("safety", {"vary": "strength", "safety_factor": 1.66, "stands_at": 1.66, "fails_at": 1.67},
     "factor of safety", "1.66", "stands at 1.66, fails at 1.67"),
    ("safety", {"vary": "structure.0.ring", "critical_value": 0.1}, "critical structure.0.ring", "0.1", ""),
    ("limit", {"limit_analysis": {"associated": 0.15, "non_associated": 0.14}}, "failure load λ", "0.1400",
     "non-associated 0.1400, associated 0.1500"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "found", "label", "value", "more"), ANSWERS)
def test_the_answer_of_each_kind_in_one_line(kind, found, label, value, more):
    assert facts.answer({"kind": kind, "status": "ok", **found}) == (label, value, more, "good")


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_was_stopped_says_so(kind):
    answer = facts.answer({"kind": kind, "status": "interrupted"})
    assert "interrupted" in answer.value + answer.more
    assert answer.tone == "bad"


def test_an_audit_that_finds_something(tmp_path):
    from dem_cli.results.output.reader import read

    results = read(wall(tmp_path / "wall"))
    assert [check.tone for check in facts.audit(results.summary, results)] == ["good", "good", "good", "good"]
    doubtful = {**results.summary, "status": "not converged", "energy_closure": -0.02, "largest_overlap": 0.1}
    results.history["unbalanced"][results.history["stage"] == "gravity"] = 1e-3
    assert [check.tone for check in facts.audit(doubtful, results)] == ["bad", "bad", "bad", "look"]


def test_what_counts_as_balanced_is_what_the_solver_asks_for():
    from dem_cli.core.engine.settings import DEFAULT

    assert DEFAULT.relaxation.gravity_tolerance == facts.BALANCED


def test_colours_of_stages_and_lines_are_in_the_style_sheet():
    from dem_cli.core.records.frames import STAGES, STATES
    from dem_cli.results.report import charts

    style = (ASSETS / "page.css").read_text(encoding="utf-8")
    names = [f"line-{name}" for name in (*STAGES, *map(str, range(charts._PALETTE)), "ink", "failure", "limit")]
    for name in (*names, *STATES, "hairline", "stone", "ground", "ghost", "force", "accent", "section"):
        assert len(re.findall(rf"--{name}:", style)) >= 2, f"--{name}, light and dark"


def test_everything_the_page_is_made_of_is_packaged():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["dem_cli.results.report"]
    kept = {path for pattern in patterns for path in ASSETS.parent.glob(pattern)}
    assert kept == set(ASSETS.iterdir())
    assert {path.name for path in kept} >= {TEMPLATE, STYLE_SHEET, THREE, *SCRIPTS}


def test_three_comes_with_its_licence():
    head = (ASSETS / THREE).read_text(encoding="utf-8")[:2000]
    assert "The MIT License" in head
    assert "Copyright © 2010-2026 three.js authors" in head
