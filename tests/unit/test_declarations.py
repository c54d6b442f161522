"""Declared parameters: frozen records without pydantic, and the tables of case files that follow from them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import pytest
from pydantic import BaseModel, ValidationError

from dem_cli.app.api import load_case
from dem_cli.case.tables.declared import table_of
from dem_cli.core.laws.fracture import FractureJoint
from dem_cli.declarations import KeyProblem, Limits, Parameters, Positive, SpaceVector, parameter
from dem_cli.masonry.assembly.solver_request import solver_request

CASES = Path(__file__).resolve().parents[2] / "cases" / "verification"
ALONE = """
import sys
import dem_cli.core.laws.registry, dem_cli.core.laws.mohr_coulomb
import dem_cli.core.links.registry, dem_cli.core.links.tie, dem_cli.core.links.bar
import dem_cli.core.motion.motion, dem_cli.core.motion.synthetic, dem_cli.core.motion.eurocode_suites
from dem_cli.core.laws.displacement_path import drive
law = dem_cli.core.laws.registry.LAWS["mohr-coulomb"]
joint = law.parameters(friction=0.5, cohesion=1e4)
print(float(drive(law, joint, [[-1e-6, 0.0], [-1e-6, 2.0**-20]], kn=1e9).shear[1, 0]), joint.coefficient)
print(sorted({"pydantic", "h5py", "click", "rich", "matplotlib"} & {name.split(".")[0] for name in sys.modules}))
"""


class Inner(Parameters):
    """A record in another one."""

    share: float = parameter(ge=0.0, le=1.0, description="share that is left [-]", examples=[0.5])


class Outer(Parameters):
    """A record with all sorts of parameters."""

    kept: ClassVar[int] = 3

    kind: Literal["outer"] = "outer"
    length: Positive = parameter(description="length [m]", examples=[2.0])
    least: Positive | None = parameter(default=None, description="at most the length [m]", examples=[1.0])
    sides: Annotated[int, Limits(ge=2, le=5)] | Literal["all"] = parameter(default="all", description="sides")
    direction: SpaceVector = parameter(default=(1.0, 0.0), description="along [-]")
    inner: Inner | None = parameter(default=None, description="another one", examples=[{"share": 0.5}])

    def check(self) -> None:
        """The least is not more than the length."""
        super().check()
        if self.least is not None and self.least > self.length:
            raise KeyProblem(f"{self.least:g} is more than length = {self.length:g}", "least")


class Wider(Outer):
    """One that inherits."""

    kind: Literal["wider"] = "wider"
    width: float = parameter(default=1.0, gt=0.0, description="width [m]")


def test_laws_links_and_motions_stand_alone():
    """The solver's own records need no pydantic; a law answers with them alone."""
    answer = subprocess.run([sys.executable, "-c", ALONE], capture_output=True, text=True, check=True).stdout
    assert answer.split("\n")[:2] == [f"{-1e9 * 2.0**-20} 0.5", "[]"]


def test_a_record_has_its_values_and_defaults():
    record = Wider(length=2.0, inner=Inner(share=0.25))
    assert (record.kind, record.length, record.least, record.width, record.kept) == ("wider", 2.0, None, 1.0, 3)
    assert record.names_given == {"length", "inner"}
    assert record == Wider(length=2.0, inner=Inner(share=0.25), width=1.0) != Wider(length=3.0)
    assert hash(record) == hash(record.with_values(width=1.0))
    with pytest.raises(AttributeError, match="frozen"):
        record.length = 3.0
    assert list(Wider.declared) == ["kind", "length", "least", "sides", "direction", "inner", "width"]


@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        ({"length": 0.0}, "length"),
        ({"length": "2"}, "length"),
        ({"length": True}, "length"),
        ({"length": float("nan")}, "length"),
        ({"least": 3.0}, "least"),
        ({"sides": 6}, "sides"),
        ({"sides": "none"}, "sides"),
        ({"direction": (1.0,)}, "direction"),
        ({"width": 0.0}, "width"),
        ({"inner": {"share": 0.5}}, "inner"),
    ],
)
def test_a_record_takes_no_value_that_its_table_refuses(wrong, key):
    with pytest.raises(KeyProblem) as found:
        Wider(**{"length": 2.0} | wrong)
    assert found.value.keys == (key,)
    assert found.value.__notes__ == [f"Wider: {key}"]
    if key != "inner":  # which a case file gives as a table
        with pytest.raises(ValidationError):
            table_of(Wider).model_validate({"length": 2.0} | wrong)


def test_a_declaring_file_keeps_annotations_as_they_are_written():
    with pytest.raises(TypeError, match="begin it with `from __future__ import annotations`"):
        type("Evaluated", (Parameters,), {"__annotations__": {"length": float}, "__module__": __name__})


def test_names_are_known_and_given():
    with pytest.raises(TypeError, match="'wide' is no parameter, 'length' is missing"):
        Wider(wide=1.0)


def test_solvers_are_handed_records_alone():
    """Nothing of pydantic is in the request that a case makes of them."""
    case = load_case(CASES / "mortar_wall_cycle.toml").case
    joints = solver_request(case).joints.named
    assert {name: type(joint) for name, joint in joints.items()} == dict.fromkeys(case.joints, FractureJoint)
    assert not isinstance(joints["mortar"], BaseModel)
    assert joints["mortar"].tension == case.joints["mortar"].tension


def test_changes_are_not_checked():
    record = Outer(length=2.0, least=1.0)
    changed = record.with_values(length=0.5)
    assert (changed.length, changed.least, record.length) == (0.5, 1.0, 2.0)
    assert changed.names_given == {"length", "least"}
    with pytest.raises(KeyProblem, match="more than length"):
        changed.check()


@pytest.mark.parametrize("values", [{"length": 2.0}, {"length": 2, "least": 1.5, "sides": 4, "inner": {"share": 0.5}}])
def test_a_table_is_such_a_record(values):
    table = table_of(Wider).model_validate(values)
    plain = Wider(**values | ({"inner": Inner(share=0.5)} if "inner" in values else {}))
    assert isinstance(table, BaseModel)
    assert isinstance(table, Wider)
    assert table.names_given == plain.names_given == table.alone.names_given
    assert type(table.alone) is type(plain) is Wider
    assert table.alone == plain == plain.alone
    assert table.with_values(width=3.0).width == 3.0


def test_a_table_says_what_the_declaration_says():
    made = table_of(Wider)
    assert made is table_of(Wider)
    assert (made.__name__, made.__doc__, made.__module__) == ("Wider", "One that inherits.", __name__)
    assert list(made.model_fields) == list(Wider.declared)
    properties = made.model_json_schema()["properties"]
    assert properties["width"] == {
        "default": 1.0, "description": "width [m]", "exclusiveMinimum": 0.0, "title": "Width", "type": "number"
    }  # fmt: skip
    assert properties["direction"]["minItems"] == 2
    with pytest.raises(ValidationError, match="is more than length"):
        made.model_validate({"length": 1.0, "least": 2.0})
