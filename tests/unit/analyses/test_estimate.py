"""`estimate.describe`: what `dem check` says about joints, stiffness, time step and cost."""

from __future__ import annotations

from pathlib import Path

import pytest

from dem_cli.analyses import estimate_cost
from dem_cli.analyses.estimate import describe
from dem_cli.app import api
from dem_cli.core.engine import loops
from dem_cli.errors import CaseError

CASES = Path(__file__).resolve().parents[3] / "cases" / "verification"


def rows(name: str, *overrides: str) -> dict[str, str]:
    loaded = api.load_case(CASES / f"{name}.toml", overrides)
    return dict(describe(loaded.case, api.build_model(loaded)))


def test_blocks_that_deform_on_joints_of_any_stiffness():
    """On rigid joints it said: kn h/E inf."""
    young = "materials.peperino.young=2e9"
    assert rows("wall_21", young)["with blocks dry"].endswith(" Pa/m, that of the blocks, on rigid joints")
    given = rows("wall_21", young, "joints.dry.kn=1e11")["with blocks dry"]
    # from half of 0.0175 m, at the foot, to heads between blocks of 0.04 m
    assert given.endswith(" Pa/m, kn h/E 0.4375 to 2")


def test_wall_of_21_blocks(monkeypatch):
    monkeypatch.setattr(loops, "make_advance", None)  # the stepping loop is not even made
    loops.compiled_advance.cache_clear()
    found = rows("wall_21")
    # 3 + 4 blocks in turn: 4 bed joints below, 5 × 6 between courses; 3 + 2 head joints three times.
    assert found["joints"] == "49, 98 contact points"
    assert found["joint dry"] == "34 bed joints, 15 others"
    # 18 whole blocks' worth of 0.04 × 0.0175 × 0.08 m, 2143 kg/m3, 9.81 m/s2
    assert float(found["weight"].split()[0]) == pytest.approx(18 * 5.6e-5 * 2143 * 9.81, rel=1e-5)
    assert found["smallest block"] == "'wall-1-1', 0.06 kg"
    assert found["largest block"] == "'wall-1-2', 0.12 kg"
    assert "kn·h/W 1e+10, kn and ks chosen (auto)" in found["stiffness dry"]
    assert found["kinematics"].startswith("fixed (auto): all joints are closed")
    assert "(as 40,000 to 500,000 steps × 98 points × 10 ns" in found["cost"]
    assert found["first run"].startswith("2 to ")  # s of compiling, which the cost leaves out
    assert found["memory"].startswith("some 25")  # a run of it was seen to take 284 MB
    assert found["load"].startswith("mass: λ × weight of each block along [1.0, 0.0]; [21.19, 0] N")
    assert found["monitors"] == "displacement of 'top-right'"


def test_wall_of_231_blocks():
    found = rows("wall_3")
    # 11 + 21 × 20 bed joints; 10 and 9 head joints in 11 courses each.
    assert found["joints"] == "640, 1,280 contact points"
    assert found["joint dry"] == "431 bed joints, 209 others"


@pytest.mark.parametrize("slower", [1.0, 2.0])
def test_seconds_are_those_of_this_core(monkeypatch, slower):
    """START, 40,000 to 500,000 steps of 98 points at 10 ns, 30,000 to 120,000 of the collapse at 20 ns."""
    monkeypatch.setattr(estimate_cost, "slowness", lambda: slower)
    said = rows("wall_21")["cost"]
    low, high = (float(said.split()[i]) for i in (0, 3))
    assert low == pytest.approx(slower * (0.33 + 98e-9 * (40_000 * 10 + 30_000 * 20)), rel=0.05)  # two figures
    assert high == pytest.approx(slower * (0.9 + 98e-9 * (500_000 * 10 + 120_000 * 20)), rel=0.05)
    assert f"{slower:.2g} times the seconds of docs/benchmarks.md" in said


def test_a_core_has_a_speed():
    """A loop of Python takes from a tenth to ten times the seconds of the benchmarks, on whatever runs this."""
    assert 0.1 < estimate_cost.slowness() < 10.0


STONES = """
dimension = {dimension}
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "voronoi-wall"
cells = 12
size = {size}
seed = 3
[analysis]
kind = "pushover"
direction = {direction}
"""


