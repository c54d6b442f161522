"""One run as a function that other processes can be asked for: of a sweep, of `dem verify`."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dem_cli.errors import DemError

if TYPE_CHECKING:
    from dem_cli.case.overrides import Override
    from dem_cli.sweep.run import Job, Summary


def solve_one(
    path: str | Path,
    overrides: Sequence[str | Override] = (),
    folder: str | Path | None = None,
    text: str | None = None,
) -> dict[str, Any]:
    """The summary of a case with its overrides; where it cannot be run, status "failed", reason and exit_code.

    folder: where the results go; None keeps none. text: what the case file holds, if not read from `path`.
    Says nothing on the terminal.
    """
    from dem_cli import api
    from dem_cli.cli.many import Wish
    from dem_cli.cli.run import execute

    started = time.perf_counter()
    try:
        loaded = api.load_case(path, overrides, text)
        model = api.build_model(loaded)
        with tempfile.TemporaryDirectory() if folder is None else nullcontext(folder) as place:
            output = Path(place) / "results" if folder is None else Path(place)
            wish = Wish(threads=1, resume=folder is not None)  # what a killed one of many runs left is taken up
            return execute(loaded, model, output, started, quiet=True, wish=wish, recover=folder is None)[0]
    except DemError as error:
        return {"status": "failed", "reason": str(error), "exit_code": error.exit_code}


def do_job(job: Job) -> Summary:
    """A run of a sweep, wherever it is done; what fails leaves its reason in the folder of the run."""
    from dem_cli.sweep.run import FAILED, failure

    try:
        summary = solve_one(job.path, job.overrides, job.folder, job.text)
    except Exception as error:  # a fault of the program in one run does not stop a thousand others
        import traceback

        return failure(job, f"internal error: {type(error).__name__}: {error}", traceback.format_exc())
    return failure(job, str(summary["reason"])) if summary["status"] == FAILED else summary
