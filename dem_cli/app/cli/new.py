"""Print a commented case file to start from, one template per kind in cli/templates: `dem new`."""

from __future__ import annotations

from pathlib import Path

import click

TEMPLATES = Path(__file__).parent / "templates"
COMPANIONS = {"import": "blocks.obj"}  # a file that a template names, written beside it
TEMPLATE_KINDS = tuple(sorted(path.stem for path in TEMPLATES.glob("*.toml")))


@click.command("new", short_help="Print a commented case file to start from.")
@click.argument("kind", type=click.Choice(TEMPLATE_KINDS), metavar="KIND")
@click.option("-o", "--output", type=click.Path(), metavar="FILE", help="Write to a new file instead of printing.")
def command(kind: str, output: str | None) -> None:
    """Print a commented case file to start from.

    KIND: arch, arched-wall, block, bridge, column, facade or wall, to be pushed; out-of-plane, bonded-wall: walls
    in 3D of one leaf and of two; building: a house; import: blocks of another program; voronoi-wall, coursed-wall,
    herringbone-wall, wall-section: rubble, irregular courses, stones aslant, three leaves; drums, temple-front,
    vault: round columns, what they carry, groin vaults and domes; retaining: a wall under earth pressure;
    reinforced-wall: one with bars; colonnade or shaken (an arch): in an earthquake; safety: how far an arch is from
    failure; sweep: walls of several kinds, for `dem sweep`. Such as: dem new wall > wall.toml
    """
    text = (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
    if output is None:
        click.echo(text, nl=False)
        return
    from dem_cli.errors import OutputError, UsageError

    try:
        with Path(output).open("x", encoding="utf-8") as file:
            file.write(text)
        if kind in COMPANIONS:
            companion = Path(output).with_name(COMPANIONS[kind])
            if not companion.exists():
                companion.write_bytes((TEMPLATES / COMPANIONS[kind]).read_bytes())
    except FileExistsError:
        raise UsageError(f"{output}: exists already; nothing is overwritten") from None
    except OSError as error:
        raise OutputError(f"{output}: cannot be written ({error.strerror or error})") from None
