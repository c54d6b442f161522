"""Masonry: what is laid fills the wall, however it is bonded, pierced and topped; nothing short, nothing twice."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from pydantic import ValidationError
from shapely.geometry import Polygon, box
from synthetic.skins import free_volume, model_of, open_area

from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures import arch
from dem_cli.masonry.structures.openings import Opening
from dem_cli.masonry.structures.wall import Wall
from dem_cli.masonry.structures.wall_blocks import build

SHAPES = ("segmental", "semicircular", "pointed", "flat", "circle", "lintel", "none")


def wall(**keys) -> Wall:
    return Wall.model_validate({"block": [0.5, 0.25], "courses": 12, "length": 6.0} | keys)


def free(**keys):
    return [block for block in build(wall(**keys)) if not block.fixed]


def opening(shape: str, rng: np.random.Generator, left: float) -> dict:
    """A random opening 0.5 to 1.1 m wide, from `left` to 2.6 m further."""
    width = rng.uniform(0.5, 1.1)
    keys = {"x": left + rng.uniform(0.7, 1.4), "y": rng.choice([0.0, rng.uniform(0.4, 0.8)]), "width": width}
    keys["height"] = width if shape == "circle" else rng.uniform(0.4, 1.0)
    if shape == "lintel":
        return keys | {"lintel": {"height": rng.uniform(0.1, 0.3), "bearing": rng.uniform(0.1, 0.3)}}
    if shape == "none":
        return keys
    arch = {"shape": shape, "voussoirs": 2 * int(rng.integers(3, 8)), "ring": rng.uniform(0.15, 0.3)}
    if shape == "circle":
        keys["y"] = rng.uniform(0.4, 0.8)
    rises = {"segmental": rng.uniform(0.1, 0.4), "pointed": rng.uniform(0.6, 1.0)}
    return keys | {"arch": arch | ({"rise": width * rises[shape]} if shape in rises else {})}


def random_wall(seed: int) -> dict:
    """Keys of a wall 3 m high with two openings and any top."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(5.4, 7.0)
    first, second = rng.choice(SHAPES, 2)
    keys = {
        "length": length,
        "block": [rng.choice([0.4, 0.5, 0.6]), 0.25],
        "bond": str(rng.choice(["running", "stack", "english", "english-garden", "flemish"])),
        "first": str(rng.choice(["half", "full"])),
        "openings": [opening(str(first), rng, 0.0), opening(str(second), rng, length / 2.0)],
    }
    tops = [
        {"gable": {"height": rng.uniform(0.5, 2.0)}},
        {"profile": [[0.0, 3.0], [length * rng.uniform(0.2, 0.8), rng.uniform(2.6, 3.0)], [length, 2.7]]},
        {},
    ]
    keys |= tops[seed % 3]
    return keys | ({"quoins": {"length": 0.6, "height": int(rng.integers(1, 4))}} if seed % 4 == 0 else {})


def solid(table: Wall) -> Polygon:
    """What is to be filled, drawn by another library."""
    height = float(table.levels[-1])
    outline = [[0.0, 0.0], [table.extent, 0.0], [table.extent, height], [0.0, height]]
    if table.gable:
        outline.insert(3, [table.extent / 2.0, height + table.gable.height])
    if table.profile:
        outline[2:] = [list(point) for point in table.profile[::-1]]
    filled = Polygon(outline)
    for hole in table.openings:
        if hole.arch is None or hole.arch.form != "circle":
            filled = filled.difference(box(*hole.box))
        if hole.arch is not None and hole.arch.form != "flat":
            filled = filled.difference(Polygon(hole.void.joints[:, 0]))
    return filled


@pytest.mark.parametrize("seed", range(24))
def test_a_wall_is_filled_once_and_nothing_is_short(seed):
    table = wall(**random_wall(seed))
    blocks = [block for block in build(table) if not block.fixed]
    parts = [part for block in blocks for part in block.parts]
    area = sum(polygon.area(part) for part in parts)
    assert area == pytest.approx(solid(table).area, rel=1e-12)
    assert shapely.union_all([Polygon(part) for part in parts]).area == pytest.approx(area, rel=1e-9)  # its own error
    assert all(polygon.is_convex(part) for part in parts)
    assert len({block.id for block in blocks}) == len(blocks)
    full = table.block[0] * table.block[1]
    least = min(sum(map(polygon.area, block.parts)) for block in blocks if block.course)
    assert least >= 0.25 * full * (1.0 - 1e-5)


def joints(blocks, course: int, leaf: str = "") -> list[float]:
    """Where the head joints of a course are, its ends left out."""
    own = [b for b in blocks if b.course == course and (not leaf or not b.id[-1].isalpha() or b.id.endswith(leaf))]
    return sorted({round(float(part[:, 0].min()), 9) for block in own for part in block.parts})[1:]


