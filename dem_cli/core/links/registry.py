"""Registry of all kinds of links by their table, each loaded when it is used. A new kind is one file and one line
here.
"""

from __future__ import annotations

from dem_cli.core.links.link import Link
from dem_cli.declarations import Parameters
from dem_cli.registration import Registered

LINKS: Registered[Link] = Registered(
    {"tie": ("dem_cli.core.links.tie", "TIE"), "reinforcement": ("dem_cli.core.links.bar", "BAR")}
)
PROFILES: Registered[type[Parameters]] = Registered(  # tables by name that links name
    {"bars": ("dem_cli.core.links.drawn_bar", "BarProfile")}
)
