"""The failure load of an irregular wall is the same, whatever estimate of it the search begins with."""

from __future__ import annotations

import pytest

import dem_cli
from dem_cli.statics.failure_load import LoadSearch

WALL = """
[materials.stone]
density = 2100.0
[joints.dry]
friction = 0.65
[[structure]]
id = "w"
kind = "voronoi-wall"
cells = 14
relax = 6
stretch = 1.6
size = [1.6, 1.6]
thickness = 0.5
seed = 123
[analysis]
kind = "pushover"
follow = 0
"""


@pytest.mark.parametrize("wrong", [-0.15, 0.07])
def test_wrong_estimates(tmp_path, monkeypatch, wrong):
    """Larger steps come to 0.4130 to 0.4219, by the estimate; what is stated does not."""
    case = tmp_path / "wall.toml"
    case.write_text(WALL)
    right, expected = dem_cli.run(case).summary, LoadSearch._expected

    def wrongly(self, estimate):
        load, failing = expected(self, estimate)
        self.plateau *= 1.0 + wrong
        return (1.0 + wrong) * load, failing

    monkeypatch.setattr(LoadSearch, "_expected", wrongly)
    found = dem_cli.run(case).summary
    assert found["search"][1]["load"] == pytest.approx((1.0 + wrong) * right["search"][1]["load"])
    assert found["failure_load_bracket"] == right["failure_load_bracket"]
    assert found["load_range"]["lowest"] < found["failure_load"]
    assert found["warnings"][0].startswith("methods differ by")
