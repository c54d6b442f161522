"""What is odd about blocks and loads in 3D, and which unit was meant."""

from __future__ import annotations

import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.masonry.assembly import sanity, validate
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.place_notes import common_place

WALL = {"kind": "wall", "block": [0.5, 0.25], "courses": 4, "blocks_per_course": 3, "thickness": 0.4}


def said(**tables):
    """Problems and doubts of a case in 3D, each with its key."""
    case = spatial_case(**{"structure": [WALL], **tables})
    made = assembly(case)
    found = validate.problems(case, made.model, made.blocks) or sanity.problems(case, made.model)
    found = [*found, *sanity.doubts(case, made.model, made.blocks, made.loads)]
    return [f"{'.'.join(map(str, p.path))}: {p.message}" for p in found] + validate.warnings(made.model)


def test_a_sound_wall_raises_no_doubt():
    assert said() == []


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (
            {"block": "base", "force": [0.0, 1.0, 0.0]},
            "load.0.block: block 'base' is fixed: a load on it changes nothing",
        ),
        (
            {"block": "4-1", "force": [1.0, 0.0, 0.0], "at": [0.25, 0.5, 1.0]},
            "load.0.at: [0.25, 0.5, 1] is 0.3 m off block '4-1': an arm that turns it",
        ),
        (
            {"block": "4-1", "force": [1.0, 0.0, 0.0], "at": [-3.0, -4.2, 1.0]},
            "load.0.at: [-3, -4.2, 1] is 5 m off block '4-1'; "
            "the structure lies between [0.0, -0.2, -0.25] and [1.5, 0.2, 1.0]",
        ),
        ({"block": "4-1", "force": [1.0, 0.0, 0.0], "at": [0.0, 0.2, 1.0]}, None),
    ],
)  # fmt: skip
def test_loads_off_their_block(load, message):
    assert said(load=[load])[:1] == ([] if message is None else [message])


def test_joints_too_soft_to_stand_on():
    """Weight ρ g H over the whole bed: 2143 × 9.81 × 1.0 / 1e4 m."""
    (message,) = said(joints={"dry": {"friction": 0.6, "kn": 1e4}})
    sinks = 2143.0 * 9.81 * 1.0 / 1e4
    assert message.startswith(
        f"joints.dry.kn: 10000 Pa/m is too soft: blocks would sink {sinks:.3g} m into each other under their own weight"
    )


def test_lengths_in_millimetres():
    (message,) = said(structure=[WALL | {"block": [500.0, 250.0], "thickness": 400.0}])
    size = (500.0 * 250.0 * 400.0) ** (1 / 3)
    assert message == (
        f"structure.0: block 'wall-1-2': {size:.4g} m is unusual for the size of blocks, cube root of their volume, "
        f"did you mean {size / 1000:.4g} ({size:.4g} mm) or {size / 100:.4g} ({size:.4g} cm)?"
    )


def test_slivers_by_their_narrowest_side():
    plate = {"id": "plate", "polygon": [[0.0, 1.0], [1.5, 1.0], [1.5, 1.2], [0.0, 1.2]], "y": [0.0, 0.001]}
    (message,) = said(block=[plate])
    slim = 0.001 / (1.5**2 + 0.2**2 + 0.001**2) ** 0.5
    assert message == f"block 'plate' is a sliver (width / length = {slim:.1e}): expect tiny steps"


def test_what_two_parts_have_in_common():
    case = spatial_case(
        block=[
            {"id": "a", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]], "y": [0, 1]},
            {"id": "b", "polygon": [[0.75, 0.5], [2, 0.5], [2, 2], [0.75, 2]], "y": [-1, 0.5]},
        ]
    )
    assert common_place(assembly(case).model, [0, 1]) == ", 0.0625 m3 around [0.875, 0.25, 0.75]"
