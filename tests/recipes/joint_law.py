"""A joint law by the recipe: shear up to a stress that does not depend on the pressure."""

from __future__ import annotations

from recipes import Recipe

LAW = '''"""Joint whose shear strength is one stress, whatever presses it (Tresca).

    N = kn ⟨−gap⟩,   s = s_old − ks Δu,   |s| ≤ τ A

The shear spring is incremental; a joint that is open carries nothing.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from dem_cli.declarations import Positive, parameter
from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.envelope import Envelope, envelope
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.stiffness import StiffJoint


class TrescaJoint(StiffJoint):
    """[joints.*] with law = "tresca"."""

    law: Literal["tresca"] = "tresca"
    shear_strength: Positive = parameter(description="shear strength τ [Pa]", examples=[5e4])


@inline
def tresca(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Contact point with a limit of its shear force that does not depend on the normal one."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    trial = axpy(-ks, slide, shear)
    size, limit = norm(trial), parameters[joint, 1] * kn / parameters[joint, 0]
    if size <= limit:
        return -kn * gap, trial, False
    return -kn * gap, scale(limit / size, trial), True


def strength(parameters, kn) -> Envelope:
    """τ A [N], and neither friction nor tension."""
    return envelope(len(kn), cohesion=parameters[:, 1] * kn / parameters[:, 0])


TRESCA = Law(
    name="tresca",
    parameters=TrescaJoint,
    function=tresca,
    columns=lambda table, kn: (kn, table.shear_strength),
    shear_limit=lambda parameters, normal, memory, kn: np.where(
        normal > 0.0, parameters[:, 1] * kn / parameters[:, 0], 0.0
    ),
    envelope=strength,
    source="a strength that does not depend on the pressure, as metals have it (Tresca 1864)",
)
'''

TEST = '''"""Shear up to τ A, whatever presses."""

from __future__ import annotations

import numpy as np
from lawpaths import joint, ramp

from dem_cli.core.laws.displacement_path import drive

AREA, STRENGTH = 0.02, 5e4
TRESCA = joint("tresca", shear_strength=STRENGTH)


def test_slides_at_one_force_under_any_pressure():
    for closed in (1e-6, 1e-3):
        path = ramp((-closed, 0.0), (-closed, 1e-3))
        done = drive(TRESCA.law, TRESCA.table, path, kn=1e10, ks=5e9, area=AREA)
        np.testing.assert_allclose(np.abs(done.shear[-1]), STRENGTH * AREA, rtol=1e-12)
        np.testing.assert_allclose(done.normal[-1], 1e10 * AREA * closed, rtol=1e-12)
'''

PANELS = """def tresca(page: LawPage) -> list[Panel]:
    return [three_paths(page, 1e5, 80e-6, "Slid under 100 kPa")]


PAGES = (
"""

RECIPE = Recipe(
    section="Add a joint law",
    name="tresca",
    files={
        "dem_cli/core/laws/tresca.py": LAW,
        "tests/laws/test_tresca.py": TEST,
        "scripts/studies/laws/notes/tresca.md.j2": "τ = 50 kPa.\n\n## Notes\n\n* It has no friction.\n",
    },
    lines=(
        (
            "dem_cli/core/laws/registry.py",
            "    {\n",
            '    {\n        "tresca": ("dem_cli.core.laws.tresca", "TRESCA"),\n',
        ),
        (
            "tests/laws/test_loop.py",
            "JOINTS = {\n", 'JOINTS = {\n    "tresca": joint("tresca", shear_strength=16.0),\n'
        ),
        (
            "scripts/studies/laws/diagrams.py",
            "PAGES = (\n", PANELS + '    LawPage(LAWS["tresca"], {"shear_strength": 5e4}, 1e10, 4e9, tresca),\n'
        ),
        ("tests/laws/test_strength.py", '{"barton", "elastic"}', '{"barton", "elastic", "tresca"}'),
        (
            "docs/guide/joints.md",
            "| not to fail at all |",
            "| held by one shear stress | [`tresca`](../laws/tresca.md) | shear strength |\n| not to fail at all |",
        ),
        ("docs/glossary.md", "`elastic`. One file each.", "`elastic`, `tresca`. One file each."),
    ),
    commands=(("scripts/study", "laws", "tresca", "--write"), ("scripts/draw_tree",), ("scripts/docs", "--write")),
    tests=(
        "tests/house/test_kernels_ast.py::test_compiled_functions_hold_numbers_alone[core/laws/tresca.py]",
        "tests/house/test_imports.py::test_only_the_arrows_of_the_house[core.laws.tresca]",
        "tests/laws/test_tresca.py", "tests/laws/test_strength.py", "tests/laws/test_pages.py",
        "tests/laws/test_loop.py::test_every_law_is_here", "tests/laws/test_loop.py::test_planar_twin[tresca]",
        "tests/laws/test_loop.py::test_work_is_elastic_energy_and_what_is_lost[tresca-2]",
        "tests/laws/test_loop.py::test_shear_stays_below_the_limit_that_is_reported[tresca]",
    ),
)  # fmt: skip
