"""`dem run` with a made-up solver; `python runs.py CASE OUTPUT MODE` is such a command, to be killed."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

from dem_cli.case.base import CaseModel
from dem_cli.case.reader import LoadedCase, read_case
from dem_cli.case.schema import case_model
from dem_cli.errors import SolverError
from synthetic import history_rows, wall_frames, wall_model, wall_summary

CASE = """\
title = "21-block opus quadratum wall"
[materials.peperino]
density = 2143.0
[joints.dry]
friction = 0.6
[[block]]
id = "base"
vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [0.0, 0.1]]
material = "peperino"
fixed = true
[[monitor]]
block = "base"
[reference]
failure_load = 0.64
tolerance = 0.001
"""


class Pushover(CaseModel):
    kind: Literal["pushover"] = "pushover"


class Joint(CaseModel):
    law: Literal["coulomb"] = "coulomb"
    friction: float


class Wall(CaseModel):
    kind: Literal["wall"] = "wall"


def load(path: Path, text: str = CASE) -> LoadedCase:
    """A case with one monitor and a reference, written to `path` first."""
    path.write_text(text, encoding="utf-8")
    model = case_model({"wall": Wall}, {"coulomb": Joint}, {"pushover": Pushover})
    return read_case(path, lambda tables: model)


def solver(n_frames: int = 6, pause: float = 0.0, fail_at: int = -1, copies: int = 1):
    """Reports made-up frames; gives up at frame `fail_at`; repeats each frame `copies` times."""

    def solve(case, model, observer):
        frames = wall_frames(model, n_frames)
        rows = history_rows(frames)
        for i, frame in enumerate(frames):
            if i == fail_at:
                raise SolverError("step 300: no equilibrium within 1,000 steps at load 0.4")
            for row in rows[10 * i : 10 * i + 10]:
                observer.row(row)
            for _ in range(copies):
                observer.frame(frame)
            observer.progress(frame.stage, frame.load, frame.displacement, i / n_frames)
            print("frame", i, flush=True)
            time.sleep(pause)
        return SimpleNamespace(summary={**wall_summary(), "skipped": ["large displacements: not needed"]})

    return solve


def main() -> None:
    """Modes: quick, slow (one frame every 50 ms), huge (2,000 frames)."""
    from dem_cli.app.cli.run import execute
    from dem_cli.errors import DemError
    from dem_cli.results.output import store  # noqa: F401  another user may not see the packages any more

    loaded, output, mode = load(Path(sys.argv[1])), Path(sys.argv[2]), sys.argv[3]
    if os.environ.get("AS_USER"):
        os.setgid(int(os.environ["AS_USER"]))
        os.setuid(int(os.environ["AS_USER"]))
    chosen = {"quick": {}, "slow": {"n_frames": 200, "pause": 0.05}, "huge": {"n_frames": 50, "copies": 40}}
    try:
        summary, _ = execute(loaded, wall_model(), output, time.perf_counter(), solve=solver(**chosen[mode]))
        code = {"ok": 0, "interrupted": 130}[summary["status"]]
    except DemError as error:
        print(f"error: {error}", file=sys.stderr)
        code = error.exit_code
    except KeyboardInterrupt:
        code = 130
    sys.exit(code)


if __name__ == "__main__":
    main()