@pytest.mark.parametrize("bond", ["english", "english-garden", "flemish"])
@pytest.mark.parametrize("length", [6.0, 5.83, 6.2])
def test_no_vertical_joint_runs_through_two_courses(bond, length):
    """Also beside a door, in both leaves, whatever the length."""
    door = {"x": 2.0, "y": 0.0, "width": 1.13, "height": 1.5, "lintel": {"height": 0.25, "bearing": 0.25}}
    blocks = free(bond=bond, length=length, openings=[door], leaves=2, thickness=0.5)
    for course in range(1, 12):
        own, next_ones = (
            [x for x in joints(blocks, k) if min(abs(x - jamb) for jamb in (2.0, 3.13, 1.75, 3.38)) > 1e-6]
            for k in (course, course + 1)
        )
        assert own
        assert min(abs(a - b) for a in own for b in next_ones) > 0.04 * 0.5


def test_headers_go_through_and_stretchers_lie_side_by_side():
    """6 m of blocks of 0.5 m: 12 stretchers in each leaf, or 11 headers, two of them and two closers at the ends."""
    blocks = free(bond="english", leaves=2, thickness=0.5, first="full")
    stretchers, headers = ([b for b in blocks if b.course == course] for course in (1, 2))
    assert [b.id for b in stretchers[:4]] == ["1-1a", "1-1b", "1-2a", "1-2b"] or len(stretchers) == 24
    assert {b.across for b in stretchers} == {(-0.25, 0.0), (0.0, 0.25)}
    lengths = [round(float(np.ptp(b.parts[0][:, 0])), 9) for b in headers]
    assert lengths == [0.25, 0.125, *[0.25] * 21, 0.125, 0.25]
    assert {b.across for b in headers} == {None}
    flemish = [b for b in free(bond="flemish", leaves=2, thickness=0.5, first="full") if b.course == 1]
    assert (
        len([b for b in flemish if b.across is None]) == 8
    )  # one after each of 8 stretchers; the last pair ends short
    assert len([b for b in flemish if b.across is not None]) == 16


def test_through_stones_are_a_share_of_the_stones_of_a_face():
    blocks = free(leaves=2, through_stones=0.2, first="full", bond="stack", length=5.0, courses=20)
    through = [b for b in blocks if not b.id[-1].isalpha()]
    assert len(through) == 0.2 * 200
    assert {b.id for b in through if b.course == 1} == {"1-5", "1-10"}
    assert {b.id for b in through if b.course == 2} == {"2-3", "2-8"}


DOOR = {"x": 2.2, "y": 0.0, "width": 1.1, "height": 1.0, "arch": {"voussoirs": 9, "ring": 0.3}}
WALLS = {
    "two leaves": {"leaves": 2},
    "english": {"leaves": 2, "bond": "english", "openings": [DOOR]},
    "flemish": {"leaves": 3, "bond": "flemish", "openings": [DOOR], "gable": {"height": 1.3}},
    "through": {"leaves": 2, "through_stones": 0.2, "quoins": {"length": 0.75, "height": 2}},
    "core": {"leaves": 3, "core": {"thickness": 0.2}, "through_stones": 0.1, "openings": [DOOR]},
}


@pytest.mark.parametrize("name", WALLS)
def test_in_space_every_inner_face_is_shared(name):
    """All faces less twice the joints are the outside: front and back, ends, top, jambs and soffit, and the base."""
    keys = {"kind": "wall", "block": [0.5, 0.25], "courses": 10, "length": 5.0, "thickness": 0.5} | WALLS[name]
    table = Wall.model_validate({key: value for key, value in keys.items() if key != "kind"})
    filled = solid(table)
    model = model_of(keys)
    assert free_volume(model) == pytest.approx(0.5 * filled.area, rel=1e-12)
    on_base = 5.0 - (1.1 if "openings" in keys else 0.0)
    wall_skin = 2.0 * filled.area + 0.5 * (filled.length - on_base)
    base_skin = 2.0 * 5.0 * 0.25 + 2.0 * 0.5 * 0.25 + 0.5 * 5.0 + 0.5 * (5.0 - on_base)
    assert open_area(model) == pytest.approx(wall_skin + base_skin, rel=1e-9)


def test_voussoirs_are_those_of_the_arch_alone():
    """An arch in a wall whose crown is on no bed joint: the same corners as kind = "arch"."""
    alone = arch.build(arch.Arch(voussoirs=9, inner_radius=0.55, ring=0.3))[2:]
    within = [b for b in free(openings=[DOOR], courses=16, block=[0.5, 0.3]) if b.id.startswith("arch-")]
    assert [b.id for b in within] == [f"arch-1-{n}" for n in range(1, 10)]
    for one, other in zip(alone, within, strict=True):
        assert other.parts[0] - [2.75, 1.0] == pytest.approx(one.parts[0], abs=1e-14)


def test_corners_of_voussoirs_close_to_a_bed_joint_lie_on_it():
    """Rings 0.30 m deep whose crown is 1.85 m high, under a bed joint at 1.86 m: 10 mm are 3 % of a course."""
    crown = next(b for b in free(openings=[DOOR], courses=9, block=[0.5, 0.31]) if b.id == "arch-1-5").parts[0]
    assert np.sort(crown[:, 1])[2:] == pytest.approx([1.86, 1.86], abs=1e-15)


