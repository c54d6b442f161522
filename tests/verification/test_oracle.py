"""The oracle reproduces the data book: only then may it judge the solver."""

from __future__ import annotations

import numpy as np
import pytest
from oracle import shapes
from oracle.limit_lp import area_and_centroid, frictionless_heads, interfaces, limit_load, stands
from reference import book, result, value

FRICTIONS = book("thesis_21_block_wall")["material"]["friction_cases"]
HALF_DIGIT = 5e-5  # of a value printed with four digits


def solved(polygons, fixed, friction, **options) -> float:
    """The multiplier, once the answer is shown to be one: balanced, and with no duality gap."""
    answer = limit_load(polygons, fixed, friction, **options)
    assert answer.residual < 1e-8
    assert answer.gap < 1e-8
    assert np.all(answer.normal_forces > -1e-9)
    return answer.multiplier


@pytest.mark.parametrize("friction", FRICTIONS)
def test_wall_of_21_blocks(friction):
    polygons, fixed = shapes.running_wall(3, 6)
    assert sum(not f for f in fixed) == 21
    heads_free = result("thesis_21_block_wall", f"lambda_lp_mu{friction:.2f}")
    associated = result("thesis_21_block_wall", f"lambda_lp_assoc_mu{friction:.2f}")
    assert solved(polygons, fixed, frictionless_heads(friction)) == pytest.approx(
        heads_free["value"], abs=heads_free["tolerance"]
    )
    assert solved(polygons, fixed, friction) == pytest.approx(associated["value"], abs=associated["tolerance"])


@pytest.mark.parametrize(
    ("courses", "heads_free_id", "associated_id"),
    [
        (6, "WALL1_lp", "WALL1_lp_assoc"),
        (10, "WALL2_lp", "WALL2_lp_assoc"),
        (21, "WALL3_21_layers_lp", None),
        (22, "WALL3_lp", "WALL3_lp_assoc"),
    ],
)
def test_walls_of_ten_blocks(courses, heads_free_id, associated_id):
    polygons, fixed = shapes.running_wall(10, courses)
    expected = value("thesis_walls_1_2_3", heads_free_id)
    assert solved(polygons, fixed, frictionless_heads(0.6)) == pytest.approx(expected, abs=HALF_DIGIT)
    if associated_id:
        expected = value("thesis_walls_1_2_3", associated_id)
        assert solved(polygons, fixed, 0.6) == pytest.approx(expected, abs=HALF_DIGIT)


def test_column_of_14_blocks_turns_over_at_width_over_height():
    book_14 = book("thesis_14_block_column")["geometry"]
    width, height = book_14["block_base_m"], book_14["block_height_m"]
    polygons, fixed = shapes.column(14, width, height)
    assert solved(polygons, fixed, 0.6) == pytest.approx(width / (14 * height), abs=1e-9)
    assert value("thesis_14_block_column", "lambda_rigid") == pytest.approx(width / (14 * height), abs=1e-3)


@pytest.mark.parametrize(("friction", "expected"), [(1.0, 0.1483), (0.6, 0.1483), (0.5, 0.1483), (0.4, 0.0522)])
def test_arch_of_21_voussoirs(friction, expected):
    polygons, fixed = shapes.arch(21, 1.0, 0.15)
    assert solved(polygons, fixed, friction) == pytest.approx(expected, abs=HALF_DIGIT)


@pytest.mark.parametrize("friction", [0.55, 0.6, 1.0])
def test_arch_on_columns(friction):
    expected = value("thesis_arch_shaking", "inferred_static")
    assert solved(*shapes.portal(), friction) == pytest.approx(expected, abs=HALF_DIGIT)


@pytest.mark.parametrize(
    ("row", "friction"),
    [
        ("arch_min_t", 10.0),
        ("arch_min_t_mu0.38", 0.38),
        ("arch_min_t_mu0.35", 0.35),
        ("arch_min_t_mu0.32", 0.32),
        ("arch_min_t_mu0.31", 0.31),
    ],
)
def test_least_thickness_of_an_arch(row, friction):
    thickness = value("classical_benchmarks", row)
    margin = result("classical_benchmarks", row)["tolerance"]
    assert stands(*shapes.arch(27, 1.0, thickness + margin), friction)
    assert not stands(*shapes.arch(27, 1.0, thickness - margin), friction)


def test_tapered_column_of_drums():
    polygons, fixed = shapes.drums(7, 1.11, 0.9, 5.95)
    load = solved(polygons, fixed, 0.7)
    assert load == pytest.approx(value("dimitri_column_arch", "col_static"), abs=HALF_DIGIT)
    area, centroid = area_and_centroid(np.array([[-0.555, 0], [0.555, 0], [0.45, 5.95], [-0.45, 5.95]]))
    assert area == pytest.approx((1.11 + 0.9) / 2 * 5.95)
    assert load == pytest.approx(0.555 / centroid[1], abs=1e-9)


def test_harmonic_stack_stands_just_within_its_limit():
    def stack(overhang_factor):
        x, polygons = 0.0, [shapes.rectangle(-1.0, -0.2, 1e-9, 0.0)]
        n_blocks = 4
        for level in range(n_blocks):
            x += overhang_factor / (2 * (n_blocks - level))
            polygons.append(shapes.rectangle(x - 1.0, 0.2 * level, x, 0.2 * level + 0.2))
        return polygons, [True] + [False] * n_blocks, x

    _, _, overhang = stack(1.0)
    assert overhang == pytest.approx(value("classical_benchmarks", "overhang_4"), abs=1e-6)
    assert stands(*stack(0.999)[:2], 0.6)
    assert not stands(*stack(1.001)[:2], 0.6)


def test_block_between_fixed_walls_cannot_fail():
    polygons = [shapes.rectangle(0, 0, 1, 1), shapes.rectangle(-1, 0, 0, 1), shapes.rectangle(1, 0, 2, 1)]
    polygons.append(shapes.rectangle(-1, -1, 2, 0))
    assert limit_load(polygons, [False, True, True, True], 0.6).multiplier == np.inf


def test_interfaces_of_a_wall():
    polygons, _ = shapes.running_wall(3, 2)
    joints = interfaces(polygons)
    beds = [j for j in joints if j.steepness < 1]
    heads = [j for j in joints if j.steepness > 89]
    assert (len(beds), len(heads)) == (12, 2 + 3 + 2)
    assert all(np.hypot(*(j.ends[1] - j.ends[0])) == pytest.approx(0.02) for j in beds)
