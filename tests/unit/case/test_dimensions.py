"""What cases of two and of three dimensions have: vectors, keys that one of them alone knows, and where it is said."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic.spatial_case import extruded_tables, spatial_case

from dem_cli.app.api import make_case_model
from dem_cli.case.dimensions import NAME, SCOPES, in_space, known_in
from dem_cli.case.keys import json_schema, tables
from dem_cli.case.reader import CaseSource, validate
from dem_cli.case.variation import value_at, with_value
from dem_cli.case.vector import VectorLength
from dem_cli.case.writer import case_text
from dem_cli.errors import CaseError

WALL = {"kind": "wall", "block": [1.0, 0.5], "courses": 2, "blocks_per_course": 2}
ALL = tables(make_case_model())
numbers = st.floats(-10.0, 10.0)


@pytest.mark.parametrize("scope", SCOPES, ids=lambda scope: scope.key)
def test_every_key_of_the_table_exists(scope):
    """A key that is renamed takes its line along; values are values of the key."""
    steps = tuple(scope.key.split("."))
    keys = [key for table in ALL for key in table.keys if (*table.path, key.name) == steps]
    assert keys
    for value in scope.values:
        assert any(str(value) in key.allowed or isinstance(value, int) for key in keys), value
    assert NAME in steps or "NAME" not in steps


def test_what_is_known_in_one_dimension_is_said_in_the_schema():
    schema = json_schema(make_case_model())
    blocks, wall, initial = (schema["$defs"][name] for name in ("BlockTable", "Wall", "InitialState"))
    assert blocks["properties"]["thickness"]["description"].endswith("(2D only)")
    assert blocks["properties"]["polygon"]["description"].endswith("(3D only)")
    assert wall["properties"]["sides"]["description"].endswith("(3D only)")
    assert "(3D only)" in initial["properties"]["axis"]["description"]
    assert (schema["properties"]["dimension"]["enum"], known_in(("load", "force"))) == ([2, 3], None)
    origin = wall["properties"]["origin"]
    assert (origin["minItems"], origin["maxItems"]) == (2, 3)
    number, turns = schema["$defs"]["Settlement"]["properties"]["rotation_deg"]["anyOf"]
    assert (number["type"], turns["minItems"], turns["maxItems"]) == ("number", 3, 3)


@given(values=st.lists(numbers, max_size=5), dimension=st.sampled_from([2, 3]))
@settings(deadline=None, max_examples=60)
def test_a_vector_is_as_long_as_the_case_has_dimensions(values, dimension):
    tables_ = {"dimension": dimension, "structure": [WALL | {"origin": values}]}
    try:
        case = spatial_case(**tables_)
    except CaseError as error:
        assert len(values) != dimension
        (problem,) = error.problems
        assert problem.path == ("structure", 0, "origin")
        assert f"must be a list of {dimension} numbers" in problem.message
    else:
        assert case.structure[0].origin == tuple(values)


def test_vectors_that_are_left_out_have_three_components():
    case = spatial_case(structure=[WALL, WALL | {"origin": [1.0, 2.0, 3.0]}])
    assert [wall.origin for wall in case.structure] == [(0.0, 0.0, 0.0), (1.0, 2.0, 3.0)]
    assert case.analysis.direction == (1.0, 0.0, 0.0)
    assert "origin" not in case.structure[0].model_fields_set
    assert in_space(case) is case
    assert VectorLength(3, 6).padded((0.0, 0.0, 0.0)) == (0.0,) * 6
    assert VectorLength(1, 3).padded(2.0) == (2.0, 0.0, 0.0)


def test_the_effective_case_gives_itself():
    """Defaults that are of the other dimension are left out of it."""
    case = spatial_case(
        structure=[WALL | {"sides": [{"face": "-y", "strip": 0.4}]}],
        block=[{"id": "a", "polygon": [[0, 1], [1, 1], [1, 2]], "y": [0, 1]}],
        monitor=[{"block": "a", "quantity": "rotation", "component": "z"}, {"point": [0.1, 0.1, 0.1]}],
        settlement=[{"block": "wall-base"}, {"block": "wall-base", "rotation_deg": [1.0, 0.0, 0.0]}],
        initial=[{"block": "a", "tilt": 0.1}, {"block": "a", "velocity": [1, 0, 0, 0, 0, 0]}],
    )
    text = case_text(case)
    again = validate(tomllib.loads(text), make_case_model(), CaseSource(Path("case.toml"), text))
    assert again.model_copy(update={"dem": None}) == case
    assert case_text(again) == text
    assert case.monitor[1].place == "(0.1, 0.1, 0.1)"


def test_turns_of_the_plane_and_of_space():
    """A turn is a number in the plane, axis times angle in space; the plane one is about −y there."""
    plane = {"settlement": [{"block": "base", "rotation_deg": 90}], "initial": [{"block": "a", "tilt": -0.1}]}
    space = extruded_tables(plane)
    askew = {"block": "a", "tilt": 0.5, "axis": [3, 4, 0], "velocity": [1, 2, 3, 4, 5, 6]}
    settled, turned = (
        spatial_case(structure=[WALL], settlement=space["settlement"], initial=[table])
        for table in (*space["initial"], askew)
    )
    flat = spatial_case(dimension=2, structure=[WALL], **plane)
    assert flat.settlement[0].rotation == pytest.approx((math.pi / 2,))
    assert settled.settlement[0].rotation == pytest.approx((0.0, -math.pi / 2, 0.0))
    assert (flat.initial[0].turn, settled.initial[0].turn) == ((-0.1,), (0.0, 0.1, 0.0))
    assert turned.initial[0].turn == pytest.approx((0.3, 0.4, 0.0))
    assert turned.initial[0].velocity == (1, 2, 3, 4, 5, 6)
    still = spatial_case(structure=[WALL], settlement=[{"block": "base", "displacement": [0.0, 0.0, -0.1]}])
    assert still.settlement[0].rotation == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("turn", [True, "1", [1.0], [1.0, 2.0], [0.0, 0.0, 0.0, 0.0]])
def test_a_turn_is_a_number_or_three(turn, dimension):
    """Whatever else it is, what is allowed is said."""
    allowed = "a number" if dimension == 2 else "a list of 3 numbers in a case with dimension = 3"
    with pytest.raises(CaseError, match=f"is not allowed; must be {allowed}$"):
        spatial_case(dimension=dimension, structure=[WALL], settlement=[{"block": "base", "rotation_deg": turn}])


def test_a_case_that_varies_keeps_its_vectors():
    case = spatial_case(structure=[WALL | {"origin": [1.0, 2.0, 3.0]}], analysis={"kind": "gravity"})
    varied = with_value(case, "structure.0.thickness", 0.3)
    assert (varied.structure[0].origin, varied.dimension) == ((1.0, 2.0, 3.0), 3)
    with pytest.raises(CaseError, match="changes neither structure nor load"):
        value_at(case, "dimension")
