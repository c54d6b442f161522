"""Solve one run as a function for other processes: of a sweep, of `dem verify`."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dem_cli.errors import DemError, OutputError
from dem_cli.interrupts import insist

if TYPE_CHECKING:
    from dem_cli.app.sweep.run import Summary, SweepJob
    from dem_cli.case.overrides import Override


def solve_one(
    path: str | Path,
    overrides: Sequence[str | Override] = (),
    folder: str | Path | None = None,
    text: str | None = None,
) -> dict[str, Any]:
    """Solve a case with its overrides; a failed one returns status "failed", reason and exit_code.

    folder: where the results go; None keeps none. text: what the case file holds, if not read from `path`.
    Says nothing on the terminal.
    """
    try:
        return _solved(path, overrides, folder, text)
    except DemError as error:
        return {"status": "failed", "reason": str(error), "exit_code": error.exit_code}


def _solved(
    path: str | Path, overrides: Sequence[str | Override], folder: str | Path | None, text: str | None
) -> dict[str, Any]:
    from dem_cli.app import api
    from dem_cli.app.pipeline.batches import BatchOptions
    from dem_cli.app.pipeline.execution import Destination, run_case
    from dem_cli.results.output.resume.stages import DEFAULT_KEEPING

    started = time.perf_counter()
    loaded = api.load_case(path, overrides, text)
    kept = folder is not None  # by whoever keeps a folder for this run alone: what is broken in it is written anew
    with nullcontext(folder) if folder is not None else tempfile.TemporaryDirectory() as place:
        output = Path(place) if kept else Path(place) / "results"
        keeping = DEFAULT_KEEPING if kept else None
        options = BatchOptions(threads=1, resume=kept, keeping=keeping)  # what a killed one left is taken up
        return run_case(loaded, Destination(output, force=kept, recover=not kept), started, options=options)[0]


def do_job(job: SweepJob) -> Summary:
    """Do a run of a sweep in any process; a failure leaves its reason in the folder of the run.

    Raises OutputError: a full disk is no fault of the run, which is done when there is room again. Raises
    KeyboardInterrupt where it was stopped.
    """
    from dem_cli.app.sweep.run import failure

    try:
        summary = _solved(job.path, job.overrides, job.folder, job.text)
    except OutputError:
        raise
    except DemError as error:
        return failure(job, str(error))
    except Exception as error:  # a fault of the program in one run does not stop a thousand others
        import traceback

        insist()  # which may be what a library made of an interrupt
        return failure(job, f"internal error: {type(error).__name__}: {error}", traceback.format_exc())
    if summary["status"] == "interrupted":
        raise KeyboardInterrupt
    return summary
