"""The tables of a case, with stand-ins for what the registries hold."""

from __future__ import annotations

import math
from typing import Literal

import pytest
from pydantic import Field, ValidationError, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Pair, Positive, StructureBase
from dem_cli.case.messages import problems_from
from dem_cli.case.schema import Case, case_model
from dem_cli.errors import CaseProblem, dotted


class Heap(StructureBase):
    kind: Literal["heap"] = "heap"
    stones: int = Field(ge=1)


class Ramp(StructureBase):
    kind: Literal["ramp"] = "ramp"
    steps: tuple[Pair, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _rising(self):
        for i, (_, rise) in enumerate(self.steps):
            if rise <= 0:
                raise KeyProblem(f"{rise:g} is not allowed; a step rises", "steps", i, 1)
        return self


class Profile(CaseModel):
    sides: int


class Slick(CaseModel):
    law: Literal["slick"] = "slick"


class Coulomb(CaseModel):
    law: Literal["coulomb"] = "coulomb"
    friction: Positive
    kn: Literal["auto"] | Positive = "auto"
    spread: Positive | tuple[Positive, Positive] | Profile | None = None


class Pushover(CaseModel):
    kind: Literal["pushover"] = "pushover"


MODEL = case_model({"heap": Heap, "ramp": Ramp}, {"coulomb": Coulomb, "slick": Slick}, {"pushover": Pushover})


def tables(**changes):
    good = {
        "materials": {"stone": {"density": 2000}},
        "joints": {"dry": {"friction": 0.6}},
        "structure": [{"kind": "heap", "stones": 3}],
    }
    return good | changes


def said(data) -> list[str]:
    """What is wrong with the tables of a case, one line each."""
    with pytest.raises(ValidationError) as caught:
        MODEL.model_validate(data)
    return [f"{dotted(p.path)}: {p.message}" for p in problems_from(caught.value, MODEL, data)]


def joint(**changes) -> dict:
    return tables(joints={"dry": {"friction": 0.6} | changes})


def test_defaults():
    case = MODEL.model_validate(tables())
    assert isinstance(case, Case)
    assert (case.dimension, case.gravity, case.seed, case.output.snapshots) == (2, 9.81, 1, 20)
    assert case.output.frames is None  # a time history keeps what shows its motion
    assert case.joints["dry"].law == "coulomb"
    assert case.analysis == Pushover()
    assert isinstance(case.materials["stone"].density, float)


def test_a_table_is_the_kind_that_it_says():
    case = MODEL.model_validate(tables(structure=[{"kind": "ramp", "steps": [[1, 2]]}], joints={"a": {"law": "slick"}}))
    assert isinstance(case.structure[0], Ramp)
    assert case.structure[0].steps == ((1.0, 2.0),)
    assert isinstance(case.joints["a"], Slick)


def test_degrees_become_radians():
    heap = Heap(stones=1, rotation_deg=90)
    assert heap.rotation == math.pi / 2


def test_a_case_cannot_be_changed():
    case = MODEL.model_validate(tables())
    with pytest.raises(ValidationError):
        case.gravity = 1.0


def test_joints_between_materials():
    case = MODEL.model_validate(
        tables(
            materials={"a": {"density": 1000}, "b": {"density": 1000}},
            joints={"dry": {"friction": 0.6}, "wet": {"friction": 0.3}},
            interface=[{"between": ["b", "a"], "joint": "wet"}],
        )
    )
    assert case.default_joint == "dry"
    assert case.joint_between("a", "b") == case.joint_between("b", "a") == "wet"
    assert case.joint_between("a", "a") == "dry"


@pytest.mark.parametrize(
    ("value", "lines"),
    [
        (
            "aut",
            ["joints.dry.kn: 'aut' is not allowed, did you mean 'auto'? (must be 'auto' or a number > 0)"],
        ),
        (-1, ["joints.dry.kn: -1 is not allowed; must be 'auto' or a number > 0"]),
        ([1], ["joints.dry.kn: [1] is not allowed; must be 'auto' or a number > 0"]),
    ],
)
def test_a_value_that_fits_no_member_of_a_union_is_one_mistake(value, lines):
    assert said(joint(kn=value)) == lines


@pytest.mark.parametrize(
    ("value", "lines"),
    [
        (
            "x",
            ["joints.dry.spread: 'x' is not allowed; must be a number > 0 or a list of 2 numbers > 0 or a table"],
        ),
        ([1, -1], ["joints.dry.spread.1: -1 is not allowed; must be a number > 0"]),
        ({"side": 3}, ["joints.dry.spread.side: unknown key, did you mean 'sides'?"]),
    ],
)
def test_a_mistake_inside_a_member_is_told_from_there(value, lines):
    assert said(joint(spread=value)) == lines


def test_a_validator_can_blame_a_key():
    data = tables(structure=[{"kind": "ramp", "steps": [[1, 2], [1, 0]]}])
    assert said(data) == ["structure.0.steps.1.1: 0 is not allowed; a step rises"]


def test_lists_that_are_too_short_or_too_long():
    steps = {"kind": "ramp", "steps": [[1, 2], [1], [1, 2, 3]]}
    assert said(tables(structure=[steps, {"kind": "ramp", "steps": []}])) == [
        "structure.0.steps.1: [1] is not allowed; must be a list of 2 numbers",
        "structure.0.steps.2: [1, 2, 3] is not allowed; must be a list of 2 numbers",
        "structure.1.steps: [] is not allowed; must be a list of at least 1 lists of 2 numbers",
    ]


def test_missing_is_not_said_of_a_key_that_is_misspelt():
    assert said(tables(structure=[{"kind": "heap", "stoned": 3}])) == [
        "structure.0.stoned: unknown key, did you mean 'stones'?"
    ]


def test_no_words_of_the_validator_reach_the_user():
    data = joint(kn={}, spread=[], law=3) | {"gravity": {}, "load": 3, "monitor": [{}]}
    text = "\n".join(said(data))
    for word in ("pydantic", "Input should", "tuple", "type=", "dict", "literal", "float", "None"):
        assert word not in text


def test_a_kind_must_declare_itself():
    with pytest.raises(TypeError, match="Heap must declare kind"):
        case_model({"pile": Heap}, {"coulomb": Coulomb}, {"pushover": Pushover})


def test_one_kind_alone():
    model = case_model({"heap": Heap}, {"coulomb": Coulomb}, {"pushover": Pushover})
    assert model.model_validate(tables()).analysis.kind == "pushover"
    data = tables(structure=[{"kind": "heep", "stones": 1}])
    with pytest.raises(ValidationError) as caught:
        model.model_validate(data)
    assert problems_from(caught.value, model, data) == [
        CaseProblem(("structure", 0, "kind"), "unknown kind 'heep', did you mean 'heap'? (allowed: 'heap')")
    ]


def test_json_schema_describes_every_key_of_the_tables_here():
    schema = MODEL.model_json_schema()
    for name in (
        "Material",
        "BlockTable",
        "Load",
        "Monitor",
        "Output",
        "Reference",
        "Settlement",
        "Interface",
    ):
        for key, field in schema["$defs"][name]["properties"].items():
            assert field.get("description"), f"{name}.{key}"
