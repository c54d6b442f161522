"""All kinds of links by their table. A new kind is one file and one line here."""

from dem_cli.links.link import Link
from dem_cli.links.tie import TIE

LINKS: dict[str, Link] = {link.key: link for link in (TIE,)}
