"""`scripts/benchmark` measures every group and says what it left out; nothing is asserted about time."""

from __future__ import annotations

import json
from pathlib import Path

import numba
import pytest
from bench import __main__ as benchmark
from bench import joints, kernels, others, precision, registry, sweeps, time_histories
from bench.cases import KNOWN_STRUCTURES
from bench.spatial import sizes
from bench.spatial.cases import wall_out_of_plane
from click.testing import CliRunner

import dem_cli
from dem_cli.app.cli import main as cli
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.kernels.compilation import machine_code
from dem_cli.masonry.assembly.solver_request import solver_request


def bench(*words: str):
    return CliRunner().invoke(benchmark.command, words)


COMPILED = ("coulomb",)  # of the joint models
STEPPED = (kernels.FIXED, kernels.LARGE, "fixed, 3D", "time history")  # of the kinds of steps


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """All groups, of each a little: joint models and kinds of steps are compiled one by one."""
    folder = tmp_path_factory.mktemp("bench")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(joints, "VARIANTS", {name: joints.VARIANTS[name] for name in COMPILED})
        patch.setattr(kernels, "KINDS", tuple(kind for kind in kernels.KINDS if kind.name in STEPPED))
        patch.setattr(sweeps, "FEW_RUNS", 2)
        patch.setattr(precision, "QUICK_CASES", ("COL14",))
        patch.setattr(time_histories, "QUICK_MARGINS", (time_histories.USUAL,))
        patch.setattr(time_histories, "DASHPOTS", {"dashpots": []})
        patch.setattr(precision, "AXES", (precision.AXES[0], precision.AXES[-1]))
        patch.setattr(sizes, "SIZES_IN_SPACE", (wall_out_of_plane(4, 6),))
        done = bench("--quick", "--json", str(folder / "all.json"), "-o", str(folder / "page"))
    assert done.exit_code == 0, done.output
    return folder, json.loads((folder / "all.json").read_text("utf-8"))["groups"]


def test_quick_measures_every_group(quick):
    _, groups = quick
    assert list(groups) == list(registry.GROUPS)
    for name, group in groups.items():
        assert group["records"], name
        for record in group["records"]:
            assert 0.0 < record["best"] <= record["median"], record
        assert {"cores", "processor", "numpy", "numba", "load"} <= set(group["machine"])


@pytest.mark.parametrize("name", joints.VARIANTS)
def test_joint_models_are_valid(name):
    case, model = joints.with_joint(KNOWN_STRUCTURES[joints.QUICK_CASE], joints.VARIANTS[name], joints.OTHER).build()
    assert set(case.joints) == {"dry", "other"}
    assert law_of(solver_request(case)).bonded  # as the other joint is
    joint_properties(solver_request(case), model)


def test_compiled_code_stays_in_its_folder(quick):
    """Elsewhere it would not be told apart from that of older sources."""
    assert str(machine_code.cache_folder()) == numba.config.CACHE_DIR


def test_quick_answers_are_right(quick):
    _, groups = quick
    for record in groups["growth"]["records"]:
        assert abs(record["found"]["error"]) < 0.01
    for record in groups["precision"]["records"]:
        if record["axis"] == "resolution":
            assert abs(record["found"]["error"]) < record["value"] + 1e-4
    for record in groups["peers"]["records"]:
        if record["axis"] in ("dem", "dem limit"):
            assert abs(record["found"]["error"]) < 1e-4
    for record in groups["spatial"]["records"]:
        if record["axis"] != "memory":
            assert record["found"]["load"] > 0.08  # thickness over height: columns behind the ends hold the wall


def test_quick_leaves_a_page_and_pictures(quick):
    folder, groups = quick
    text = (folder / "page" / "benchmarks.md").read_text("utf-8")
    assert all(f"## {title}" in text for title in registry.GROUPS.values())
    assert json.loads((folder / "page" / "data" / "benchmarks.json").read_text("utf-8"))["groups"] == groups
    assert {path.name for path in (folder / "page").glob("*.png")} == {
        f"benchmarks_{suffix}.png" for name in registry.GROUPS for suffix in registry.module(name).PICTURES
    }


def test_redraw_measures_nothing(quick):
    folder, _ = quick
    page = folder / "page" / "benchmarks.md"
    before = page.read_text("utf-8")
    page.write_text("gone", encoding="utf-8")
    assert bench("--redraw", "-o", str(folder / "page")).exit_code == 0
    assert page.read_text("utf-8") == before


def test_engines_that_are_not_installed_are_left_out_and_named(monkeypatch):
    monkeypatch.setattr(others, "find_spec", lambda name: None)
    done = bench("others", "--quick", "--json", "-")
    assert done.exit_code == 0, done.output
    group = json.loads(done.stdout)["groups"]["others"]
    assert {record["axis"] for record in group["records"]} == {"dem"}
    assert [note.split(":")[0] for note in group["notes"]] == ["pymunk was left out", "Box2D was left out"]


def test_an_unknown_group_is_named_with_those_that_exist():
    done = bench("speed")
    assert done.exit_code == 2
    assert done.stderr == f"error: no benchmark group 'speed' (groups: {', '.join(registry.GROUPS)})\n"


def test_redraw_needs_a_folder_with_results(tmp_path):
    assert bench("--redraw").stderr == "error: --redraw needs the folder of benchmarks.json: -o DIR\n"
    assert bench("--redraw", "-o", str(tmp_path)).exit_code == 2


def test_places_that_cannot_be_written_are_said_before_measuring(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    done = bench("--json", str(tmp_path / "none" / "all.json"))
    assert (done.exit_code, done.stderr) == (2, f"error: --json {tmp_path}/none/all.json: there is no such folder\n")
    done = bench("-o", str(tmp_path / "file" / "page"))
    assert (done.exit_code, done.stderr) == (2, f"error: -o {tmp_path}/file/page: Not a directory\n")


def test_help_names_every_group():
    assert all(name in benchmark.command.help for name in registry.GROUPS)


def test_dem_names_the_place_of_its_benchmarks_and_holds_none():
    done = CliRunner().invoke(cli.main, ["bench", "kernels"])
    assert done.exit_code == 2
    assert "scripts/benchmark" in done.stderr
    assert "bench" not in cli.COMMANDS
    assert not (Path(dem_cli.__file__).parent / "app" / "bench").exists()
