"""Patterns of irregular masonry: they fill their panel exactly, faces are shared, statistics are those asked for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import STRtree, intersection
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.decomposition import convex_parts, is_simple
from dem_cli.masonry.structures.patterns import coursed, voronoi
from dem_cli.masonry.structures.patterns.panel import LEAST_SHARE, WallPanel, blocks_of, rectangular
from dem_cli.masonry.structures.patterns.tiling import Tiling

BOXES = [(8.0, 0.0, 10.0, 3.0), (7.5, 3.0, 10.5, 3.4), (3.2, 5.0, 4.4, 7.0)]
DOOR_AND_WINDOW = rectangular(20.0, 10.0, BOXES)
PLAIN = rectangular(20.0, 10.0)
GABLE = WallPanel(np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [2.5, 4.5], [0.0, 3.0]]), PLAIN.holes)
PAPER = {"spacing": (1.0, 0.1), "segment": (2.0, 1.0), "deviation": (0.0, 0.2), "head_spacing": (1.5, 0.5)}

RELAXED = voronoi.VoronoiPattern(cells=4, relax=100)
LEANING = {"spacing": (0.5, 0.1), "deviation": (0.0, 0.05), "head_angle_deg": (4.0, 5.0)}


def draws(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


def rubble(panel: WallPanel, seed: int, **keys) -> Tiling:
    return voronoi.stones_in(panel, voronoi.VoronoiPattern(**({"cells": 200} | keys)), draws(seed))


def courses(panel: WallPanel, seed: int, **keys) -> Tiling:
    return coursed.stones_in(panel, coursed.CoursedPattern(**(PAPER | keys)), draws(seed)).tiling


PATTERNS = {
    "random": lambda panel, seed: rubble(panel, seed, relax=0),
    "relaxed": lambda panel, seed: rubble(panel, seed, relax=2, stretch=1.8),
    "polygonal": lambda panel, seed: rubble(panel, seed, relax=8, shortest=0.25),
    "coursed": courses,
    "leaning": lambda panel, seed: courses(panel, seed, **LEANING),
}  # fmt: skip


def shapes(tiling: Tiling) -> list[Polygon]:
    return [unary_union([Polygon(part) for part in tiling.parts(k)]) for k in range(len(tiling.stones))]


def overlaps(polygons: list[Polygon]) -> float:
    """Area that pairs of polygons have in common [m2]; on a grid: GEOS takes edges on one line amiss by 1e-16."""
    pairs = STRtree(polygons).query(polygons, predicate="intersects").T
    return sum(intersection(polygons[i], polygons[j], grid_size=1e-9).area for i, j in pairs if i < j)


def check(tiling: Tiling, panel: WallPanel) -> None:
    """Area, convexity, no overlap, no gap; each inner edge has a stone on both sides."""
    outline = Polygon(panel.outline)
    whole = outline.difference(unary_union([Polygon(hole) for hole in panel.holes]))
    parts = [part for k in range(len(tiling.stones)) for part in tiling.parts(k)]
    assert all(polygon.is_convex(part) for part in parts)
    assert sum(polygon.area(part) for part in parts) == pytest.approx(whole.area, rel=1e-12)
    assert overlaps([Polygon(part) for part in parts]) < 1e-9 * whole.area
    assert all(whole.buffer(1e-9).covers(Polygon(part)) for part in parts)
    edges = tiling.edges()
    free = [edge for edge in edges if edge[::-1] not in edges]
    lengths = np.hypot(*(tiling.corners[[j for _, j in free]] - tiling.corners[[i for i, _ in free]]).T)
    assert lengths.sum() == pytest.approx(whole.length, rel=1e-9)  # so every other edge has a stone on both sides


@pytest.mark.parametrize("panel", [PLAIN, DOOR_AND_WINDOW, GABLE], ids=["plain", "openings", "gable"])
@pytest.mark.parametrize("name", PATTERNS)
@pytest.mark.parametrize("seed", [1, 2])
def test_stones_fill_their_panel_exactly(name, panel, seed):
    tiling = PATTERNS[name](panel, seed)
    check(tiling, panel)


@pytest.mark.parametrize("name", PATTERNS)
def test_no_stone_is_below_a_quarter_of_the_mean(name):
    tiling = PATTERNS[name](DOOR_AND_WINDOW, 5)
    mean = {"coursed": 1.5, "leaning": 0.75}.get(name, 1.0)
    assert tiling.areas().min() >= LEAST_SHARE * mean


@pytest.mark.parametrize("name", PATTERNS)
def test_the_same_seed_draws_the_same_stones_to_the_last_bit(name):
    one, two, other = (PATTERNS[name](DOOR_AND_WINDOW, seed) for seed in (7, 7, 8))
    assert one.corners.tobytes() == two.corners.tobytes()
    assert one.stones == two.stones
    assert other.corners.tobytes() != one.corners.tobytes()


@pytest.mark.parametrize("seed", range(4))
def test_short_edges_collapse_and_corners_of_neighbours_are_one(seed):
    tiling = rubble(PLAIN, seed, relax=0, shortest=0.1)
    assert tiling.edge_lengths().min() >= 0.9 * 0.1  # some ends could not be one: a stone would turn inside out
    kept = rubble(PLAIN, seed, relax=0, shortest=0.0)
    assert kept.edge_lengths().min() < 0.02
    assert len(np.unique(tiling.corners, axis=0)) == len(tiling.corners)


def test_relaxed_stones_are_more_alike():
    spreads = [rubble(PLAIN, 1, relax=relax, shortest=0.0).areas().std() for relax in (0, 1, 3, 10)]
    assert spreads == sorted(spreads, reverse=True)
    assert spreads[0] == pytest.approx(0.53, abs=0.08)  # of a Poisson-Voronoi tessellation, Tanemura 2003


@pytest.mark.parametrize("stretch", [0.5, 1.0, 2.0])
def test_stretched_stones_are_so_much_longer_than_high(stretch):
    sizes = [np.ptp(shape, axis=0) for k in range(3) for shape in map(_whole(PLAIN, k, stretch), range(200))]
    length, height = np.mean(sizes, axis=0)
    assert length / height == pytest.approx(stretch, rel=0.05)


def _whole(panel, seed, stretch):
    tiling = rubble(panel, seed, stretch=stretch, shortest=0.0)
    return tiling.outline


def test_drawn_parameters_are_those_asked_for():
    """Uniform: mean within 3 sigma of the mean, spread d / sqrt(3); stretched to fill the panel by a few percent."""
    pattern = coursed.CoursedPattern(**(PAPER | {"head_angle_deg": (2.0, 4.0)}))
    found = [coursed.stones_in(PLAIN, pattern, draws(seed)).drawn for seed in range(12)]
    values = {key: np.concatenate([drawn[key] for drawn in found]) for key in found[0]}
    for key, (mean, deviation) in (PAPER | {"head_angle_deg": (2.0, 4.0)}).items():
        sigma = deviation / 3**0.5
        slack = 0.03 * abs(mean)  # 20 m of stones of 1.5 m: 13 of 1.54 m
        assert values[key].mean() == pytest.approx(mean, abs=3.0 * sigma / len(values[key]) ** 0.5 + slack), key
        assert values[key].std() == pytest.approx(sigma, rel=0.12), key
    assert sum(drawn["spacing"].sum() for drawn in found) == pytest.approx(120.0, rel=1e-12)
    assert (np.abs(values["deviation"]) <= 0.2).all()
    assert (np.abs(values["head_angle_deg"] - 2.0) <= 4.0 + 1e-9).all()


def test_without_deviations_courses_are_blocks():
    blocks = blocks_of(
        courses(rectangular(6.0, 2.0), 3, spacing=(0.5, 0.0), deviation=(0.0, 0.0), head_spacing=(1.0, 0.0))
    )
    assert [block.id for block in blocks[:7]] == ["1-1", "1-2", "1-3", "1-4", "1-5", "1-6", "2-1"]
    assert [block.course for block in blocks] == [k for k in (1, 2, 3, 4) for _ in range(6)]
    assert {len(block.parts) for block in blocks} == {1}
    assert all(np.ptp(block.parts[0], axis=0) == pytest.approx([1.0, 0.5]) for block in blocks)


def test_rubble_is_named_from_the_lowest_up():
    blocks = blocks_of(rubble(PLAIN, 1))
    assert [block.id for block in blocks] == [str(n + 1) for n in range(len(blocks))]
    heights = [
        np.mean([polygon.centroid(part)[1] for part in block.parts]) for block in blocks if len(block.parts) == 1
    ]
    assert heights == sorted(heights)


@pytest.mark.parametrize(
    ("keys", "key", "message"),
    [
        ({"deviation": (0.0, 0.4)}, "deviation", "beds"),
        ({"deviation": (0.6, 0.0)}, "deviation", "beds"),
        ({"spacing": (1.0, 0.9)}, "spacing", "at most 0.75"),
        ({"head_spacing": (1.5, 1.4)}, "head_spacing", "at most 1.125"),
        ({"head_angle_deg": (0.0, 40.0)}, "head_angle_deg", "heads that lean"),
        ({"head_angle_deg": (50.0, 20.0)}, "head_angle_deg", "at most 60"),
        ({"spacing": (30.0, 0.0)}, "spacing", "has only 10"),
        ({"spacing": (0.01, 0.0), "head_spacing": (0.01, 0.0)}, "head_spacing", "at most 100,000"),
    ],
)  # fmt: skip
def test_what_cannot_be_laid_names_its_key(keys, key, message):
    with pytest.raises((KeyProblem, ValueError), match=message) as caught:
        coursed.CoursedPattern(**(PAPER | keys)).check(20.0, 10.0)
    if isinstance(caught.value, KeyProblem):
        assert caught.value.keys[0] == key


@settings(max_examples=15, deadline=None)
@given(
    spacing=st.tuples(st.floats(0.2, 2.0), st.floats(0.0, 0.6)),
    segment=st.tuples(st.floats(0.2, 3.0), st.floats(0.0, 1.0)),
    deviation=st.tuples(st.floats(-0.2, 0.2), st.floats(0.0, 0.3).map(lambda d: round(d, 3))),
    heads=st.tuples(st.floats(0.3, 3.0), st.floats(0.0, 1.0)),
    angle=st.tuples(st.floats(-20.0, 20.0), st.floats(0.0, 15.0)),
    seed=st.integers(0, 99),
)
def test_any_courses_are_laid_or_refused_by_key(spacing, segment, deviation, heads, angle, seed):
    panel = rectangular(5.0, 4.0, [(1.0, 0.0, 2.0, 2.0)])
    try:
        pattern = coursed.CoursedPattern(
            spacing=spacing, segment=segment, deviation=deviation, head_spacing=heads, head_angle_deg=angle
        )
        tiling = coursed.stones_in(panel, pattern, draws(seed)).tiling
    except ValueError as problem:
        named = (str(problem), *getattr(problem, "keys", ()))
    else:
        return check(tiling, panel)
    assert any(key in text for key in coursed.CoursedPattern.model_fields for text in named)


@settings(max_examples=15, deadline=None)
@given(
    cells=st.integers(2, 60),
    relax=st.integers(0, 6),
    shortest=st.floats(0.0, 0.3),
    stretch=st.floats(0.3, 4.0),
    corner=st.tuples(st.floats(0.3, 2.5), st.floats(0.0, 1.5).map(lambda y: round(y, 3))),
    size=st.tuples(st.floats(0.2, 1.5), st.floats(0.2, 1.4)),
    seed=st.integers(0, 99),
)
def test_any_rubble_fills_its_panel(cells, relax, shortest, stretch, corner, size, seed):
    hole = (*corner, corner[0] + size[0], corner[1] + size[1])
    panel = rectangular(5.0, 3.0, [hole])
    check(rubble(panel, seed, cells=cells, relax=relax, shortest=shortest, stretch=stretch), panel)


def test_concave_polygons_are_cut_into_convex_parts():
    star = np.array([[np.cos(a) * r, np.sin(a) * r] for a, r in zip(np.arange(10) * np.pi / 5, [2.0, 0.8] * 5)])
    parts = convex_parts(star)
    assert all(polygon.is_convex(star[part]) for part in parts)
    assert sum(polygon.area(star[part]) for part in parts) == pytest.approx(polygon.area(star), rel=1e-14)
    assert len(parts) == 4  # five corners point inwards; a cut between two of them takes both
    assert is_simple(star)
    assert not is_simple(star[[0, 2, 4, 6, 8, 1, 3]])
    assert [part.tolist() for part in convex_parts(star[::2])] == [[0, 1, 2, 3, 4]]


def test_a_stone_around_a_hole_falls_apart():
    tiling = rubble(rectangular(4.0, 4.0), 1, cells=2)
    panel = rectangular(4.0, 4.0, [(0.5, 0.5, 0.9, 0.9)])
    found = rubble(panel, 1, cells=2)
    assert len(found.stones) > len(tiling.stones)
    assert sum(shape.area for shape in shapes(found)) == pytest.approx(16.0 - box(0.5, 0.5, 0.9, 0.9).area)


def test_thin_stones_that_are_drawn_far_away():
    """Areas lost their digits there, seeds ran away, and Qhull found all of them on one line."""
    width, height, far = 0.10983992996647383, 1.2042607084440763e-05, [-651.1005155734447, 6546.260259501219]
    outline = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]) + far
    pattern = voronoi.VoronoiPattern(cells=4, relax=100, stretch=0.11)
    found = voronoi.cells_in(outline, 4, pattern, draws(817596793))
    areas = [polygon.area(found.corners[list(stone)] - far) for stone in found.stones]
    assert sum(areas) == pytest.approx(width * height, rel=1e-6)
    assert min(areas) > 0.1 * width * height


def test_an_outline_that_is_flat_is_refused():
    with pytest.raises(KeyProblem, match=r"needs sides that differ by less than 1 to 10000; found 100 by 0\.001 m"):
        voronoi.cells_in(np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 1e-3]]), 4, RELAXED, draws(1))
