"""One run as a function that other processes can be asked for: of a sweep, of `dem verify`."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from dem_cli.errors import DemError


def solve_one(path: str | Path, overrides: Sequence[str] = (), folder: str | Path | None = None) -> dict[str, Any]:
    """The summary of a case with its overrides; where it cannot be run, {"status": "failed", "reason": why}.

    folder: where the results go; None keeps none. Says nothing on the terminal.
    """
    from dem_cli import api
    from dem_cli.cli.run import execute

    started = time.perf_counter()
    try:
        loaded = api.load_case(path, overrides)
        model = api.build_model(loaded)
        with tempfile.TemporaryDirectory() if folder is None else nullcontext(folder) as place:
            output = Path(place) / "results" if folder is None else Path(place)
            return execute(loaded, model, output, started, quiet=True)[0]
    except DemError as error:
        return {"status": "failed", "reason": str(error)}
