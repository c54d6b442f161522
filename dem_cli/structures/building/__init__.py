"""Buildings: walls from their axes in plan, bonded where they meet, with openings, gables and floors."""

from dem_cli.structures.building.build import build
from dem_cli.structures.building.table import Building

__all__ = ["Building", "build"]
