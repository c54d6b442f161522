"""Failure loads of buildings that are known by hand: gable wall, two walls under a plate; turned plans fail alike."""

from __future__ import annotations

import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.analyses.solve import solve
from dem_cli.core.records.ports import Observer
from dem_cli.masonry.assembly.assemble import assemble

T, RHO = 0.3, 2143.0  # thickness [m], density of peperino [kg/m3]


def bracket(direction, walls, **more):
    """Bracket of the failure load of a building."""
    table = {"kind": "building", "id": "b", "block": [0.6, 0.25], "thickness": T, "courses": 6, "walls": walls}
    analysis = {"kind": "pushover", "direction": list(map(float, direction)), "resolution": 0.002}
    case = spatial_case(structure=[table | more], analysis=analysis, output={"frames": 0})
    summary = solve(case, assemble(case), Observer()).summary
    assert summary["status"] == "ok"
    return summary["failure_load_bracket"]


def test_a_gable_wall_turns_over_its_foot():
    length, height, rise = 2.4, 1.5, 0.9
    low, high = bracket((0, 1, 0), [{"id": "w", "axis": [[0.0, 0.0], [length, 0.0]], "gable": {"height": rise}}])
    below, above = length * height, 0.5 * length * rise
    centre = (below * height / 2 + above * (height + rise / 3)) / (below + above)
    by_hand = 0.5 * T / centre
    assert low == pytest.approx(by_hand, rel=2e-3)
    assert low * (1 - 1e-6) <= by_hand * (1 + 1e-3)
    assert high == pytest.approx(by_hand, rel=2e-3)


def test_two_walls_sway_under_a_plate():
    """Both turn over their right feet; the plate stands on their left-most points, and turns a little."""
    width, span, height, mass, bearing, thick = 1.2, 2.0, 1.5, 900.0, 0.15, 0.25
    walls = [{"id": n, "axis": [[x, 0.0], [x, width]]} for n, x in (("left", 0.0), ("right", span))]
    floor = {"id": "plate", "z": height, "on": ["left", "right"], "mass": mass, "bearing": bearing, "height": thick}
    low, high = bracket((1, 0, 0), walls, floors=[floor])
    wall = RHO * T * width * height
    clear = span - T
    turn = (T - bearing) / (clear + bearing)  # of the plate, for one of the walls
    resists = wall * T + mass * (bearing + turn * 0.5 * (clear + 2 * bearing))
    pushes = wall * height + mass * (height - turn * 0.5 * thick)
    assert low == pytest.approx(resists / pushes, rel=2e-3)
    assert high == pytest.approx(resists / pushes, rel=2e-3)


CORNER = [{"id": "x", "axis": [[0.0, 0.0], [1.8, 0.0]]}, {"id": "y", "axis": [[0.0, 0.0], [0.0, 1.2]]}]


def test_a_corner_turned_or_mirrored_fails_at_the_same_load():
    def changed(way):
        return [{**each, "axis": [list(way(*p)) for p in each["axis"]]} for each in CORNER]

    same = bracket((0, -1, 0), CORNER)
    assert bracket((1, 0, 0), changed(lambda x, y: (-y, x))) == pytest.approx(same, rel=2e-3)  # turned by 90°
    assert bracket((0, -1, 0), changed(lambda x, y: (-x, y))) == pytest.approx(same, rel=2e-3)
