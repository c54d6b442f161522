"""One number of a case with another value."""

from __future__ import annotations

import pytest
from casefiles import CASES, FILES, case_id

from dem_cli.app.api import load_case
from dem_cli.case.variation import value_at, with_value
from dem_cli.errors import CaseError

ARCH = CASES / "verification" / "least_thickness_arch.toml"


@pytest.fixture(scope="module")
def arch():
    return load_case(ARCH).case


@pytest.mark.parametrize("path", FILES[::4], ids=case_id)
def test_the_same_value_is_the_same_case(path):
    case = load_case(path).case
    material = next(iter(case.materials))
    key = f'materials."{material}".density'
    assert with_value(case, key, value_at(case, key)) == case


@pytest.mark.parametrize("key", ["structure.0.ring", "joints.dry.friction", "structure.0.origin.1", "gravity"])
def test_another_value(arch, key):
    before = value_at(arch, key)
    assert value_at(with_value(arch, key, 0.25), key) == 0.25
    assert value_at(arch, key) == before


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("structure.0.rings", "structure.0 has no 'rings', did you mean 'ring'?"),
        ("structure.2.ring", "structure has the numbers 0 to 0"),
        ("block.0.thickness", "there is no [[block]]"),
        ("joints.wet.friction", "joints has no 'wet'"),
        ("joints.dry.law", "it is 'coulomb'"),
        ("structure.0.span", "it has no value"),
        ("structure.0.origin", "it is not one number"),
        ("analysis.resolution", "it changes neither structure nor load"),
        ("output.frames", "it changes neither structure nor load"),
        ("..", "is not a key path"),
    ],
)
def test_keys_that_cannot_be_varied(arch, key, message):
    with pytest.raises(CaseError) as raised:
        value_at(arch, key)
    assert message in str(raised.value)
    assert raised.value.problems[0].path == ("analysis", "vary")


def test_values_that_a_table_refuses(arch):
    with pytest.raises(CaseError) as raised:
        with_value(arch, "structure.0.ring", 25.0)
    assert str(raised.value).startswith("analysis.between: structure.0.ring = 25 is not possible: structure.0.radius: ")
