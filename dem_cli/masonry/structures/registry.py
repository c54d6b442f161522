"""Registry of the generators of [[structure]] by `kind`, each loaded on use. A new one: a file and a line here."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any, NamedTuple

from dem_cli.case.base import StructureBase
from dem_cli.core.model.blocks import Block


class Generator(NamedTuple):
    """Generator of one kind of structure: a module with its table, `build` and optional functions."""

    kind: str  # as in the case file
    table: str  # the class of its parameters
    place: str  # the module

    @property
    def module(self) -> ModuleType:
        """Module of the generator, imported on first use."""
        return import_module(self.place)

    @property
    def parameters(self) -> type[StructureBase]:
        """Class of the table: keys, units, ranges; its docstring states the local origin."""
        found: type[StructureBase] = getattr(self.module, self.table)
        return found

    def build(self, table: Any) -> list[Block]:
        """Generate the blocks with local places and ids; ValueError if impossible."""
        found: list[Block] = self.module.build(table)
        return found

    def said(self, what: str, table: Any, otherwise: Any) -> Any:
        """Call an optional function of the generator's module on a table; `otherwise` where it has none of that
        name.
        """
        function: Callable[[Any], Any] | None = getattr(self.module, what, None)
        return otherwise if function is None else function(table)


GENERATORS: dict[str, Generator] = {
    generator.kind: generator
    for generator in (
        Generator("wall", "Wall", "dem_cli.masonry.structures.wall_blocks"),
        Generator("column", "Column", "dem_cli.masonry.structures.columns.column"),
        Generator("arch", "Arch", "dem_cli.masonry.structures.arch"),
        Generator("bridge", "Bridge", "dem_cli.masonry.structures.bridge"),
        Generator("drums", "DrumColumn", "dem_cli.masonry.structures.columns.drums"),
        Generator("temple-front", "TempleFront", "dem_cli.masonry.structures.columns.temple_front"),
        Generator("vault", "Vault", "dem_cli.masonry.structures.vaults.shapes"),
        Generator("voronoi-wall", "VoronoiWall", "dem_cli.masonry.structures.patterns.voronoi_wall"),
        Generator("coursed-wall", "CoursedWall", "dem_cli.masonry.structures.patterns.coursed_wall"),
        Generator("herringbone-wall", "HerringboneWall", "dem_cli.masonry.structures.patterns.herringbone_wall"),
        Generator("wall-section", "WallSection", "dem_cli.masonry.structures.patterns.wall_section"),
        Generator("building", "Building", "dem_cli.masonry.structures.building.build"),
        Generator("import", "Import", "dem_cli.masonry.structures.imported"),
    )
}


def generated_blocks(table: Any, seed: int) -> list[Block]:
    """Generate the blocks of a structure in local places; seed: of the case."""
    return GENERATORS[table.kind].build(table.drawn_from(seed))


def generated_figures(table: Any, seed: int) -> list[tuple[str, str]]:
    """Describe the random parameters of a structure: label and text of each line; seed: of the case."""
    found: list[tuple[str, str]] = GENERATORS[table.kind].said("figures", table.drawn_from(seed), [])
    return found


def loose_ends(table: Any) -> str:
    """Return the key by which stones of a structure may slide out at its free ends; "": none does."""
    return str(GENERATORS[table.kind].said("loose_ends", table, ""))


def unsaid(table: Any) -> list[tuple[str, str]]:
    """List the keys that a structure leaves out although they matter, and the values assumed."""
    found: list[tuple[str, str]] = GENERATORS[table.kind].said("unsaid", table, [])
    return found
