"""Format the tables of `dem verify`: a row for each reference, by shelf, and failures in sentences."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import PurePosixPath

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from dem_cli.app.cli.words.numbers import seconds
from dem_cli.app.verify.case_selection import SHELVES
from dem_cli.app.verify.records import Record, on_shelves
from dem_cli.app.verify.verdict_words import VERDICTS, allowed, expected, found, judgement, off, share

UNCUT_WIDTH = 240  # where there is no terminal: lines are not cut
STYLES = {"passed": "green", "missed": "yellow", "failed": "bold red", "met": "bold red"}
STYLES |= {"predicted": "cyan", "outside": "yellow"}
NUMBER_COLUMNS = ("ours", "reference", "error", "%", "allowed", "time")


def show_tables(records: Sequence[Record]) -> None:
    """Print a table for each shelf, then a sentence for every reference that did not pass."""
    screen = Console(
        file=sys.stdout, width=None if sys.stdout.isatty() else UNCUT_WIDTH, highlight=False, soft_wrap=False
    )
    for shelf in SHELVES.values():
        of_shelf = on_shelves((r for r in records if "error" not in r), [shelf])
        if of_shelf:
            screen.print(_table(shelf, of_shelf))
    for record in records:
        if "error" in record:
            screen.print(f"{record['case']}: {record['error']}", style="bold red", markup=False, soft_wrap=True)
            continue
        for answer in record["references"]:
            if answer["state"] != "passed":
                line = f"{record['case']}: {judgement(answer)}"
                screen.print(line, style=STYLES[answer["state"]], markup=False, soft_wrap=True)


def _table(shelf: str, records: Sequence[Record]) -> Table:
    table = Table(title=shelf, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    for name in ("case", "quantity", "ours", "reference", "error", "%", "allowed", "verdict", "time"):
        table.add_column(name, justify="right" if name in NUMBER_COLUMNS else "left", overflow="fold")
    for record in records:
        path, took = PurePosixPath(record["case"]), seconds(record["seconds"])
        for answer in record["references"]:
            size = share(answer)
            percent = "" if size is None or off(answer) == "inside" else f"{100.0 * size:+.2f}".replace("-", "−")
            values = (found(answer), expected(answer), off(answer), percent, allowed(answer))
            verdict = f"[{STYLES[answer['state']]}]{VERDICTS[answer['state']]}[/]"
            table.add_row(f"{path.parent.name}/{path.stem}", answer["quantity"], *values, verdict, took)
            took = ""
    return table
