"""Registry of the vault shapes and their generators."""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.vaults.barrel import build_barrel
from dem_cli.masonry.structures.vaults.cloister import build_cloister
from dem_cli.masonry.structures.vaults.dome import build_dome
from dem_cli.masonry.structures.vaults.groin import build_groin
from dem_cli.masonry.structures.vaults.table import Vault

SHAPES: dict[str, Callable[[Vault], list[Block]]] = {
    "barrel": build_barrel,
    "groin": build_groin,
    "cloister": build_cloister,
    "dome": build_dome,
}


def build(vault: Vault) -> list[Block]:
    """Generate the blocks of a vault in local places."""
    return SHAPES[vault.shape](vault)
