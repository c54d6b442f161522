"""What is most often a slip: each gets a word with the likely unit, in `dem check` and in the summary of a run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from casefiles import FILES
from click.testing import CliRunner

from dem_cli.app.api import build_model, load_case
from dem_cli.app.cli.main import main
from dem_cli.errors import CaseError

ROOT = Path(__file__).resolve().parents[3]
TEMPLATES = sorted((ROOT / "dem_cli/app/cli/templates").glob("*.toml"))
WALL = """
[materials.stone]
density = 2000.0
[joints.dry]
law = "mohr-coulomb"
friction = 0.6
[[structure]]
kind = "wall"
block = [0.4, 0.2]
courses = 6
blocks_per_course = 3
thickness = 0.3
[analysis]
kind = "gravity"
"""
PUSHED = WALL.replace('"gravity"', '"pushover"')
LIVE = '[[load]]\nblock = "wall-6-1"\nforce = [100.0, 0.0]\nkind = "live"\n'
PRESSED = '[[load]]\nblock = "wall-6-1"\nforce = [0.0, -4e3]\n'
PRESS = "load.0: dead loads of 4e+03 N beside blocks of 8.48e+03 N press, but"
DRAWN = "what is a mass, such as a roof or a floor, is drawn as a block"
SHARE = "inertia = true gives a load its share"
UNSHAKEN = 'duration = 1.0\n[[motion]]\nkind = "none"\n'


def said(tmp_path, text: str) -> list[str]:
    """The warnings about a case, without file, line and column."""
    path = tmp_path / "case.toml"
    path.write_text(text, encoding="utf-8")
    loaded = load_case(path)
    build_model(loaded)
    return [str(warning).split(": ", 1)[1] for warning in loaded.warnings]


UNITS = [
    ("density = 2000.0", "density = 23000.0", "materials.stone.density: 23000 kg/m3 is unusual for a building "
     "material, did you mean 2345 (23000 N/m3)?"),
    ("density = 2000.0", "density = 2.1", "materials.stone.density: 2.1 kg/m3 is unusual for a building material, "
     "did you mean 2100 (2.1 g/cm3)?"),
    ("density = 2000.0", "density = 21.0", "materials.stone.density: 21 kg/m3 is unusual for a building material, "
     "did you mean 2141 (21 kN/m3)?"),
    ("friction = 0.6", "friction_angle_deg = 0.6", "joints.dry.friction_angle_deg: 0.6 deg is unusual for a friction "
     "angle, did you mean 34.38 (0.6 rad) or friction = 0.6?"),
    ("friction = 0.6", "friction = 3.5", "joints.dry.friction: 3.5 is unusual for tan(phi), phi = 74.1 deg; an "
     "angle is given as friction_angle_deg"),
    ("friction = 0.6", "friction = 0.6\ncohesion = 0.1", "joints.dry.cohesion: 0.1 Pa is unusual for a joint, did you "
     "mean 1e+05 (0.1 MPa)?"),
    ("thickness = 0.3", "thickness = 200.0", "structure.0.thickness: 200 m is unusual for a structure 1.7 m in size, "
     "did you mean 0.2 (200 mm) or 2 (200 cm)?"),
    ("thickness = 0.3", "thickness = 30.0", "structure.0.thickness: 30 m is unusual for a structure 1.7 m in size, "
     "did you mean 0.03 (30 mm) or 0.3 (30 cm)?"),
    ("block = [0.4, 0.2]", "block = [400.0, 200.0]", "structure.0: block 'wall-1-2': 282.8 m is unusual for "
     "the size of blocks, root of their area, did you mean 0.2828 (282.8 mm) or 2.828 (282.8 cm)?"),
    ("block = [0.4, 0.2]", "block = [40.0, 17.5]", "structure.0: block 'wall-1-2': 26.46 m is unusual for the "
     "size of blocks, root of their area, did you mean 0.02646 (26.46 mm) or 0.2646 (26.46 cm)?"),
    ('kind = "gravity"', 'kind = "gravity"\n' + LIVE, "load.0.kind: not used: kind = 'gravity' has no live load"),
    ('"gravity"', '"pushover"\n' + LIVE + LIVE, "load.0.kind: not used (and 1 more): the live load of pattern = 'mass' "
     "is the weight of the blocks; point loads and pressures take part with pattern = 'live'"),
    ('"gravity"', '"pushover"\ndirection = [0.0, -1.0]', "analysis.direction: along gravity: blocks become heavier, "
     "and nothing pushes them sideways"),
    ('"gravity"', '"pushover"\ndirection = [0.0, 2.0]', "analysis.direction: along gravity: blocks become lighter, and "
     "nothing pushes them sideways"),
    ('"gravity"', '"pushover"\npattern = "live"\ndirection = [0.0, 1.0]\n' + LIVE, "analysis.direction: not used: "
     "pattern = 'live' has its own directions"),
    ('"gravity"', '"gravity"\n[[load]]\nblock = "wall-base"\nforce = [1.0, 0.0]', "load.0.block: block 'wall-base' is "
     "fixed: a load on it changes nothing"),
    ('"gravity"', '"gravity"\n[[load]]\nblock = "wall-6-1"\nforce = [1.0, 0.0]\nat = [-0.5, 1.1]', "load.0.at: "
     "[-0.5, 1.1] is 0.5 m off block 'wall-6-1': an arm that turns it"),
    ('"gravity"', f'"pushover"\n{PRESSED}', f"{PRESS} are no part of the live load: {SHARE}"),
    ('"gravity"', f'"time-history"\n{UNSHAKEN}{PRESSED}', f"{PRESS} have no inertia: {DRAWN}"),
    ('"gravity"', '"pushover"\npattern = "live"\n' + LIVE.replace("100.0", "1.3"), "load.0.force: live loads of "
     "1.3 N in all beside a weight of 8.48e+03 N; did you mean kN?"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "words"), UNITS)
def test_a_doubt(old, new, words, tmp_path):
    assert WALL.count(old) == 1
    assert said(tmp_path, WALL.replace(old, new)) == [words]


@pytest.mark.parametrize("new", [
    "block = [0.04, 0.0175]", "block = [3.0, 1.5]", "block = [5.0, 4.0]",
])  # fmt: skip
def test_no_doubt_about_models_and_monuments(new, tmp_path):
    assert said(tmp_path, WALL.replace("block = [0.4, 0.2]", new).replace("= 0.3", "= 0.08")) == []


@pytest.mark.parametrize("at", ["[0.0, 1.1]", "[-0.001, 1.1]", "[0.1, 1.05]"])
def test_no_doubt_about_loads_on_their_block(at, tmp_path):
    text = f'{PUSHED}pattern = "live"\n{LIVE}at = {at}\n'
    assert said(tmp_path, text) == []


def test_no_doubt_about_a_load_of_one_newton_that_is_multiplied(tmp_path):
    assert said(tmp_path, f'{PUSHED}pattern = "live"\n{LIVE.replace("100.0", "1.0")}') == []


def test_a_joint_between_no_blocks_is_named(tmp_path):
    bed = WALL.replace("[[structure]]", "[joints.bed]\nfriction = 0.3\n[[structure]]", 1)
    assert said(tmp_path, bed) == ["joints.bed: lies between no blocks: no [[interface]] names it"]
    met = bed.replace("[joints.bed]", '[[interface]]\nbetween = ["stone", "stone"]\njoint = "bed"\n[joints.bed]')
    assert "joints.dry: lies between no blocks" in said(tmp_path, met)[0]


def test_a_depth_that_is_varied_under_point_loads_is_doubted(tmp_path):
    varied = 'vary = "structure.0.thickness"\nbetween = [0.1, 1.0]\npattern = "live"\n'
    safety = WALL.replace('"gravity"', '"safety"') + varied + LIVE
    assert any("thickness is the depth out of plane" in text for text in said(tmp_path, safety))
    assert not any("depth" in text for text in said(tmp_path, safety.replace("0.thickness", "0.block.0")))


def test_no_doubt_about_small_dead_loads_and_tilting(tmp_path):
    dead = '[[load]]\nblock = "wall-6-1"\nforce = [0.0, -{}]\n'
    assert said(tmp_path, PUSHED + dead.format(400.0)) == []
    assert said(tmp_path, f'{PUSHED}pattern = "tilt"\n{dead.format(4e3)}') == []


@pytest.mark.parametrize("friction", [0.0, 0.2, 1.2, 5.0, 10.0, 100.0])
def test_no_doubt_about_friction(friction, tmp_path):
    assert said(tmp_path, WALL.replace("friction = 0.6", f"friction = {friction}")) == []


def test_a_heavy_material_beside_a_usual_one_is_a_load(tmp_path):
    assert said(tmp_path, WALL.replace("[joints.dry]", "[materials.load]\ndensity = 61035.0\n[joints.dry]")
                .replace('kind = "wall"', 'kind = "wall"\nmaterial = "stone"')) == []  # fmt: skip


@pytest.mark.parametrize("path", [*FILES, *TEMPLATES], ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_no_false_alarm(path):
    loaded = load_case(path)
    build_model(loaded)
    assert not [warning for warning in loaded.warnings if "unusual" in warning or "not used" in warning]


def test_a_load_far_off_its_block_is_a_mistake(tmp_path):
    text = f'{PUSHED}pattern = "live"\n{LIVE}at = [50.0, 1.1]\n'
    with pytest.raises(CaseError, match=r"load.0.at: \[50, 1.1\] is 49.6 m off block 'wall-6-1'; the structure lies"):
        said(tmp_path, text)


@pytest.mark.parametrize("kn", [10.0, 1e3])
def test_joints_that_cannot_carry_the_wall(kn, tmp_path):
    """The lowest joints carry 6 courses of 0.2 m, 2000·9.81·1.2 = 23.5 kPa: they sink by 23.5/kn km."""
    with pytest.raises(CaseError) as caught:
        said(tmp_path, WALL.replace("friction = 0.6", f"friction = 0.6\nkn = {kn}"))
    sinks = 2000 * 9.81 * 1.2 / kn
    assert f"kn: {kn:g} Pa/m is too soft: blocks would sink {sinks:.3g} m into each other" in str(caught.value)
    assert f"{sinks / 0.2:.2g} smallest edges (at most 0.5); did you mean {kn:g} N/mm3 or GPa/m" in str(caught.value)


def test_the_softest_joints_that_are_allowed(tmp_path):
    """Half the smallest edge, 0.1 m, is 235 kPa/m."""
    assert said(tmp_path, WALL.replace("friction = 0.6", "friction = 0.6\nkn = 2.36e5")) == []
    with pytest.raises(CaseError, match="too soft"):
        said(tmp_path, WALL.replace("friction = 0.6", "friction = 0.6\nkn = 2.35e5"))


def test_check_and_run_show_it(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(WALL.replace("density = 2000.0", "density = 23000.0").replace("= 0.3", "= 200.0"), encoding="utf-8")
    checked = CliRunner().invoke(main, ["check", str(path)])
    assert "23000 N/m3" in checked.stderr
    assert "200 mm" in checked.stderr
    done = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "out"), "--json"])
    warnings = " ".join(json.loads(done.stdout)["warnings"])
    assert "23000 N/m3" in warnings
    assert "200 mm" in warnings


def test_slivers_of_a_wall(tmp_path):
    """A window 20 mm off the grid of blocks; with a length in place of blocks_per_course none is left."""
    window = "openings = [{ x = 0.42, y = 0.4, width = 0.4, height = 0.4 }]\n"
    off = WALL.replace("thickness = 0.3\n", "thickness = 0.3\n" + window)
    assert said(tmp_path, WALL) == []
    assert said(tmp_path, off) == [
        "structure.0: block 'wall-4-2' is 0.05 of a full one: ends and openings are off the grid of blocks; length in "
        "place of blocks_per_course lays none"
    ]
    assert said(tmp_path, off.replace("blocks_per_course = 3", "length = 1.2")) == []
