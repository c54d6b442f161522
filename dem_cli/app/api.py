"""Load cases and build models: the registries of structures, laws and analyses are joined here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dem_cli.case.overrides import Override
from dem_cli.case.reader import LoadedCase, read_case
from dem_cli.case.schema import DEFAULT_ANALYSIS, DEFAULT_LAW, Case, case_model
from dem_cli.errors import CaseError

if TYPE_CHECKING:
    from dem_cli.core.model.model import Model
    from dem_cli.masonry.assembly.assemble import Assembly


@cache
def make_case_model() -> type[Case]:
    """Create the class of case files with every registered structure, law and analysis, and all other tables."""
    from dem_cli.analyses.registry import ANALYSES
    from dem_cli.core.laws.registry import LAWS
    from dem_cli.masonry.structures.registry import GENERATORS

    return _case_model(tuple(GENERATORS), tuple(LAWS), tuple(ANALYSES), frozenset(Case.model_fields))


def case_model_of(tables: dict[str, Any] | None) -> type[Case]:
    """Create the class of case files for these tables with the kinds and keys that they name, which is much faster.

    The whole one for None, for kinds that do not exist, and where it is there or many others were made.
    """
    if tables is None or make_case_model.cache_info().currsize:
        return make_case_model()
    named = _named(tables)
    if named is None or _case_model.cache_info().currsize >= MOST_SMALL_MODELS:
        return make_case_model()
    return _case_model(*named)


def _named(tables: dict[str, Any]) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...], frozenset[str]] | None:
    """Return the kinds of structures, laws and analysis, and keys, that a case names; None for an unknown name."""
    from dem_cli.analyses.registry import ANALYSES
    from dem_cli.core.laws.registry import LAWS
    from dem_cli.masonry.structures.registry import GENERATORS

    try:
        structures = {table["kind"] for table in tables.get("structure", ())}
        laws = {table.get("law", DEFAULT_LAW) for table in tables["joints"].values()}
        analysis = tables.get("analysis", {}).get("kind", DEFAULT_ANALYSIS)
        known = structures <= set(GENERATORS) and laws <= set(LAWS) and analysis in ANALYSES
    except (AttributeError, KeyError, TypeError):  # not the tables that they should be
        return None
    if not (known and laws and set(tables) <= set(Case.model_fields)):
        return None
    return tuple(sorted(structures)), tuple(sorted(laws)), (analysis,), frozenset(tables)


@cache
def _case_model(
    structures: tuple[str, ...], laws: tuple[str, ...], analyses: tuple[str, ...], keys: frozenset[str]
) -> type[Case]:
    """Create the class of case files with these kinds and keys."""
    from dem_cli.analyses.registry import ANALYSES
    from dem_cli.case.tables.declared import table_of
    from dem_cli.core.laws.registry import LAWS
    from dem_cli.core.links.registry import LINKS, PROFILES
    from dem_cli.masonry.structures.registry import GENERATORS

    return case_model(
        {kind: GENERATORS[kind].parameters for kind in structures},
        {name: table_of(LAWS[name].parameters) for name in laws},
        {kind: ANALYSES[kind].parameters for kind in analyses},
        {key: load() for key, load in TABLES.items() if key in keys},
        _motions() if "motion" in keys else None,
        {key: table_of(LINKS[key].parameters) for key in LINKS if key in keys}
        | {key: table_of(PROFILES[key]) for key in PROFILES if key in keys},
        left_out=Case.model_fields.keys() - keys - {"analysis"},
    )


def _calibration() -> Any:
    from dem_cli.app.calibrate.table import Calibration

    return Calibration


def _damping() -> Any:
    from dem_cli.case.tables.damping import DampingTable

    return DampingTable


def _initial() -> Any:
    from dem_cli.case.tables.initial_state import InitialState

    return InitialState


def _motions() -> Any:
    from dem_cli.case.tables.base_motion import MOTIONS

    return MOTIONS


MOST_SMALL_MODELS = 5  # to make as many takes as long as the whole one
TABLES: dict[str, Callable[[], Any]] = {"calibration": _calibration, "damping": _damping, "initial": _initial}


def load_case(path: str | Path, overrides: Sequence[str | Override] = (), text: str | None = None) -> LoadedCase:
    """Read and validate a case file (or its given `text`), with KEY=VALUE overrides.

    Raises CaseError or UsageError.
    """
    return read_case(path, case_model_of, overrides, text)


def build_model(loaded: LoadedCase) -> Model:
    """Generate the blocks, check them and assemble the model; warnings about them join `loaded.warnings`.

    Raises CaseError, with file and line, on bad geometry and unknown blocks.
    """
    return build_assembly(loaded).model


def build_assembly(loaded: LoadedCase) -> Assembly:
    """Assemble the model with its blocks and the points of its loads."""
    made = laid(loaded)
    examine(loaded, made)
    return made


def laid(loaded: LoadedCase) -> Assembly:
    """Generate the blocks of a case with their loads, not yet examined. Raises CaseError."""
    from dem_cli.masonry.assembly.assemble import assembly

    with loaded.located():
        return assembly(loaded.case)


def examine(loaded: LoadedCase, made: Assembly) -> None:
    """Check the blocks and ground motions of a case; warnings join `loaded.warnings`.

    Raises CaseError, with file and line.
    """
    from dem_cli.masonry.assembly import sanity, validate

    found_odd: list[str] = []
    if loaded.case.motion:
        from dem_cli.masonry.assembly.ground_motions import check

        with loaded.located():
            found_odd += map(loaded.render, check(loaded.case))
    found = validate.problems(loaded.case, made.model, made.blocks) or sanity.problems(loaded.case, made.model)
    if found:
        raise CaseError(found, loaded.render)
    doubts = (*made.doubts, *sanity.doubts(loaded.case, made.model, made.blocks, made.loads))
    found_odd += [*map(loaded.render, doubts), *validate.warnings(made.model)]
    loaded.warnings += [line for line in found_odd if line not in loaded.warnings]
