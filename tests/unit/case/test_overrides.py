"""Key paths of a case, and what stands there."""

from __future__ import annotations

from pathlib import Path

import pytest

from dem_cli.app.api import load_case
from dem_cli.case.overrides import key_path, value_at

COLUMN = Path(__file__).resolve().parents[3] / "cases" / "verification" / "column_14.toml"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("joints.dry.friction", 0.6),
        ("structure.0.courses", 14),
        ("structure.0.block.1", 0.0175),
        ("structure.7.courses", None),
        ("joints.wet.friction", None),
        ("joints.dry.frcition", None),
        ("a b", None),  # no key path at all
    ],
)
def test_value_at_a_key_path(key, value):
    assert value_at(load_case(COLUMN).case, key_path(key)) == value
