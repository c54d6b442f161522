"""All kinds of links by their table. A new kind is one file and one line here."""

from dem_cli.case.base import CaseModel
from dem_cli.links.bar import BAR, BarProfile
from dem_cli.links.link import Link
from dem_cli.links.tie import TIE

LINKS: dict[str, Link] = {link.key: link for link in (TIE, BAR)}
PROFILES: dict[str, type[CaseModel]] = {"bars": BarProfile}  # tables by name that links name
