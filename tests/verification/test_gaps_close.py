"""Joints that are open at the start close before a structure fails: `dem run` and `dem check` as they are."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import tomli_w
from casefiles import CASES, read
from click.testing import CliRunner
from engine import Records, block, rectangle, scene, simulation, solve, tables, turned

from dem_cli.app.cli.main import main
from dem_cli.core.contact.gaps import gaps_of_start
from dem_cli.core.engine.kinematics import why_moving
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.validate import problems

RESOLUTION = 0.005
PAGE = json.loads((CASES.parent / "docs" / "data" / "imperfections.json").read_text(encoding="utf-8"))["rows"]
DRAWN = {
    "height": [-0.001, 0.001],
    "length": {"mean": 0.0, "deviation": 0.0002},
    "wedge": [-0.0005, 0.0005],
    "lean": 0.03,
}


def wall(*imperfections: dict, **analysis) -> dict:
    """The 21-block wall with errors."""
    case = read(CASES / "verification" / "wall_21.toml") | {"imperfection": list(imperfections)}
    case["analysis"] |= {"resolution": RESOLUTION} | analysis
    return case | {"output": {"frames": 0}}


def low(name: str, size: float = 1e-3) -> dict:
    return {"block": f"wall-{name}", "height": -size}


def energy_error(records: Records) -> float:
    """Largest energy out of nothing until the collapse is followed, over what the loads gave."""
    error = work = 0.0
    for row in records.rows:
        if row.stage != "collapse":
            e = row.energy
            missing = e.kinetic + e.elastic + e.gravity + e.friction + e.damping - e.external - e.supports
            error, work = max(error, abs(missing)), max(work, abs(e.external), abs(e.gravity), e.friction + e.damping)
    return error / work


def test_check_and_run_say_that_geometry_moves(tmp_path):
    path = tmp_path / "wall.toml"
    path.write_text(tomli_w.dumps(wall(low("2-3"))), encoding="utf-8")
    result = CliRunner().invoke(main, ["check", str(path)])
    assert result.exit_code == 0
    (line,) = (line for line in result.output.splitlines() if line.split()[0] == "kinematics")
    assert "large" in line
    assert "imperfections of blocks leave gaps that may close" in line


def test_a_low_block_is_no_failure():
    """2-3 is 1 mm low: ten blocks begin to turn at 0.26, come to rest on it, and hold as much as if they slid there.

    They rest on it at an angle of 1 mm over half a block, at worst: 0.534. Without errors 0.6.
    """
    summary, records = solve(wall(low("2-3"), follow=0.0))
    assert any("imperfections of blocks" in line for line in summary["skipped"])
    (row,) = (row for row in PAGE if (row["block"], row["size"], row["shape"]) == ("wall-2-3", 1.0, "whole top")
              and row["laid"])  # fmt: skip
    assert row["first"]["load"] == pytest.approx(0.2611, rel=RESOLUTION)  # limit analysis
    assert summary["failure_load"] == pytest.approx(row["last"]["load"], rel=0.01)
    assert math.tan(math.atan(0.6) - 1 / 20) * (1 - RESOLUTION) < summary["failure_load"] < 0.6
    assert summary["failure_load"] > 2.0 * row["first"]["load"]
    assert energy_error(records) < 2e-3


def test_what_closed_a_gap_moved_no_further_than_its_play():
    case = wall(low("2-3"), follow=0.0)
    sim = simulation(case, "large")
    _, records = solve(case)
    moved = [row.displacement for row in records.rows if row.stage == "loading" and row.load < 0.5]
    assert 1e-3 < max(moved) < sim.play.moved.max()


@pytest.mark.parametrize("block_id", ["3-4", "5-4"])
def test_a_wedge_closes_and_slides(block_id):
    """Its open end is a gap as well: the block above turns by 1 mm over 20 mm and slides down there."""
    summary, _ = solve(wall({"block": f"wall-{block_id}", "wedge": -1e-3}, follow=0.0))
    assert summary["failure_load"] == pytest.approx(math.tan(math.atan(0.6) - 1 / 20), rel=RESOLUTION)


TINY = {
    "one low": low("2-3", 1e-5),
    "one that hovers": low("2-3", 1e-5) | {"restack": False},
    "all drawn": {key: [-1e-5, 1e-5] for key in ("height", "length", "wedge")},
}


@pytest.mark.parametrize("errors", TINY.values(), ids=TINY)
def test_tiny_errors_do_not_matter(errors):
    """0.01 mm over half a block of 20 mm turns joints by 0.0005, and 0.6 into 0.5993."""
    summary, _ = solve(wall(errors, follow=0.0))
    lowest, highest = summary["failure_load_bracket"]
    assert lowest > 0.6 * (1 - RESOLUTION)
    assert highest < 0.6 * (1 + RESOLUTION)


@pytest.mark.parametrize("seed", [0, 5])
def test_a_wall_with_errors_everywhere_stands_and_fails_at_its_end(seed):
    """Heights, lengths, wedges and a lean of 3 %: 0.51; the wall as drawn 0.6. Its right side goes, at the top."""
    summary, records = solve(wall(DRAWN, follow=0.0) | {"seed": seed})
    assert summary["status"] == "ok"
    assert 0.45 < summary["failure_load"] < 0.6
    first = summary["mechanism"]["moving_blocks"]["first"]
    assert "wall-6-3" in first
    assert not {"wall-1-1", "wall-1-2", "wall-2-1", "wall-3-1", "wall-4-1"} & set(first)
    assert energy_error(records) < 2e-3
    assert abs(summary["energy_closure"]) < 5e-3


GROUND = block("ground", rectangle(-3.0, -1.0, 6.0, 0.0), fixed=True)
BODY = block("body", rectangle(0.0, 0.0, 0.5, 1.0))


def pushed(gap: float, kinematics: str, *more: dict) -> dict:
    """A block that slides at 0.3, and a low stop at a distance before it."""
    stop = block("stop", rectangle(0.5 + gap, 0.0, 1.0, 0.05), fixed=True)
    analysis = {"kinematics": kinematics, "resolution": RESOLUTION, "follow": 0.0}
    return tables(GROUND, stop, BODY, *more, friction=0.3, analysis=analysis)


def load(case: dict) -> float:
    return solve(case)[0]["failure_load"]


@pytest.mark.parametrize("gap", [1e-3, 5e-3])
def test_a_block_slides_to_a_stop_and_turns_over_it(gap):
    """The gap closes at μ = 0.3; then the block is as strong as one that touched its stop from the start."""
    assert load(pushed(gap, "fixed")) == pytest.approx(0.3, rel=RESOLUTION)
    closed = load(pushed(0.0, "fixed"))
    assert closed > 0.5  # it cannot but turn, about a place that is higher than its toe
    assert load(pushed(gap, "large")) == pytest.approx(closed, rel=RESOLUTION)


def test_a_gap_that_does_not_close_excuses_nothing():
    """A block turns over away from its neighbour at width over height, however far that is."""
    body = block("body", rectangle(0.0, 0.0, 0.25, 1.0))
    left = block("left", rectangle(-0.51, 0.0, -0.01, 1.0), fixed=True)
    case = tables(GROUND, body, left, analysis={"kinematics": "large", "resolution": RESOLUTION, "follow": 0.0})
    assert load(case) == pytest.approx(0.25, rel=RESOLUTION)
    np.testing.assert_allclose(simulation(case, "large").play.moved, 0.125, rtol=0.05)  # half the block


def test_a_case_without_errors_keeps_its_geometry():
    made = scene(CASES / "verification" / "wall_21.toml")
    assert not made.case.imperfection
    summary, _ = solve(CASES / "verification" / "wall_21.toml", "analysis.follow=0.0")
    assert not any("fixed geometry" in line for line in summary["skipped"])
    assert np.isclose(summary["failure_load"], 0.6, rtol=RESOLUTION)


POST = (0.5, 2.0)  # [m]
CLOSES = 1e-3 * math.hypot(*POST)  # 2.06 mm: the widest gap that counts as a joint


def beam_on_posts(short: float, **analysis) -> dict:
    """A beam on two posts, the right one shorter than the left one by so much [m]."""
    width, height = POST
    left, right = rectangle(0.0, 0.0, width, height), rectangle(3.5, 0.0, 3.5 + width, height - short)
    posts = block("left", left), block("right", right)
    beam = block("beam", rectangle(0.0, height, 3.5 + width, height + 0.6))
    settings = {"kind": "pushover", "resolution": RESOLUTION, "follow": 0.0}
    return tables(GROUND, *posts, beam, analysis=settings | analysis)


@pytest.mark.parametrize("share", [0.2, 0.3, 0.5, 0.7, 0.99])
def test_a_beam_on_a_post_that_is_short_stands(share):
    """The gap closes by an angle of up to 0.0006; the posts turn over at their width over their height, 0.25."""
    case = beam_on_posts(share * CLOSES)
    assert (
        why_moving(scene(case).request, scene(case).model)
        == f"a gap of {share * CLOSES:.3g} m between 'right' and 'beam' may close"
    )
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["warnings"] == []
    assert summary["failure_load"] == pytest.approx(0.25, rel=RESOLUTION)


@pytest.mark.parametrize("short", [1.01 * CLOSES, 0.01, 0.05])
def test_a_gap_that_is_too_wide_to_close_is_named(short, tmp_path):
    """By the run that says that the beam falls, by the check of the case and by limit analysis."""
    words = f"a gap of {short:.3g} m between 'right' and 'beam'"
    summary, _ = solve(beam_on_posts(short))
    assert summary["status"] == "does not stand under its dead loads"
    assert any(words in line and 'kinematics = "large"' in line for line in summary["warnings"])
    assert solve(beam_on_posts(short, kinematics="large"))[0]["status"] == "ok"
    path = tmp_path / "beam.toml"
    path.write_text(tomli_w.dumps(beam_on_posts(short)), encoding="utf-8")
    checked = CliRunner().invoke(main, ["check", str(path)])
    assert any(line.split()[0] == "gaps" and words in line for line in checked.output.splitlines())
    assert words in CliRunner().invoke(main, ["limit", str(path)]).output


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.999, 1.001, 1.5])
@pytest.mark.parametrize("small", [False, True])
def test_what_holds_up_a_block_is_what_closes(share, small):
    """Checks and solver have one rule, whatever other blocks there are: a block that hovers is refused or closes."""
    case = tables(GROUND, block("hovers", rectangle(0.0, share * 2.5e-3, 1.5, 2.0 + share * 2.5e-3)))
    if small:
        case["block"].append(block("small", rectangle(3.0, 0.0, 3.05, 0.05)))
    made = assembly(scene(case).case)
    refused = problems(scene(case).case, made.model, made.blocks)
    moving = why_moving(scene(case).request, made.model)
    assert bool(refused) == (share > 1.0)
    assert (moving is None) == (share > 1.0)
    found = gaps_of_start(made.model)
    assert found.widths == pytest.approx([share * 2.5e-3])
    assert found.close.tolist() == [share <= 1.0]


def test_gaps_that_are_named_and_gaps_that_are_not():
    """Blocks side by side 10 mm apart are; 60 mm apart (5 % of a metre is named), touching, or under an angle, not."""
    box = rectangle(0.0, 0.0, 0.8, 0.6)  # 1 m across
    leaning = [[0.81, 0.0], [1.6, 0.0], [1.6, 0.6], [0.95, 0.6]]
    for corners, widths in (
        (rectangle(0.81, 0.0, 1.61, 0.6), [0.01]),
        (rectangle(0.86, 0.0, 1.66, 0.6), []),
        (rectangle(0.8, 0.0, 1.6, 0.6), []),
        (leaning, []),
    ):
        model = scene(tables(GROUND, block("a", box), block("b", corners))).model
        assert gaps_of_start(model).widths == pytest.approx(widths)


FALLEN = {  # blocks of the fourth course that rest on a corner of what is low below them
    "a wedge": low("4-1") | {"wedge": 1e-3},
    "a low block, left in place": low("4-1") | {"restack": False},
}


@pytest.mark.parametrize("errors", FALLEN.values(), ids=FALLEN)
def test_what_falls_onto_a_low_block_stands_with_its_books_closed(errors):
    """A point that closed in a step took 1.5 % of all energy, in no book; and where it fell, blocks stood no more."""
    summary, _ = solve(wall(errors) | {"analysis": {"kind": "gravity"}})
    assert summary["status"] == "ok"
    assert summary["warnings"] == []
    assert abs(summary["energy_closure"]) < 1e-4


def dropped(height: float, dimension: int) -> dict:
    """A block that hovers, turned by 0.001, so that it lands on one edge and turns onto the other."""
    leaning = [[x, z + height] for x, z in turned(rectangle(0.0, 0.0, 0.5, 1.0), 1e-3)]
    outlines = {"ground": rectangle(-1.0, -0.5, 2.0, 0.0), "body": leaning}
    if dimension == 3:
        outlines = {name: [[x, y, z] for x, z in flat for y in (0.0, 0.5)] for name, flat in outlines.items()}
    blocks = [block(name, corners, fixed=name == "ground") for name, corners in outlines.items()]
    return tables(*blocks, dimension=dimension, analysis={"kind": "gravity", "kinematics": "large"})


@pytest.mark.parametrize(("dimension", "height"), [(2, 1e-3), (3, 1e-4)])
def test_energy_of_a_block_that_lands(dimension, height):
    summary, _ = solve(dropped(height, dimension))
    assert summary["status"] == "ok"
    assert summary["largest_displacement"] > height
    assert abs(summary["energy_closure"]) < 1e-4


def beside_a_pier(width: float, **analysis) -> dict:
    """A pier of height 1 that rocks at its width, and two stones far away with a gap of 0.2 mm, which slide at 0.5."""
    stones = [
        block("far", rectangle(10.0, -0.2, 12.0, 0.0), fixed=True),
        block("a", rectangle(10.0, 0.0, 11.0, 0.2)),
        block("b", rectangle(11.0002, 0.0, 12.0, 0.2)),
    ]
    pier = block("pier", rectangle(0.0, 0.0, width, 1.0))
    settings = {"kind": "pushover", "resolution": RESOLUTION, "follow": 0.0}
    return tables(GROUND, pier, *stones, friction=0.5, analysis=settings | analysis)


def test_gaps_of_another_structure_move_nothing():
    """What fails first has no gaps: its geometry is that of the start, to the last digit."""
    summary, _ = solve(beside_a_pier(0.2))
    assert summary["failure_load"] == solve(beside_a_pier(0.2, kinematics="fixed"))[0]["failure_load"]
    assert summary["failure_load"] == pytest.approx(0.2, rel=RESOLUTION)
    assert "large displacements: what fails first has no gaps that may close" in summary["skipped"]


def test_gaps_of_the_structure_that_fails_first_close():
    """The pier would rock at 0.8; the stones slide at 0.5, the first one against the second once the gap is closed."""
    summary, _ = solve(beside_a_pier(0.8))
    assert summary["failure_load"] == pytest.approx(0.5, rel=RESOLUTION)
    assert any("may close" in line for line in summary["skipped"])
