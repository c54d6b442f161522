"""Python interface: run a case, load a case, open results. `dem run` goes the same way."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dem_cli.app import api
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.execution import Destination, one_of_many, run_case
from dem_cli.app.pipeline.listener import RunListener
from dem_cli.app.public.result import Result
from dem_cli.case.overrides import override_of
from dem_cli.case.reader import LoadedCase
from dem_cli.case.wording import show
from dem_cli.case.writer import text_of_tables
from dem_cli.errors import UsageError
from dem_cli.interrupts import Interrupts
from dem_cli.results.output.resume.stages import DEFAULT_KEEPING

CaseSource = str | os.PathLike[str] | LoadedCase | Mapping[str, Any]
ProgressFunction = Callable[[str, float, float, float | None], None]
SOURCES = "the path of a case file, a case that was loaded, or a dict of its tables"
NO_FILE = Path("case")  # what messages call a case that is given as tables; its records are sought from here


def load(case: CaseSource, set: Mapping[str, Any] | None = None) -> LoadedCase:
    """Read and validate a case: the path of a case file, a loaded case, or a dict of its tables.

    set: values by key path, as `dem run --set` takes them: {"joints.dry.friction": 0.5, "structure.0.courses": 8}.
    The answer has `case` (all tables, defaults filled in), `text`, `path` and `warnings`, a line for each doubt.

    Raises CaseError, with every mistake and its line, and UsageError where there is no such file or key path.
    """
    if not isinstance(set, Mapping | None):
        raise UsageError(f"set: {set!r} is not allowed; must be a dict, such as {{'joints.dry.friction': 0.5}}")
    changes = [override_of(key, value) for key, value in (set or {}).items()]
    if isinstance(case, LoadedCase):
        return api.load_case(case.path, [*case.overrides, *changes], case.text)
    if isinstance(case, Mapping):
        if not case:
            raise UsageError("case: a dict without tables; `dem new wall` prints a case to start from")
        return api.load_case(NO_FILE, changes, text_of_tables(case))
    if not isinstance(case, str | os.PathLike):
        raise UsageError(f"case: {show(case)} is not allowed; must be {SOURCES}")
    if "\n" in str(case):
        raise UsageError(f"case: a text of several lines is not allowed; must be {SOURCES}, as of tomllib.loads")
    return api.load_case(Path(case), changes)


def run(
    case: CaseSource,
    set: Mapping[str, Any] | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: ProgressFunction | None = None,
) -> Result:
    """Solve a case, as `dem run` does, and return its results.

    case, set   as `load`
    out         folder of the results, which appear in it whole or not at all; None: they are gone with the Result
    threads     runs side by side, of analyses that consist of many, None: all cores; else threads that step a large
                structure together, None: one
    resume      go on where an interrupted or killed run of the same case stopped in `out`
    force       write among files that dem did not write; those stay
    progress    called now and then with stage, load multiplier, control displacement [m], share of the stage or None

    Raises CaseError (the case is wrong: all mistakes at once), UsageError (arguments, a missing file, a folder that is
    not ours), OutputError (full disk, no permission). A solver that gives up raises nothing: `Result.status` is then
    "not converged". Ctrl-C raises KeyboardInterrupt; what there is by then is kept in `out`.
    """
    started = time.perf_counter()
    options = BatchOptions(threads, resume, None if out is None else DEFAULT_KEEPING)
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise UsageError(f"threads: {threads!r} is not allowed; must be an integer ≥ 1, or None")
    if resume and out is None:
        raise UsageError("resume: needs the folder `out` of the run that was interrupted")
    loaded = load(case, set)
    one_of_many(loaded)
    place = Path(tempfile.mkdtemp(prefix="dem-")) if out is None else None
    output = place / "results" if place is not None else Path(out or "")
    try:
        summary, folder = run_case(
            loaded,
            Destination(output, force=force, recover=place is None),
            started,
            options=options,
            listener=ProgressListener(progress),
            interrupts=Interrupts(("SIGINT",), ends_program=False),
        )
        if summary["status"] == "interrupted":
            raise KeyboardInterrupt
        return Result(folder, temporary=place)
    except BaseException:
        if place is not None:
            shutil.rmtree(place, ignore_errors=True)
        raise


def open(folder: str | os.PathLike[str]) -> Result:
    """Open the results that `dem run`, or `run` with `out`, left in a folder.

    Raises UsageError where there are none. A killed run is read up to its last frame; its summary is empty.
    """
    return Result(Path(folder))


class ProgressListener(RunListener):
    """Listener that forwards progress to a function."""

    def __init__(self, function: ProgressFunction | None):
        self.function = function

    def progress(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Call the function."""
        if self.function is not None:
            self.function(stage, load, displacement, fraction)
