"""Generate barrel vaults: an arch extended along a tunnel, its courses cut into staggered stones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures import arch
from dem_cli.masonry.structures.vaults.profile import arch_of, heads_along, side_of_crown
from dem_cli.masonry.structures.vaults.table import Vault


def build_barrel(vault: Vault) -> list[Block]:
    """Generate the blocks of a barrel vault: fixed ones, walls from below, voussoirs left to right, front to back."""
    length = vault.length or 0.0
    section = arch_of(vault, columns=vault.piers, base=vault.base, thickness=length)
    stone = length / vault.rows
    if vault.offset is not None and vault.offset >= stone:
        message = f"{vault.offset:g} is not allowed; must be less than a stone is long, {stone:g}"
        raise KeyProblem(message, "offset")
    shift = stone / 2.0 if vault.offset is None else vault.offset
    blocks, lift = list[Block](), section.piers.courses if section.piers else 0
    for block, course, odd in _courses(arch.build(section), section):
        places = heads_along(length, stone, shift if odd else 0.0)
        row = side_of_crown(course - lift, int(block.id), section.voussoirs) if block.id.isdigit() else ""
        laid = replace(block, course=course, row=row)
        blocks += cut_along(laid, places - length / 2.0) if course else [block]
    return blocks


def _courses(blocks: list[Block], section: arch.Arch) -> Iterator[tuple[Block, int, bool]]:
    """Yield the blocks of the section with their course from the foot (0: fixed), and whether it is staggered."""
    n, lift = section.voussoirs, section.piers.courses if section.piers else 0
    for block in blocks:
        name = block.id.split("-")
        if block.fixed:
            yield block, 0, False
        elif len(name) == 1:  # a voussoir
            k = int(name[0])
            yield block, lift + min(k, n + 1 - k), k % 2 == 0
        else:
            springing = 1 if name[0] == "left" else n
            yield block, block.course, (springing + 1 + lift - block.course) % 2 == 0


def cut_along(block: Block, places: np.ndarray) -> list[Block]:
    """Cut a block drawn in a plane into stones between places square to it [m], from the front."""
    pairs = zip(places[:-1].tolist(), places[1:].tolist(), strict=True)
    return [replace(block, id=f"{block.id}-{n}", across=pair) for n, pair in enumerate(pairs, 1)]