@pytest.mark.parametrize(
    ("dimension", "size", "direction", "steps"),
    [
        (2, "[2.0, 2.0]\nthickness = 0.5", "[1.0, 0.0]", "120,000 to 2,000,000"),
        (3, "[2.0, 2.0, 0.5]", "[0.0, 1.0, 0.0]", "300,000 to 1,600,000"),
    ],
)
def test_rubble_takes_longer_than_courses(tmp_path, dimension, size, direction, steps):
    path = tmp_path / "rubble.toml"
    path.write_text(STONES.format(dimension=dimension, size=size, direction=direction))
    loaded = api.load_case(path)
    assert f"as {steps} steps" in dict(describe(loaded.case, api.build_model(loaded)))["cost"]


@pytest.mark.parametrize("name", ["drum_column", "arch_21"])
def test_columns_and_arches_are_no_rubble(name):
    """Seven drums have seven weights."""
    assert "as 40,000 to 500,000 steps" in rows(name)["cost"]


def test_what_is_computed_beside_a_failure_load_is_said():
    assert rows("wall_21")["beside it"].startswith("the path of joints that do not dilate where limit analysis")
    large = ("structure.0.courses=20", "structure.0.blocks_per_course=10")
    assert rows("wall_21", *large)["beside it"].startswith(
        "where friction takes part in the bound: an implicit history from gravity to failure, and a path; where two"
    )
    moving = rows("wall_21", "analysis.kinematics='large'")["beside it"]
    assert moving == "the same loads once more on joints 10 times as soft"
    assert "beside it" not in rows("wall_21", "analysis.kinematics='large'", "joints.dry.kn=1e9", "joints.dry.ks=1e9")


def test_a_large_wall_is_raised_from_a_smoothed_path():
    assert "path" not in rows("wall_21")
    said = rows("wall_21", "structure.0.courses=41", "structure.0.blocks_per_course=40")["path"]
    assert said.startswith("one structure of 1,661 blocks: a smoothed path leads next to failure")


def test_the_step_that_real_masses_would_allow():
    # A free block on two springs K/2: the bound of the highest frequency is the one of Gershgorin.
    found = rows("sliding_block", "joints.dry.kn=1e9", "joints.dry.ks=1e9", "analysis.kinematics='fixed'")
    assert "'" in found["time step"]
    soft = rows("sliding_block", "joints.dry.kn=1e7", "joints.dry.ks=1e7", "analysis.kinematics='fixed'")
    step, longer = (float(text["time step"].split()[-2]) for text in (found, soft))
    assert longer == pytest.approx(10 * step, rel=0.05)
    assert "kn 1e+09 Pa/m, ks 1e+09 Pa/m" in found["stiffness dry"]
    assert "auto" not in found["stiffness dry"]
    assert found["kinematics"] == "fixed (as the case says)"


def test_a_named_block_limits_the_step():
    found = rows("wall_21", "joints.dry.kn=1e9", "joints.dry.ks=1e9")
    assert "with real masses 'wall-" in found["time step"]


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda p: p.stem)
def test_every_case_is_described(path):
    assert {"joints", "time step", "cost", "load"} <= set(rows(path.stem))


