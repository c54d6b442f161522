"""The generators of [[structure]] by `kind`. A new one: a file with parameters and `build`, a line here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from dem_cli.case.base import StructureBase
from dem_cli.model.blocks import Block
from dem_cli.structures import arch, bridge, column, drums, imported, temple_front, wall, wall_blocks
from dem_cli.structures.building import build as building
from dem_cli.structures.building.table import Building
from dem_cli.structures.patterns import coursed_wall, herringbone_wall, voronoi_wall, wall_section
from dem_cli.structures.vaults import shapes as vaults
from dem_cli.structures.vaults.table import Vault


class Generator(NamedTuple):
    """Generator of one kind of structure."""

    kind: str  # as in the case file
    parameters: type[StructureBase]  # keys, units, ranges; its docstring says where its origin lies
    build: Callable[[Any], list[Block]]  # -> blocks with local places and ids; ValueError if impossible
    figures: Callable[[Any], list[tuple[str, str]]] = lambda table: []  # what was drawn at random, for `dem check`
    loose_ends: Callable[[Any], str] = lambda table: ""  # key path that lets stones slide out; "": none does
    unsaid: Callable[[Any], list[tuple[str, str]]] = lambda table: []  # keys not given that matter, what was taken


GENERATORS: dict[str, Generator] = {
    generator.kind: generator
    for generator in (
        Generator("wall", wall.Wall, wall_blocks.build),
        Generator("column", column.Column, column.build),
        Generator("arch", arch.Arch, arch.build),
        Generator("bridge", bridge.Bridge, bridge.build),
        Generator("drums", drums.DrumColumn, drums.build),
        Generator("temple-front", temple_front.TempleFront, temple_front.build),
        Generator("vault", Vault, vaults.build),
        Generator(
            "voronoi-wall", voronoi_wall.VoronoiWall, voronoi_wall.build, voronoi_wall.figures, voronoi_wall.loose_ends
        ),
        Generator("coursed-wall", coursed_wall.CoursedWall, coursed_wall.build, coursed_wall.figures),
        Generator(
            "herringbone-wall",
            herringbone_wall.HerringboneWall,
            herringbone_wall.build,
            loose_ends=herringbone_wall.loose_ends,
        ),
        Generator("wall-section", wall_section.WallSection, wall_section.build, wall_section.figures),
        Generator("building", Building, building.build, building.figures, building.loose_ends),
        Generator("import", imported.Import, imported.build, unsaid=imported.unsaid),
    )
}


def generated_blocks(table: Any, seed: int) -> list[Block]:
    """Blocks of a structure, in local places; seed: of the case. Raises ValueError where it is impossible."""
    return GENERATORS[table.kind].build(table.drawn_from(seed))


def generated_figures(table: Any, seed: int) -> list[tuple[str, str]]:
    """What a structure drew at random: label and text of each line; seed: of the case."""
    return GENERATORS[table.kind].figures(table.drawn_from(seed))


def loose_ends(table: Any) -> str:
    """The key by which stones of a structure may slide out at its free ends; "": none does."""
    return GENERATORS[table.kind].loose_ends(table)


def unsaid(table: Any) -> list[tuple[str, str]]:
    """Keys that a structure does not give although they matter here, and what was taken instead."""
    return GENERATORS[table.kind].unsaid(table)
