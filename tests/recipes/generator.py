"""A generator by the recipe: a pier whose courses step back."""

from __future__ import annotations

from recipes import Recipe

GENERATOR = '''"""Stepped piers: one block per course, each narrower than the one below."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, Positive, StructureBase
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.bases import base_block


class SteppedPier(StructureBase):
    """Blocks on top of each other, each stepping back. Local origin: on the axis of the pier, at its foot.

    Block names: "<id>-<number>" from below, from 1; "<id>-base".
    """

    kind: Literal["stepped-pier"] = "stepped-pier"
    block: tuple[Positive, Positive] = Field(
        description="width of the lowest block and height of a block [m]", examples=[[1.0, 0.4]]
    )
    courses: int = Field(ge=1, le=1000, description="number of blocks", examples=[4])
    step: Positive = Field(description="by how much each block is narrower than the one below [m]", examples=[0.1])
    thickness: Positive = Field(1.0, description="depth out of plane [m]")

    @model_validator(mode="after")
    def _something_is_left(self) -> SteppedPier:
        if self.block[0] <= self.step * (self.courses - 1):
            raise KeyProblem("nothing is left of the block at the top; take less", "step")
        return self


def build(pier: SteppedPier) -> list[Block]:
    """Blocks in local coordinates from below, the base first."""
    width, height = pier.block
    base = rectangle(-width / 2.0, -height, width, height)
    blocks = [base_block("base", base, pier.thickness, 0.0)]
    for k in range(pier.courses):
        wide = width - k * pier.step
        shape = rectangle(-wide / 2.0, k * height, wide, height)
        blocks.append(Block(f"{k + 1}", (shape,), "", pier.thickness, course=k + 1))
    return blocks
'''

TEMPLATE = """# A pier whose courses step back, pushed sideways by a share of its own weight until it fails.
# SI units (m, kg, s, N, Pa); angles in degrees where a key ends in _deg.
# Check it with `dem check FILE`, solve it with `dem run FILE`.

title = "A stepped pier"

[materials.stone]
density = 2400.0                # kg/m3

[joints.dry]
friction = 0.7                  # tan(phi)

[[structure]]
kind = "stepped-pier"
block = [1.0, 0.4]              # width of the lowest block and height of a block, m
courses = 4
step = 0.1                      # by how much each block is narrower than the one below, m

[analysis]
kind = "pushover"
"""

TEST = '''"""Stepped piers: names and sizes of the blocks, and what is refused."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from dem_cli.masonry.structures import stepped_pier

KEYS = {"block": (1.0, 0.4), "courses": 3, "step": 0.2}


def test_blocks_step_back():
    blocks = stepped_pier.build(stepped_pier.SteppedPier(**KEYS))
    assert [block.id for block in blocks] == ["base", "1", "2", "3"]
    widths = [float(block.parts[0][:, 0].max() - block.parts[0][:, 0].min()) for block in blocks[1:]]
    assert widths == pytest.approx([1.0, 0.8, 0.6])


def test_nothing_left_is_refused():
    with pytest.raises(ValidationError, match="nothing is left"):
        stepped_pier.SteppedPier(**KEYS | {"step": 0.5})
'''

KIND = 'Generator("stepped-pier", "SteppedPier", "dem_cli.masonry.structures.stepped_pier"),'

RECIPE = Recipe(
    section="Add a generator",
    name="stepped-pier",
    files={
        "dem_cli/masonry/structures/stepped_pier.py": GENERATOR,
        "dem_cli/app/cli/templates/stepped-pier.toml": TEMPLATE,
        "tests/unit/structures/test_stepped_pier.py": TEST,
    },
    lines=(
        (
            "dem_cli/masonry/structures/registry.py",
            "    for generator in (\n",
            f"    for generator in (\n        {KIND}\n",
        ),
        ("dem_cli/app/cli/new.py", "KIND: arch, arched-wall,", "KIND: arch, arched-wall, stepped-pier,"),
        ("docs/guide/install.md", "`wall-section`", "`stepped-pier`, `wall-section`"),
        (
            "dem_cli/masonry/assembly/imperfect.py",
            'LEVEL = ("wall", "column")',
            'LEVEL = ("wall", "column", "stepped-pier")',
        ),
        ("docs/glossary.md", "`arch`, `bridge`, `drums`", "`arch`, `stepped-pier`, `bridge`, `drums`"),
    ),
    commands=(("scripts/draw_tree",), ("scripts/docs", "--write")),
    tests=(
        "tests/house/test_imports.py::test_only_the_arrows_of_the_house[masonry.structures.stepped_pier]",
        "tests/unit/structures/test_stepped_pier.py", "tests/cli/test_guide.py::test_all_templates_are_named",
        "tests/cli/test_commands.py::test_there_is_a_template_for_every_generator",
        "tests/cli/test_commands.py::test_what_new_prints_passes_check_as_it_is[stepped-pier]",
        "tests/cli/test_commands.py::test_what_new_prints_explains_every_key[stepped-pier]",
    ),
)  # fmt: skip
