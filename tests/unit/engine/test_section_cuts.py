"""Monitors of cuts: N, V and M against weights and loads in closed form, piers and base shear, drift, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, solve, tables

from dem_cli.core.model.section_cuts import section_cut, section_forces
from dem_cli.masonry.assembly.validate import cut_problems

G, DENSITY, WIDTH, HEIGHT, COUNT = 9.81, 2000.0, 0.5, 0.4, 4
WEIGHT = G * DENSITY * WIDTH * HEIGHT  # of one block of the column, in 3D of a depth of 1 m


def column(dimension: int, monitors: list[dict], push: float = 0.0, **more) -> dict:
    """Four blocks on each other, with a live force to the right at the top."""
    shapes = [("base", -2.0, 2.0, -1.0, 0.0)]
    shapes += [(f"b{k}", 0.0, WIDTH, k * HEIGHT, (k + 1) * HEIGHT) for k in range(COUNT)]
    drawn = []
    for name, left, right, low, high in shapes:
        corners = rectangle(left, low, right, high)
        if dimension == 3:
            corners = [[x, y, z] for x, z in corners for y in (-0.5, 0.5)]
        drawn.append(block(name, corners, **({"fixed": True} if name == "base" else {})))
    force = [push] + [0.0] * (dimension - 1)
    at = [WIDTH, COUNT * HEIGHT] if dimension == 2 else [WIDTH, 0.0, COUNT * HEIGHT]
    loads = {"load": [{"block": f"b{COUNT - 1}", "force": force, "at": at}]} if push else {}
    return tables(*drawn, dimension=dimension, analysis={"kind": "gravity"}, monitor=monitors, **loads, **more)


def level(y: float, dimension: int) -> list[list[float]]:
    """Across the column from left to right; in 3D a rectangle around it, its first side along x."""
    if dimension == 2:
        return [[-0.1, y], [WIDTH + 0.1, y]]
    return [[-0.1, -0.6, y], [WIDTH + 0.1, -0.6, y], [WIDTH + 0.1, 0.6, y], [-0.1, 0.6, y]]


def values(case: dict) -> dict[str, float]:
    summary, records = solve(case)
    assert summary["status"] == "ok"
    return dict(zip((one["name"] for one in case["monitor"]), records.rows[-1].monitors, strict=True))


def forces(name: str, cut: list, dimension: int) -> list[dict]:
    more = ("shear_force_across", "moment_across", "torsion") if dimension == 3 else ()
    return [{"name": f"{name} {key}", "cut": cut, "quantity": key}
            for key in ("normal_force", "shear_force", "moment", *more)]  # fmt: skip


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_column_carries_what_is_above(dimension):
    """N is the weight above; at a joint and within a block, whose centroid says on which side it is."""
    cuts = [(0.0, 4), (HEIGHT, 3), (1.4 * HEIGHT, 3), (1.6 * HEIGHT, 2), (3 * HEIGHT, 1)]
    found = values(column(dimension, [m for y, _ in cuts for m in forces(f"{y:g}", level(y, dimension), dimension)]))
    for y, above in cuts:
        assert found[f"{y:g} normal_force"] == pytest.approx(above * WEIGHT, rel=1e-4)
        others = [value for name, value in found.items() if name.startswith(f"{y:g} ") and "normal" not in name]
        assert np.array(others) == pytest.approx(0.0, abs=1e-4 * WEIGHT)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_pushed_column_is_a_cantilever(dimension):
    """V = P, M = P (H − y) about the middle; the other way round the cut gives the same with N, V and M as before."""
    push, y = 0.05 * WEIGHT, HEIGHT
    there = level(y, dimension)
    back = [*reversed(there)] if dimension == 2 else [there[2], there[1], there[0], there[3]]
    found = values(column(dimension, [*forces("there", there, dimension), *forces("back", back, dimension)], push))
    assert found["there shear_force"] == pytest.approx(push, rel=1e-3)
    assert found["there moment"] == pytest.approx(push * (COUNT * HEIGHT - y), rel=1e-3)
    assert found["there normal_force"] == pytest.approx(3 * WEIGHT, rel=1e-4)
    assert found["back normal_force"] == pytest.approx(found["there normal_force"])
    # seen from the other side the first side runs another way: in 2D back, in 3D across
    if dimension == 2:
        assert found["back shear_force"] == pytest.approx(push, rel=1e-3)  # what is below gives back, along B to A
        assert found["back moment"] == pytest.approx(-found["there moment"])
    else:
        assert found["back shear_force"] == pytest.approx(0.0, abs=1e-3 * push)
        assert found["back shear_force_across"] == pytest.approx(push, rel=1e-3)


def test_torsion_and_moments_in_space():
    """Forces at places by hand: a couple about the normal is torsion alone, an eccentric force both moments."""
    cut = section_cut([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]])
    assert cut.middle == pytest.approx([1.0, 0.5, 1.0])
    couple = section_forces(cut, np.array([[1.0, 0.0, 1.0], [1.0, 1.0, 1.0]]), np.array([[3.0, 0, 0], [-3.0, 0, 0]]))
    assert couple == pytest.approx((0, 0, 0, 0, 0, 3.0))
    off = section_forces(cut, np.array([[1.4, 0.2, 1.0]]), np.array([[0.0, 0.0, -10.0]]))
    assert off == pytest.approx((10.0, 0, 10.0 * 0.4, 0, 10.0 * -0.3, 0))


def test_joints_beside_a_polygon_are_left_out():
    """An L of five corners and the point in its notch; a joint on its rim is beside it."""
    corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    cut = section_cut(np.array(corners, float))
    places = np.array(
        [[0.5, 0.5, 9.0], [1.5, 1.5, 0.0], [1.5, 0.5, -3.0], [0.5, 1.5, 0.0], [2.0, 0.5, 0.0], [3, 0.5, 0]]
    )
    assert cut.across(places).tolist() == [True, False, True, True, False, False]


def wall_of_two_piers(monitors: list[dict], kinematics: str = "fixed", **more) -> dict:
    """A lintel on two piers of three stones, pushed by its mass."""
    piers = [
        block(f"{name}{k}", rectangle(x, 0.5 * k, x + 0.6, 0.5 * (k + 1)))
        for name, x in (("l", 0.0), ("r", 1.4)) for k in range(3)
    ]  # fmt: skip
    lintel = block("lintel", rectangle(0.0, 1.5, 2.0, 1.9))
    push = {"kind": "pushover", "pattern": "mass", "direction": [1.0, 0.0], "kinematics": kinematics}
    return tables(
        block("base", rectangle(-1, -1, 3, 0), fixed=True), *piers, lintel,
        analysis=push, monitor=monitors, **more,
    )  # fmt: skip


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_piers_together_carry_the_base_shear(kinematics):
    """Row by row: V and N of both piers are the load and weight above, and the reaction of the base."""
    at = {"left": [[0.0, 0.6], [0.6, 0.6]], "right": [[1.4, 0.6], [2.0, 0.6]], "lb": [[0, 0], [0.6, 0]],
          "rb": [[1.4, 0], [2, 0]]}  # fmt: skip
    monitors = [{"name": f"{key} {what}", "cut": cut, "quantity": what}
                for key, cut in at.items() for what in ("normal_force", "shear_force")]  # fmt: skip
    monitors += [{"name": "base", "block": "base", "quantity": "reaction", "component": "x"}]
    case = wall_of_two_piers(monitors, kinematics)
    summary, records = solve(case)
    rows = [row for row in records.rows if row.stage == "loading"]
    names = [one["name"] for one in monitors]
    model = scene(case).model
    weight = G * model.masses[~model.fixed].sum()
    above = weight - G * model.masses[[model.numbers[name] for name in ("l0", "r0")]].sum()
    assert len(rows) > 3
    checked = 0
    for row in rows:
        if row.load > 0.98 * summary["failure_load"] or row.load == 0.0:
            continue
        found, checked = dict(zip(names, row.monitors, strict=True)), checked + 1
        near = {"rel": 5e-3, "abs": 1e-3 * weight}
        assert found["left shear_force"] + found["right shear_force"] == pytest.approx(row.load * above, **near)
        assert found["lb shear_force"] + found["rb shear_force"] == pytest.approx(-found["base"], **near)
        assert found["left normal_force"] + found["right normal_force"] == pytest.approx(above, rel=5e-3)
    assert checked > 1


def test_drift_of_a_pier():
    """The displacement of two points along the cut, over the height; from monitors of these points."""
    cut = [[0.0, 0.75], [0.6, 0.75]]
    monitors = [
        {"name": "drift", "cut": cut, "quantity": "drift", "height": 1.4},
        {"name": "top", "point": [0.3, 1.45], "component": "x"},
        {"name": "foot", "point": [0.3, 0.05], "component": "x"},
    ]
    case = wall_of_two_piers(monitors, joints={"dry": {"friction": 0.6, "kn": 1e8}})
    _, records = solve(case)
    rows = np.array([row.monitors for row in records.rows])
    assert np.abs(rows[:, 0]).max() > 1e-6
    assert rows[:, 0] == pytest.approx((rows[:, 1] - rows[:, 2]) / 1.4)


@pytest.mark.parametrize(
    ("monitor", "said"),
    [
        ({"cut": [[0, 0.6], [0, 0.6]]}, "both ends are the same point"),
        ({"cut": [[0, 0.6], [0.3, 0.6], [0.6, 0.6]]}, "a cut in 2D is a line"),
        ({"cut": [[0.7, 0.6], [1.3, 0.6]]}, "passes through no joint"),
        ({"cut": [[0, 0.6], [0.6, 0.6]], "quantity": "drift", "height": 9.0}, "there is no block at"),
    ],
)
def test_cuts_that_are_refused(monitor, said):
    made = scene(wall_of_two_piers([{"quantity": "shear_force"} | monitor]))
    problems = cut_problems(made.case, made.model)
    assert problems
    assert said in problems[0].message
