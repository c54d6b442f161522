"""Drum columns and temple fronts: volumes and faces in the open in closed form, names, what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from synthetic.skins import free_volume, model_of, open_area

from dem_cli.masonry.structures.columns import drums, temple_front

COLUMN = {
    "radius": 0.45,
    "top_radius": 0.36,
    "height": 4.0,
    "courses": 5,
    "entasis": 0.02,
    "plinth": {"width": 1.0, "height": 0.2},
    "capital": {"width": 1.0, "height": 0.2, "echinus": 0.25},
}
FRONT = {
    "columns": 4,
    "spacing": 2.4,
    "column": COLUMN,
    "architrave": {"height": 0.6, "thickness": 0.8},
    "frieze": {"height": 0.5},
    "cornice": {"height": 0.3, "projection": 0.25, "thickness": 1.0},
    "pediment": {"rise": 1.4, "thickness": 0.6},
}


def polygon_area(radius: float, sides: int) -> float:
    return sides / 2.0 * math.sin(2.0 * math.pi / sides) * radius**2


def frustum_volume(low: float, high: float, height: float, sides: int) -> float:
    a, b = polygon_area(low, sides), polygon_area(high, sides)
    return height / 3.0 * (a + b + math.sqrt(a * b))


def frustum_sides(low: float, high: float, height: float, sides: int) -> float:
    """Area of the faces around a frustum."""
    slant = math.hypot(height, (high - low) * math.cos(math.pi / sides))
    return sides * math.sin(math.pi / sides) * (low + high) * slant


def radii(keys: dict) -> list[float]:
    up = np.arange(keys["courses"] + 1) / keys["courses"]
    return (
        keys["radius"] + up * (keys["top_radius"] - keys["radius"]) + 4.0 * keys["entasis"] * up * (1.0 - up)
    ).tolist()


def column_measures(keys: dict, sides: int) -> tuple[float, float]:
    """Volume, and area of all faces but those of the joints of a column that stands on nothing."""
    r, step = radii(keys), keys["height"] / keys["courses"]
    stones = [(a, b, step) for a, b in zip(r[:-1], r[1:], strict=True)]
    width, high, echinus = (keys["capital"][key] for key in ("width", "height", "echinus"))
    stones.append((r[-1], width / 2.0, echinus))
    volume = sum(frustum_volume(*stone, sides) for stone in stones) + width**2 * high
    area = sum(frustum_sides(*stone, sides) for stone in stones) + 4.0 * width * high + 2.0 * width**2
    area -= polygon_area(width / 2.0, sides)
    wide, low = keys["plinth"]["width"], keys["plinth"]["height"]
    return volume + wide**2 * low, area + 2.0 * wide**2 + 4.0 * wide * low - polygon_area(r[0], sides)


@pytest.mark.parametrize("sides", [6, 24])
def test_a_column_is_a_stack_of_frusta(sides):
    model = model_of({"kind": "drums", "sides": sides, "base": False, **COLUMN})
    volume, area = column_measures(COLUMN, sides)
    assert free_volume(model) == pytest.approx(volume, rel=1e-12)
    assert open_area(model) == pytest.approx(area, rel=1e-9)


def test_radii_and_heights_one_by_one():
    given = {"radii": [0.5, 0.45, 0.42], "heights": [1.0, 0.7], "sides": 8}
    model = model_of({"kind": "drums", **given})
    assert free_volume(model) == pytest.approx(
        frustum_volume(0.5, 0.45, 1.0, 8) + frustum_volume(0.45, 0.42, 0.7, 8), rel=1e-12
    )
    assert model.block_ids == ("drums-base", "drums-1", "drums-2")


def test_a_front_is_columns_and_what_they_carry():
    """The course above the columns lies on squares of 0.8 by 0.8, 1.0 and 1.0 by 0.8 m of each capital."""
    model = model_of({"kind": "temple-front", "base": False, **FRONT})
    volume, area = column_measures(COLUMN, 24)
    length, end = 3 * 2.4 + 1.0, 3 * 2.4 + 1.5
    courses = [(length, 0.8, 0.6), (length, 0.8, 0.5), (end, 1.0, 0.3)]
    triangle = 0.5 * end * 1.4
    beams = sum(x * y * z for x, y, z in courses)
    assert free_volume(model) == pytest.approx(4.0 * volume + beams + 0.6 * triangle, rel=1e-12)
    skin = 4.0 * area + sum(2.0 * (x * y + y * z + z * x) for x, y, z in courses)
    skin += 2.0 * triangle + 0.6 * (end + 2.0 * math.hypot(end / 2.0, 1.4))
    covered = 4.0 * 0.8 * 1.0 + 2.0 * length * 0.8 + 0.6 * end
    assert open_area(model) == pytest.approx(skin - 2.0 * covered, rel=1e-9)


def test_what_blocks_of_a_front_are_called():
    blocks = temple_front.build(temple_front.TempleFront.model_validate({**FRONT, "columns": 2}))
    assert [block.id for block in blocks] == [
        "base",
        *(f"{i}-{name}" for i in (1, 2) for name in ("plinth", "1", "2", "3", "4", "5", "capital")),
        "architrave-1",
        *("frieze-1", "frieze-2"),
        "cornice-1",
        *("pediment-1", "pediment-2"),
    ]


REFUSED = {
    "radius: missing: a shaft needs radius, or radii": {"height": 1.0, "courses": 2},
    "courses: missing: a shaft needs height and courses, or heights": {"height": 1.0, "radius": 0.3},
    "entasis: not allowed beside radii; give radii, or radius": {"heights": [1.0], "radii": [0.5, 0.4], "entasis": 0.1},
    "radii: 2 values; must be one for each of the 3 joints, foot and top too": {
        "heights": [1, 1.0],
        "radii": [0.5, 0.4],
    },
    "capital width: 0.5 is not allowed; must be at least 0.72, as the top of the shaft": {
        **COLUMN,
        "capital": {"width": 0.5, "height": 0.2, "echinus": 0.1},
    },
    "plinth width: 0.5 is not allowed; must be at least 0.9, as the foot of the shaft": {
        **COLUMN,
        "plinth": {"width": 0.5, "height": 0.2},
    },
}


@pytest.mark.parametrize(("message", "keys"), REFUSED.items(), ids=REFUSED)
def test_what_cannot_be_built_is_said_with_its_key(message, keys):
    with pytest.raises(ValidationError) as caught:
        drums.DrumColumn.model_validate(keys)
    problem = caught.value.errors()[0]["ctx"]["error"]
    assert f"{' '.join(map(str, problem.keys))}: {problem}" == message


def test_columns_stand_apart():
    with pytest.raises(ValidationError, match="must be at least 1, the width of a column"):
        temple_front.TempleFront.model_validate({**FRONT, "spacing": 0.9})