SHAKEN = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
kn = 1e9
ks = 1e9
[[structure]]
kind = "column"
block = [1.0, 2.0]
courses = 1
base_extension = 1.0
[motion]
kind = "pulse"
shape = "sine"
amplitude = 3.0
frequency = 0.5
[analysis]
kind = "time-history"
duration = 5.0
"""


def shaken(tmp_path, *overrides: str) -> dict[str, str]:
    path = tmp_path / "case.toml"
    path.write_text(SHAKEN)
    loaded = api.load_case(path, overrides)
    return dict(describe(loaded.case, api.build_model(loaded)))


def test_time_history(tmp_path, monkeypatch):
    monkeypatch.setattr(loops, "make_advance", None)
    loops.compiled_advance.cache_clear()
    found = shaken(tmp_path, "analysis.margin=0.5")
    # Sliding and rocking of one block (numerics.md): ω² of K/M are 2 ± √3.4, K/M = 1e9/4000.
    highest, lowest = ((1e9 / 4000 * (2 + sign * 3.4**0.5)) ** 0.5 for sign in (1, -1))
    assert found["highest frequency"] == f"'column-1' on 'column-base' vibrates at {highest / 6.283185307:.4g} Hz"
    assert found["time step"].startswith(f"{1 / highest:.3g} s, 0.5 of the largest stable one, {2 / highest:.3g} s")
    assert float(found["first frequency"].split()[0]) == pytest.approx(lowest / 6.283185307, rel=1e-3)
    assert found["steps"] == f"{int(5.0 * highest) + 1:,}"
    assert f"({found['steps']} steps × (2 points × 55 ns + 0.4 µs); this core" in found["cost"]
    assert found["load"] == "5 s of motion, peak 3 m/s²"
    assert "runs" not in found
    automatic = shaken(tmp_path, "joints.dry.kn='auto'", "joints.dry.ks='auto'")
    assert automatic["runs"].startswith("one more on joints 10 times as soft where blocks rock or slide")
    assert "and once more on softer joints; this core" in automatic["cost"]
    repeated = shaken(tmp_path, "analysis.margin=0.5", "analysis.repeats=9")
    assert repeated["runs"] == "10 with repeats"
    assert f"(10 runs × {found['steps']} steps" in repeated["cost"]
    half = shaken(tmp_path, "analysis.margin=0.25")
    assert half["time step"].startswith(f"{0.5 / highest:.3g} s, 0.25 of")


def test_a_step_above_the_limit_is_refused_before_the_run(tmp_path):
    with pytest.raises(CaseError, match=r"analysis\.time_step: 0\.01 s is above .* 'column-1' on 'column-base'"):
        shaken(tmp_path, "analysis.time_step=0.01")


def test_time_history_that_says_no_duration(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(SHAKEN.replace("duration = 5.0", "").replace('kind = "pulse"', 'kind = "none"'))
    text = path.read_text()
    for key in ("shape", "amplitude", "frequency"):
        text = "\n".join(line for line in text.splitlines() if not line.startswith(key))
    path.write_text(text)
    loaded = api.load_case(path)
    with pytest.raises(CaseError, match=r"analysis\.duration: missing"):  # as a run says it
        describe(loaded.case, api.build_model(loaded))


@pytest.mark.parametrize(
    ("levels", "runs"),
    [
        ("intensities = [1.0, 2.0, 3.0]", "4 records × 3 intensities: 12"),
        ("lowest = 1.0\nhighest = 5.0\nresolution = 0.5", "4 records × 5 steps of bisection: at most 20"),
    ],
)
def test_fragility(tmp_path, levels, runs):
    text = SHAKEN.replace("time-history", "fragility").replace("duration = 5.0", levels)
    start, end = text.index("[motion]"), text.index("[analysis]")
    motion = '[motion]\nkind = "artificial"\nspectrum = "EC8-1"\nsoil = "B"\nag = 2.0\nduration = 20.0\ncount = 4\n'
    path = tmp_path / "case.toml"
    path.write_text(text[:start] + motion + text[end:])
    loaded = api.load_case(path)
    found = dict(describe(loaded.case, api.build_model(loaded)))
    assert found["runs"] == runs
    assert found["load"] == "20 s of motion"
    assert f"({int(runs.split()[-1])} runs × " in found["cost"]


def test_a_displacement_that_is_prescribed_moves_the_geometry():
    keys = ("analysis.control='displacement'", "analysis.follow=0.01")
    assert rows("sliding_block", *keys)["kinematics"] == "large: the live load is moved as far as the case says"
    assert rows("sliding_block", *keys, "analysis.kinematics='fixed'")["kinematics"] == "fixed (as the case says)"


def test_a_settlement_that_may_collapse_takes_longer():
    """Of four walls on ground that turns 14 to 45 s where 1.4 s were said."""
    assert "where it collapses" in rows("settlement_portal")["cost"]
    assert "where it collapses" not in rows("wall_21")["cost"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("control = 'displacement'\nfollow = 0.01\n", "4 bed joints, 0 others, pressure integrated over the faces"),
        (
            "kinematics = 'fixed'\n",
            "4 bed joints, 0 others, 5 contact points each (auto): kn is given, so that bending counts",
        ),
    ],
)
def test_what_a_joint_has_for_its_stiffness(tmp_path, more, said):
    path = tmp_path / "case.toml"
    path.write_text(
        "[materials.stone]\ndensity = 2000.0\n[joints.dry]\nfriction = 0.6\nkn = 1e9\n"
        "[[structure]]\nkind = 'column'\ncourses = 4\nblock = [1.0, 0.5]\n"
        f"[analysis]\nkind = 'pushover'\n{more}"
    )
    loaded = api.load_case(path)
    assert dict(describe(loaded.case, api.build_model(loaded)))["joint dry"] == said
