"""[ground]: structures of every kind leave out their bases, so that nothing has two joints with what it stands on."""

from __future__ import annotations

import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.structures.building.table import Building

WALLS = [{"id": "a", "axis": [[0.0, 0.0], [3.0, 0.0]]}, {"id": "b", "axis": [[0.0, 0.0], [0.0, 3.0]]}]
BUILDING = {"kind": "building", "material": "peperino", "block": [0.5, 0.25], "courses": 2, "walls": WALLS}
BARREL = {"kind": "vault", "material": "peperino", "shape": "barrel", "span": 4.0, "rise": 1.0, "length": 2.0,
          "thickness": 0.4, "voussoirs": 9}  # fmt: skip


def fixed(table, **ground):
    model = assembly(spatial_case(structure=[table], ground={"material": "peperino", **ground})).model
    return [name for name, held in zip(model.block_ids, model.fixed, strict=True) if held]


def test_a_building_on_the_ground_has_no_slab_of_its_own():
    """It kept its slab in the ground: every block of the lowest course had two joints below it."""
    assert fixed(BUILDING) == ["ground"]


def test_springings_without_piers_stay_fixed():
    """They lost what holds them without a word."""
    assert len(fixed(BARREL | {"origin": [0.0, 0.0, 3.0]}, level=0.0)) == 3
    with pytest.raises(CaseError, match="is fixed and lies in it"):
        fixed(BARREL)


def test_a_seed_that_draws_nothing_is_refused():
    with pytest.raises(ValueError, match="not used without a pattern"):
        Building.model_validate(BUILDING | {"seed": 1})
