"""Print the JSON Schema of the case file, for editors that complete and check keys: `dem schema`."""

from __future__ import annotations

import json

import click


@click.command("schema", short_help="Print the JSON Schema of the case file.")
def command() -> None:
    """Print the JSON Schema of the case file.

    Editors with a TOML language server complete and check keys when the first line of a case is
    `#:schema ./dem.schema.json` and `dem schema > dem.schema.json` has been run beside it.
    """
    from dem_cli.app.api import make_case_model
    from dem_cli.case.keys import json_schema

    click.echo(json.dumps(json_schema(make_case_model()), indent=2, ensure_ascii=False))
