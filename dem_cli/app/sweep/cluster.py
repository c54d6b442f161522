"""Run a sweep on a Dask cluster, whose workers see the same files and run the same program."""

from __future__ import annotations

import os
import secrets
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from ipaddress import ip_address
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from dem_cli.app.sweep.identity import program
from dem_cli.app.sweep.pool import ASK, WorkerDeath
from dem_cli.app.sweep.run import Summary, SweepJob
from dem_cli.errors import MissingExtra, SolverError, UsageError
from dem_cli.interrupts import at_once, insist

CLUSTER_GONE = "the cluster went away; what was done is kept, run the same command again"
OPEN = (
    "whoever reaches this scheduler can run code on its workers, as you; give a tls:// address (docs/guide/sweeps.md)"
)
PRIVATE = ("tls", "wss", "inproc")  # schemes of addresses that only those with a certificate, or this process, reach
PATIENCE = 10  # s to reach the scheduler, and to wait for its first worker


@contextmanager
def connected(address: str, folder: Path) -> Iterator[Any]:
    """Connect to the cluster at `address` and check its workers.

    Raises UsageError where there is no cluster, where Dask is missing, or where a worker runs another program or
    does not see `folder`.
    """
    try:
        from dask.distributed import Client
    except ImportError:
        raise MissingExtra("--scheduler needs Dask", "cluster") from None
    try:
        with at_once():
            client = Client(address, timeout=PATIENCE, set_as_default=False)
    except TypeError:  # of Dask, where its configuration names no certificates
        raise UsageError(f"--scheduler {address}: Dask has no certificates; tell it in distributed.comm.tls "
                         "(docs/guide/sweeps.md)") from None  # fmt: skip
    except Exception as error:  # Dask takes the words of another server for lengths: MemoryError, struct.error
        said = next(iter(str(error).splitlines()), type(error).__name__)
        raise UsageError(f"--scheduler {address}: no Dask scheduler answers ({said})") from None
    try:
        _inspect(client, address, folder)
        yield client
    finally:
        client.close()


def doubt(address: str) -> str | None:
    """Return a warning about a scheduler that others may reach, neither local nor behind TLS; None: it is safe."""
    parts = urlsplit(address if "://" in address else f"tcp://{address}")
    if parts.scheme in PRIVATE or parts.hostname == "localhost":
        return None
    try:
        private = ip_address(parts.hostname or "").is_loopback
    except ValueError:  # a name
        private = False
    return None if private else f"--scheduler {address}: {OPEN}"


def _inspect(client: Any, address: str, folder: Path) -> None:
    """Check that all workers of the cluster are usable."""
    from dask.distributed import TimeoutError as TooLate

    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TooLate:
        raise UsageError(f"--scheduler {address}: the cluster has no workers") from None
    probe = folder / f".probe-{secrets.token_hex(4)}"
    probe.write_text("")
    try:
        for worker, sees in _asked(client, os.path.exists, str(probe)):
            if sees is not True:
                raise UsageError(f"--scheduler {address}: worker {worker} does not see {folder}: put the results on a "
                                 "file system that all workers share")  # fmt: skip
        for worker, theirs in _asked(client, program):
            if theirs != program():
                raise UsageError(f"--scheduler {address}: worker {worker} runs another program: {theirs!s:.300}; "
                                 f"here it is {program()}")  # fmt: skip
    finally:
        probe.unlink(missing_ok=True)


def _asked(client: Any, function: Callable[..., Any], *values: Any) -> list[tuple[str, Any]]:
    """Call a function on each worker; returns answers and errors, except of workers that are leaving."""
    answers = client.run(function, *values, on_error="return")
    return [(worker, answer) for worker, answer in answers.items() if not isinstance(answer, OSError)]


def on_cluster(
    client: Any, do: Callable[[SweepJob], Summary], jobs: Sequence[SweepJob]
) -> Iterator[tuple[int, Summary | WorkerDeath]]:
    """Yield number and result of each job as they finish.

    A job whose worker dies is done again by another, a few times, by Dask; what seems to kill its workers is then done
    alone, because innocent jobs that waited at the same worker are suspected too.
    """
    suspects: list[int] = []
    for number, result in _asked_for(client, do, list(enumerate(jobs)), ""):
        if isinstance(result, WorkerDeath):
            suspects.append(number)
        else:
            yield number, result
    for number in suspects:
        yield from _asked_for(client, do, [(number, jobs[number])], "-alone")


def _completed(futures: Any) -> Iterator[Any]:
    """Yield futures as they finish, checking for interrupts."""
    while not futures.is_empty():
        batch = futures.next_batch(block=False)
        yield from batch
        insist()
        if not batch:
            time.sleep(ASK / 4)


def _asked_for(
    client: Any, do: Callable[[SweepJob], Summary], jobs: Sequence[tuple[int, SweepJob]], suffix: str
) -> Iterator[tuple[int, Summary | WorkerDeath]]:
    """Yield number and result of numbered jobs. Raises SolverError where the cluster is lost."""
    from dask.distributed import CancelledError, KilledWorker, as_completed

    numbers = {job.id + suffix: number for number, job in jobs}
    futures = client.map(do, [job for _, job in jobs], key=list(numbers), pure=False, batch_size=200) if jobs else []
    try:
        for future in _completed(as_completed(futures, loop=client.loop)):
            if isinstance(future.exception() if future.status == "error" else None, KilledWorker):
                yield numbers[future.key], WorkerDeath()
            elif future.cancelled():
                raise SolverError(CLUSTER_GONE)
            else:
                yield numbers[future.key], future.result()
            future.release()
    except CancelledError:
        raise SolverError(CLUSTER_GONE) from None
    except BaseException:
        client.cancel(futures)
        raise