def test_a_round_opening_needs_no_height():
    """Its width is its diameter; a height was asked for that could be nothing else."""
    keys = {"x": 2.0, "y": 1.0, "width": 0.8, "arch": {"shape": "circle", "voussoirs": 9, "ring": 0.2}}
    assert Opening.model_validate(keys) == Opening.model_validate(keys | {"height": 0.8})
    assert Opening.model_json_schema()["required"] == ["x", "y", "width"]
    for width, said in ((-1.0, {"width"}), ("a", {"width"})):
        with pytest.raises(ValidationError) as caught:
            Opening.model_validate(keys | {"width": width})
        assert {error["loc"][0] for error in caught.value.errors()} == said
    with pytest.raises(ValidationError, match="Field required"):
        Opening.model_validate(keys | {"arch": {"voussoirs": 9, "ring": 0.2}})


def test_a_stepped_gable_has_the_area_of_its_triangle():
    """Courses end where half of their height is under the slope."""
    blocks = [b for b in free(gable={"height": 1.5, "edges": "stepped"}) if b.course > 12]
    assert sum(polygon.area(part) for b in blocks for part in b.parts) == pytest.approx(6.0 * 1.5 / 2.0, rel=1e-12)
    assert {b.course for b in blocks} == set(range(13, 19))


def test_quoins_are_long_and_short_in_turn():
    blocks = {b.id: b.parts[0] for b in free(quoins={"length": 0.8, "height": 2})}
    spans = {name: (shape.min(axis=0), np.ptp(shape, axis=0)) for name, shape in blocks.items() if "quoin" in name}
    assert len(spans) == 12
    for n in range(1, 7):
        size = [0.8 if n % 2 else 0.4, 0.5]
        assert spans[f"quoin-left-{n}"][1] == pytest.approx(size)
        assert spans[f"quoin-right-{n}"][0] == pytest.approx([6.0 - size[0], (n - 1) * 0.5])


BAD = {
    "blocks_per_course: a wall needs either blocks_per_course or length; found both": {"blocks_per_course": 3},
    "ends: 'toothed' is not allowed with length": {"ends": "toothed"},
    "through_stones: not used with leaves = 1: every stone goes through": {"through_stones": 0.2},
    "through_stones: not used with bond = 'flemish': its headers go through": {
        "through_stones": 0.2, "leaves": 2, "bond": "flemish"
    },
    "core: a core is the middle one of three leaves: give leaves = 3": {"core": {"thickness": 0.2}, "leaves": 2},
    "core.thickness: 1.2 is not allowed; must be less than the thickness of the wall, 1": {
        "core": {"thickness": 1.2}, "leaves": 3
    },
    "quoins.length: 3.5 is not allowed; must be at most 3, half the wall": {"quoins": {"length": 3.5}},
    "profile: a wall has a gable or a profile, not both": {"profile": [[0, 3], [6, 3]], "gable": {"height": 1.0}},
    "profile.1: x = 5 is not allowed; must be 6, the right end of the wall": {"profile": [[0, 3], [5, 3]]},
    "profile.1: y = 4 is not allowed; must be above 0 and at most 3, the top of the courses": {
        "profile": [[0, 3], [6, 4]]
    },
    "gable.ridge: 7 is not allowed; must be less than the length of the wall, 6": {
        "gable": {"height": 1.0, "ridge": 7.0}
    },
    "openings.0: reaches above the top of the wall there": {
        "openings": [DOOR | {"y": 1.0}], "profile": [[0, 3], [3, 2.4], [6, 3]]
    },
    "openings.0.arch: the arch would reach from [-0.2, 0] to [1.5, 1.83709]; the wall is 6 long and 3 high": {
        "openings": [DOOR | {"x": 0.1}]
    },
    "openings.1.arch: crosses openings.0: arches, lintels and openings lie beside each other": {
        "openings": [DOOR, DOOR | {"x": 3.5}]
    },
    "openings.0.arch: an opening has a lintel or an arch, not both": {
        "openings": [DOOR | {"lintel": {"height": 0.2, "bearing": 0.2}}]
    },
    "openings.0.height: 1 is not allowed; a circle is as high as it is wide, 1.1": {
        "openings": [DOOR | {"arch": {"shape": "circle", "voussoirs": 9, "ring": 0.3}}]
    },
    "openings.0.arch.rise: 0.9 is not allowed; must be at most 0.55 (half the span, a semicircle)": {
        "openings": [DOOR | {"arch": {"rise": 0.9, "voussoirs": 9, "ring": 0.3}}]
    },
    "openings.0.arch.rise: not used by a flat arch": {
        "openings": [DOOR | {"arch": {"shape": "flat", "rise": 0.9, "voussoirs": 9, "ring": 0.3}}]
    },
}  # fmt: skip


@pytest.mark.parametrize(("message", "keys"), BAD.items())
def test_what_cannot_be_built_is_said_at_its_key(message, keys):
    with pytest.raises(ValidationError) as error:
        wall(**keys)
    (found,) = error.value.errors()
    cause = found["ctx"]["error"]
    assert ".".join(map(str, (*found["loc"], *getattr(cause, "keys", ())))) + f": {cause}" == message
