"""Where the parts meet: the registries are handed to the case, the case to the model."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from dem_cli.case.overrides import Override
from dem_cli.case.reader import LoadedCase, read_case
from dem_cli.case.schema import Case, case_model
from dem_cli.errors import CaseError

if TYPE_CHECKING:
    from dem_cli.assembly.assemble import Assembly
    from dem_cli.model.model import Model


@cache
def make_case_model() -> type[Case]:
    """The class of case files with every registered structure, law and analysis, and all other tables."""
    from dem_cli.analyses.registry import ANALYSES
    from dem_cli.calibrate.table import Calibration
    from dem_cli.laws.registry import LAWS
    from dem_cli.links.registry import LINKS, PROFILES
    from dem_cli.motion.table import MOTIONS
    from dem_cli.structures.registry import GENERATORS
    from dem_cli.tables.damping import DampingTable
    from dem_cli.tables.initial_state import InitialState

    return case_model(
        {kind: generator.parameters for kind, generator in GENERATORS.items()},
        {name: law.parameters for name, law in LAWS.items()},
        {kind: analysis.parameters for kind, analysis in ANALYSES.items()},
        Calibration,
        DampingTable,
        InitialState,
        MOTIONS,
        {key: link.parameters for key, link in LINKS.items()} | PROFILES,
    )


def load_case(path: str | Path, overrides: Sequence[str | Override] = (), text: str | None = None) -> LoadedCase:
    """Read and validate a case file (or the `text` that it held), with KEY=VALUE overrides.

    Raises CaseError or UsageError.
    """
    return read_case(path, make_case_model(), overrides, text)


def build_model(loaded: LoadedCase) -> Model:
    """Generate the blocks, check them, put them into arrays; what is odd about them joins `loaded.warnings`.

    Raises CaseError, with file and line, on bad geometry and unknown blocks.
    """
    return build_assembly(loaded).model


def build_assembly(loaded: LoadedCase) -> Assembly:
    """`build_model`, with the blocks and with the loads: where they act."""
    from dem_cli.assembly import sanity, validate
    from dem_cli.assembly.assemble import assembly

    found_odd: list[str] = []
    with loaded.located():
        made = assembly(loaded.case)
        if loaded.case.motion:
            from dem_cli.motion.ground_motions import check

            found_odd += map(loaded.render, check(loaded.case))
    found = validate.problems(loaded.case, made.model, made.blocks) or sanity.problems(loaded.case, made.model)
    if found:
        raise CaseError(found, loaded.render)
    doubts = (*made.doubts, *sanity.doubts(loaded.case, made.model, made.blocks, made.loads))
    found_odd += [*map(loaded.render, doubts), *validate.warnings(made.model)]
    loaded.warnings += [line for line in found_odd if line not in loaded.warnings]
    return made
