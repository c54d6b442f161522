"""`scripts/fuzz --checks A:B --runs A:B`: does `dem` live with the cases of these seeds? Exit code 1 where it does not.

`dem check` reads drawn cases and cases of the project, most of them damaged; `dem run` solves drawn ones as they are. A
find is one line on the terminal and a case in the folder of finds:

* an internal error, any exception, a warning of Python, a process that dies;
* a refusal that is no message, or a code that `docs/commands.md` does not know;
* a number that is none (nan, inf) in what is printed, in the summary or in results.h5;
* a failure load above the bound printed with it, without a word;
* a check that takes more CPU seconds than the limit. Runs that do are counted apart: they did not come to their end.

Cases go through one process after the other, a few hundred each; what is compiled is not counted as their time.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import tomllib
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from types import FrameType
from typing import Any

import tomli_w

from fuzzing.cases import case
from fuzzing.damage import damaged, places

ROOT = Path(__file__).resolve().parents[2]
CASES = ("dem_cli/app/cli/templates/*.toml", "cases/verification/**/*.toml", "cases/validation/*.toml")
LIMIT = 20.0  # CPU s of a case
BATCH = 300  # cases of one process
WIDEST = 1.051  # of a bound, what a load may be above it: the widest bracket that is drawn, 5 %
MEMORY = 8 << 30  # bytes that a process may ask for
NO_NUMBER = re.compile(r"(?<![\w.\"'-])[-+]?(nan|inf)(?![\w\"'-])")
PASSED_OVER = (ResourceWarning, DeprecationWarning, PendingDeprecationWarning)  # what libraries say of each other
ENDED = {"checks": {0: "read", 2: "refused"}, "runs": {0: "solved", 1: "solved", 2: "refused", 3: "gave up"}}


class OutOfTime(BaseException):
    """A case has had its CPU seconds."""


class Stopwatch:
    """Raises OutOfTime after `limit` CPU seconds outside of the compiler; looks once a second, or more often."""

    def __init__(self, limit: float) -> None:
        self.limit, self.used, self.last = limit, 0.0, 0.0

    def __enter__(self) -> Stopwatch:
        self.last = time.process_time()
        self.handler = signal.signal(signal.SIGPROF, self.look)
        often = min(1.0, self.limit)
        signal.setitimer(signal.ITIMER_PROF, often, often)
        return self

    def __exit__(self, *_: object) -> None:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, self.handler)
        self.used += time.process_time() - self.last

    def look(self, _: int, frame: FrameType | None) -> None:
        """Counts the time since the last look, unless something is being compiled."""
        now, compiling = time.process_time(), False
        while frame is not None and not compiling:
            compiling = frame.f_globals.get("__name__", "").startswith(("numba.", "llvmlite."))
            frame = frame.f_back
        self.used += 0.0 if compiling else now - self.last
        self.last = now
        if self.used > self.limit:
            raise OutOfTime


def project_cases() -> list[dict[str, Any]]:
    """Cases of the project as plain data; files that they name by their whole path."""
    found = []
    for path in sorted(path for pattern in CASES for path in ROOT.glob(pattern)):
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        for holder, key in places(tables):
            value = holder[key]
            if isinstance(value, str) and key == "file" and (path.parent / value).is_file():
                holder[key] = str(path.parent / value)
        found.append(tables)
    return found


def text_of(kind: str, seed: int, pool: Sequence[dict[str, Any]]) -> str:
    """The case file of a seed: for checks damaged more often than not."""
    if kind == "runs":
        return tomli_w.dumps(case(f"run {seed}"))
    rng = random.Random(f"damage {seed}")
    drawn = case(f"check {seed}")
    tables, other = rng.choice([(drawn, rng.choice(pool))] * 2 + [(rng.choice(pool), drawn)])
    return damaged(rng, tables, other) if tables is not drawn or rng.random() < 0.65 else tomli_w.dumps(drawn)


def no_numbers(value: Any, path: str = "") -> Iterator[str]:
    """Paths in a summary at which a number is nan or infinite."""
    for key, item in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from no_numbers(item, f"{path}.{key}".lstrip("."))
    if isinstance(value, float) and not math.isfinite(value):
        yield path


def wrong_arrays(file: Path) -> Iterator[str]:
    """Datasets of results.h5 that have numbers which are none."""
    import h5py
    import numpy as np

    names: list[str] = []
    with h5py.File(file) as results:
        results.visititems(
            lambda name, item: names.append(name) if hasattr(item, "dtype") and item.dtype.kind == "f" else None
        )
        yield from (name for name in names if not np.isfinite(results[name][()]).all())


def doubts(summary: dict[str, Any], output: Path) -> Iterator[str]:
    """Faults in the answer of a run that says "ok"."""
    if summary["status"] != "ok":
        return
    yield from (f"{path} of the summary is no number" for path in no_numbers(summary))
    yield from (f"{name} of results.h5 is no number" for name in wrong_arrays(output / "results.h5"))
    bracket, limits = summary.get("failure_load_bracket"), summary.get("limit_analysis") or {}
    bounds = limits.get("associated_bounds")
    if bracket and bounds and bracket[0] > bounds[1] * WIDEST and "above_the_bound" not in summary:
        yield f"failure load {bracket[0]} above its bound {bounds[1]}"


def outcome(kind: str, text: str, folder: Path, limit: float = LIMIT) -> tuple[str, list[str], float]:
    """How a case ended, what is wrong with that, and its CPU seconds."""
    from dem_cli.app.cli.main import main

    path, output = folder / "case.toml", folder / "out"
    path.write_text(text, encoding="utf-8")
    shutil.rmtree(output, ignore_errors=True)
    words = ["check", str(path)] if kind == "checks" else ["run", str(path), "-q", "--json", "-o", str(output)]
    said, errors, watch, code = io.StringIO(), io.StringIO(), Stopwatch(limit), -1
    with warnings.catch_warnings(record=True) as warned, redirect_stdout(said), redirect_stderr(errors):
        warnings.simplefilter("always")
        try:
            with watch:
                main(args=words)
        except SystemExit as end:
            code = int(end.code or 0)
        except OutOfTime:
            return "out of time", [f"takes more than {limit:g} CPU s"] if kind == "checks" else [], watch.used
        except BaseException as error:
            return "exception", [f"{type(error).__name__}: {error}"], watch.used
    warned = [w for w in warned if not issubclass(w.category, PASSED_OVER)]
    wrong = [f"{w.category.__name__}: {w.message} {w.filename}:{w.lineno}" for w in warned]
    unsaid = code == 2 and not re.search("^(error|Error|Usage): ", errors.getvalue(), re.MULTILINE)
    if code not in ENDED[kind] or unsaid:
        wrong.append(f"exit code {code}: {' '.join(errors.getvalue().split())[-500:]}")
    elif code != 2 and (found := NO_NUMBER.search(said.getvalue() + errors.getvalue())):
        wrong.append(f"prints {found[0]}")
    ended = ENDED[kind].get(code, f"exit code {code}")
    if kind == "runs" and code in (0, 1, 3):
        summary = json.loads(said.getvalue())
        wrong += doubts(summary, output)
        ended = f"{summary['kind']} {summary['status'].partition(':')[0][:40]}"
    return ended, wrong, watch.used


def bound(what: int, most: int) -> None:
    """Lets this process have so much of it, or what it may have at all where that is less."""
    _, hard = resource.getrlimit(what)
    resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def work(kind: str, seeds: range, pipe: int, limit: float, keep: Path) -> None:
    """A process that goes through these seeds and tells of each, before and after; cases of finds stay in `keep`."""
    bound(resource.RLIMIT_AS, MEMORY)
    os.environ["DEM_TRACEBACK"] = "1"
    pool = project_cases()
    with tempfile.TemporaryDirectory() as name, os.fdopen(pipe, "w", buffering=1) as tell:
        os.chdir(name)  # reports of internal errors go there
        for seed in seeds:
            print(json.dumps([seed]), file=tell)
            bound(resource.RLIMIT_CPU, int(time.process_time() + 5 * limit + 120))  # loops that never come back
            kept = keep / f"{kind}-{seed}.toml"
            kept.write_text(text := text_of(kind, seed, pool), encoding="utf-8")
            ended, wrong, used = outcome(kind, text, Path(name), limit)
            if not wrong:
                kept.unlink()
            print(json.dumps([seed, ended, wrong, used]), file=tell)
            if ended in ("out of time", "exception"):
                break  # what was cut off may have left anything behind


def batch(kind: str, seeds: range, limit: float, keep: Path) -> Iterator[tuple[int, str, list[str], float]]:
    """What a process says of these seeds: all of them, or up to one that ends it."""
    ours, theirs = os.pipe()
    if (child := os.fork()) == 0:
        code = 1  # a find: without one the same seeds would begin for ever
        try:
            os.close(ours)
            work(kind, seeds, theirs, limit, keep)
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)
    os.close(theirs)
    at = seeds.start
    with os.fdopen(ours) as told:
        for line in told:
            at, *result = json.loads(line)
            if result:
                yield at, *result
                at += 1
    _, status = os.waitpid(child, 0)
    if status:
        yield at, "died", [f"the process died: {os.waitstatus_to_exitcode(status)}"], 0.0


def fuzz(kind: str, seeds: range, limit: float, keep: Path) -> int:
    """All of these seeds: a line for each find, counts at the end. Returns how many finds there are."""
    counts, finds, total, slowest = Counter[str](), 0, 0.0, (0.0, -1)
    first = seeds.start
    while first < seeds.stop:
        for seed, ended, wrong, used in batch(kind, range(first, min(first + BATCH, seeds.stop)), limit, keep):
            first = seed + 1
            counts[ended] += 1
            total, slowest = total + used, max(slowest, (used, seed))
            if wrong:
                finds += 1
                print(f"find: {kind} {seed} ({used:.1f} CPU s): {' | '.join(wrong)}", flush=True)
    said = ", ".join(f"{count} {ended}" for ended, count in counts.most_common())
    print(f"{kind} {seeds.start}:{seeds.stop}: {said}")
    print(f"  {finds} finds; {total:.0f} CPU s, at most {slowest[0]:.1f} (seed {slowest[1]})", flush=True)
    return finds


def seeds_of(text: str) -> range:
    """A:B: the seeds from A to before B."""
    low, _, high = text.partition(":")
    return range(int(low), int(high))


def main(words: Sequence[str] | None = None) -> int:
    """Returns 1 where anything was found, else 0."""
    parser = argparse.ArgumentParser(prog="scripts/fuzz", description="Check and run cases drawn at random.")
    for kind in ENDED:
        parser.add_argument(
            f"--{kind}", type=seeds_of, default=range(0), metavar="A:B", help="seeds from A to before B"
        )
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="SECONDS", help="CPU seconds of a case")
    parser.add_argument(
        "--keep", type=Path, default=Path("fuzz-finds"), metavar="DIR", help="folder for cases of finds"
    )
    asked = parser.parse_args(words)
    keep = asked.keep.resolve()
    keep.mkdir(parents=True, exist_ok=True)
    return int(sum([fuzz(kind, getattr(asked, kind), asked.limit, keep) for kind in ENDED if getattr(asked, kind)]) > 0)


if __name__ == "__main__":
    sys.exit(main())
