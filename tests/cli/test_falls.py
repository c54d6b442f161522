"""A structure that falls under its given loads: exit code 1 of every kind, unless a reference expects it."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

import dem_cli
from dem_cli.app.cli.main import main
from dem_cli.core.records.statuses import FALLS

BLOCK = """
title = "a block beyond the edge"
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[block]]
id = "table"
vertices = [[-2.0, -0.5], [0.0, -0.5], [0.0, 0.0], [-2.0, 0.0]]
fixed = true
[[block]]
id = "b"
vertices = [[LEFT, 0.0], [RIGHT, 0.0], [RIGHT, 0.5], [LEFT, 0.5]]
"""
KINDS = {
    "gravity": "",
    "pushover": "",
    "modes": "",
    "settlement": '[[settlement]]\nblock = "table"\ndisplacement = [0.0, -0.001]',
    "cycle": "path = [0.1]\nstep = 0.1",
    "time-history": 'duration = 0.1\n[motion]\nkind = "pulse"\namplitude = 0.1\nfrequency = 10.0',
    "fragility": 'intensities = [0.1]\nduration = 0.1\n[motion]\nkind = "pulse"\namplitude = 0.1\nfrequency = 10.0',
    "safety": "",
}
EXPECTED = f'[reference]\nquantity = "status"\nvalue = "{FALLS}"\n'
UNRELATED = '[reference]\nquantity = "blocks"\nvalue = 2\ntolerance = 0.5\n'


def written(folder, kind: str, left: float = -0.4, more: str = "") -> str:
    """A block 1 m long whose left end is at `left`: it stands from its middle on the table on, left < −0.5."""
    text = BLOCK.replace("LEFT", str(left)).replace("RIGHT", str(left + 1.0))
    path = folder / "case.toml"
    path.write_text(f'{text}[analysis]\nkind = "{kind}"\n{KINDS[kind]}\n{more}', encoding="utf-8")
    return str(path)


def ran(folder, *words: str):
    return CliRunner().invoke(main, [words[0], *words[1:], "-o", str(folder / "out"), "--json", "-q"])


@pytest.mark.parametrize("kind", KINDS)
def test_exit_code(kind, tmp_path):
    done = ran(tmp_path, "run", written(tmp_path, kind))
    summary = json.loads(done.stdout)
    assert done.exit_code == 1, done.output
    if kind == "safety":  # it is the shape that makes it fall: less strength than its own or more makes no difference
        assert summary["status"] == "fails even at F = 0.05"
        assert "it does not stand as it is: it fails at F = 1, with the strengths of the case" in summary["warnings"]
    else:
        assert summary["status"] == FALLS
        assert not [text for text in summary["warnings"] if "damping" in text or "repeats" in text]


@pytest.mark.parametrize(("more", "code"), [(EXPECTED, 0), (UNRELATED, 1)])
def test_a_reference_may_expect_it(more, code, tmp_path):
    case = written(tmp_path, "gravity", more=more)
    assert ran(tmp_path, "run", case).exit_code == code
    assert CliRunner().invoke(main, ["verify", case, "-q"]).exit_code == code
    with dem_cli.run(case) as result:
        assert (result.status, result.exit_code) == (FALLS, code)


def test_what_stands_is_zero(tmp_path):
    assert ran(tmp_path, "run", written(tmp_path, "gravity", left=-0.6)).exit_code == 0


def test_limit_analysis_says_the_same(tmp_path):
    assert ran(tmp_path, "limit", written(tmp_path, "pushover")).exit_code == 1
    assert ran(tmp_path, "limit", written(tmp_path, "pushover", left=-0.6), "--force").exit_code == 0


def test_a_sweep_counts_them(tmp_path):
    sweep = (
        '[sweep]\n"block.1.vertices" = ['
        + ", ".join(f"[[{x}, 0.0], [{x + 1}, 0.0], [{x + 1}, 0.5], [{x}, 0.5]]" for x in (-0.6, -0.4))
        + "]\n"
    )
    done = ran(tmp_path, "sweep", written(tmp_path, "gravity", more=sweep), "-j", "1")
    assert (done.exit_code, json.loads(done.stdout)["do not stand"]) == (0, 1)


def test_a_fall_before_the_motion_is_not_blamed_on_damping(tmp_path):
    done = ran(tmp_path, "run", written(tmp_path, "time-history"))
    summary = json.loads(done.stdout)
    assert summary["energy_shares"] == {}
    assert summary["warnings"] == []
