"""Stages of a run (core/records/ports.py) stored in a folder for `--resume`: checkpoints, and the output so far."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from dem_cli.core.records.ports import Stages
from dem_cli.errors import SolverError
from dem_cli.interrupts import asked
from dem_cli.results.output.resume.kept_objects import Changing, all_changing, check_like, decoded, encoded, put_back
from dem_cli.results.output.resume.kept_values import Damaged, NotKept

if TYPE_CHECKING:
    from dem_cli.results.output.resume.checkpoints import Checkpoints

_SAY_EVERY = 0.2  # s between words that work goes on
Found = TypeVar("Found")
_UNDER_WAY, _INSIDE = "+", "-"  # in names: a checkpoint of a stage; a stage inside another one


class Keeping(NamedTuple):
    """Time limits that decide which stages and checkpoints are stored."""

    first: float = 20.0  # s of a run of which nothing is kept: it is done again
    every: float = 60.0  # s of work that a kill may cost
    worth: float = 50.0  # times as long as keeping it takes, a stage must have taken


DEFAULT_KEEPING = Keeping()


class _UnderWay:
    """Running stage, and its number of inner stages so far."""

    def __init__(self, name: str, key: str, changing: list[Changing], now: float):
        self.name, self.key, self.changing, self.begun, self.kept = name, key, changing, now, now
        self.inside = 0

    def next(self) -> str:
        """Return the key of the next inner stage."""
        self.inside += 1
        return self.key + f"{_INSIDE}{self.inside}" * bool(self.key) or str(self.inside)


class _Outcome(NamedTuple):
    """Stored outcome of a finished stage."""

    found: Any
    gave_up: str | None = None  # with a SolverError


class _Checkpoint(NamedTuple):
    """Stored checkpoint of a running stage."""

    inside: int  # stages inside so far, which are not needed again
    loop: dict[str, Any]


class KeptStages(Stages):
    """Stages of a run, stored in a folder.

    tell: hands output of the earlier run on to the results; raises Damaged where it is of no known kind.
    """

    def __init__(self, kept: Checkpoints, tell: Callable[[str, Any], None], keeping: Keeping = DEFAULT_KEEPING) -> None:
        self.kept, self.tell, self.keeping = kept, tell, keeping
        self.goes_on: Callable[[], None] = lambda: None  # who hears that work goes on
        self.gives_up: Callable[[str], None] = lambda why: None  # who hears that nothing more is kept, and why
        self._over = False
        self.went_on = False  # whether anything was put back
        self._say_next = 0.0
        self._now = time.monotonic
        self._begun = self._now()
        self._places = kept.told()  # of what was told, where it is kept
        self._names = set(kept.names())
        self._told = 0  # so far, by this run
        self._waiting: list[tuple[str, Any]] = []  # reported, and not stored yet
        self._cost = 0.01  # s of keeping a stage
        self.before = kept.seconds
        self._open = [_UnderWay("", "", [], self._begun)]

    # -- reported output ----------------------------------------------------------------------------

    def note(self, kind: str, record: Any) -> None:
        """Record output of the run."""
        self._told += 1
        if not self._over and self._told > len(self._places) + len(self._waiting):
            self._waiting.append((kind, record))

    def _tell_again(self, until: int) -> None:
        """Replay the output of a stage that is not repeated."""
        if until < self._told:
            raise self.kept.damaged("the run reported more before")
        for data in self.kept.told_at(self._places[self._told : until]):
            told = self._decoded(data, [], tuple)
            if [type(each) for each in told[:1]] != [str] or len(told[1:]) != 1:
                raise self.kept.damaged("output of an unknown kind")
            self._unless_damaged(partial(self.tell, *told))
        self._told = until

    def _decoded(self, data: bytes, changing: list[Changing], kind: type[Any]) -> Any:
        """Decode stored data of a type. Raises UsageError where it is damaged, or of another type."""
        found = self._unless_damaged(lambda: decoded(data, changing))
        if type(found) is not kind:
            raise self.kept.damaged(f"a {kind.__name__} is missing")
        return found

    def _unless_damaged(self, work: Callable[[], Found]) -> Found:
        """Call a function and convert Damaged to UsageError."""
        try:
            return work()
        except Damaged as error:
            raise self.kept.damaged(error) from None

    # -- stages ------------------------------------------------------------------------------------

    def done(self, name: str, arguments: tuple[Any, ...], work: Callable[[], Found]) -> Found:
        """Run a stage, or return its stored outcome (see Stages). Raises SolverError where the work did."""
        key, changing = self._open[-1].next(), all_changing(arguments)
        under_way = _UnderWay(_in_full(name, arguments, changing), key, changing, self._now())
        known = self._read(key, under_way, _Outcome)
        if known is None:
            return self._worked(under_way, work)
        if known.gave_up is not None:
            if not all(each.isprintable() for each in known.gave_up.splitlines()):
                raise self.kept.damaged("words that no terminal should see")
            raise SolverError(known.gave_up)
        return known.found  # type: ignore[no-any-return]

    def _worked(self, under_way: _UnderWay, work: Callable[[], Found]) -> Found:
        depth = len(self._open)
        self._open.append(under_way)
        try:
            found = work()
        except SolverError as error:
            del self._open[depth:]
            self._finished(under_way, _Outcome(None, str(error)))
            raise
        finally:
            del self._open[depth:]
        self._finished(under_way, _Outcome(found))
        return found

    def _finished(self, under_way: _UnderWay, outcome: _Outcome) -> None:
        key, keeping, now = under_way.key, self.keeping, self._now()
        inside = [name for name in self._names if name.startswith((key + _INSIDE, key + _UNDER_WAY))]
        if not inside and (now - self._begun < keeping.first or now - under_way.begun < keeping.worth * self._cost):
            return
        if self._write(key, under_way, outcome):
            self._drop(inside)

    def resumed(self, loop: Any = None) -> bool:
        """Restore the last checkpoint of the running stage (see Stages)."""
        under_way = self._open[-1]
        known = self._read(under_way.key + _UNDER_WAY, under_way, _Checkpoint)
        if known is None:
            return False
        under_way.inside = known.inside
        if loop is not None:
            self._unless_damaged(lambda: check_like(loop, known.loop))
            put_back(loop, known.loop)
        return True

    def offer(self, loop: Any = None) -> None:
        """Store a checkpoint of the running stage if it is time (see Stages)."""
        under_way, now = self._open[-1], self._now()
        if now >= self._say_next:
            self._say_next = now + _SAY_EVERY
            self.goes_on()
        if now - under_way.kept < self.keeping.every or now - self._begun < self.keeping.first:
            return
        checkpoint = _Checkpoint(under_way.inside, {} if loop is None else dict(vars(loop)))
        if self._write(under_way.key + _UNDER_WAY, under_way, checkpoint):
            under_way.kept = self._now()
            inside = under_way.key + _INSIDE
            self._drop([name for name in self._names if name.startswith(inside)])

    # -- what is kept ------------------------------------------------------------------------------

    def _write(self, name: str, under_way: _UnderWay, what: _Outcome | _Checkpoint) -> bool:
        """Store a stage or a checkpoint with all output so far; not after an interrupt."""
        if asked() or self._over:
            return False
        begun = self._now()
        seconds = self.before + begun - self._begun
        try:
            entries = [encoded([], entry) for entry in self._waiting]
            state = encoded([], (under_way.name, self._told, encoded(under_way.changing, what)))
            self._places += self.kept.tell(entries)
            self._waiting.clear()
            self.kept.write(name, state, seconds)
        except NotKept as error:  # a fault of the program, for which nobody loses a run
            self._over = True
            self._waiting.clear()
            self.gives_up(str(error))
            return False
        self._names.add(name)
        self._cost = self._now() - begun
        return True

    def _read(self, name: str, under_way: _UnderWay, kind: type[Any]) -> Any:
        """Restore a stored stage or checkpoint; None where there is none. Raises UsageError."""
        data = self.kept.read(name) if name in self._names else None
        if data is None:
            return None
        header = self._decoded(data, [], tuple)
        if [type(each) for each in header] != [str, int, bytes]:
            raise self.kept.damaged("a state without a name")
        of, told, state = header
        if of != under_way.name or told > len(self._places):  # another way, or lost: nothing is of this run
            self._drop(list(self._names))
            self._places = self.kept.only(self._places[: self._told])
            return None
        self.went_on = True
        found = self._decoded(state, under_way.changing, kind)
        self._tell_again(told)
        return found

    def _drop(self, names: list[str]) -> None:
        for name in names:
            self.kept.drop(name)
        self._names.difference_update(names)


def _in_full(name: str, arguments: tuple[Any, ...], changing: list[Changing]) -> str:
    """Return the full name of a stage with its numbers, and the number of steps done before."""
    numbers = [repr(each) for each in arguments if isinstance(each, (int, float, str))]
    steps = [str(one.steps) for one in changing if hasattr(one, "steps")]
    return f"{name}({', '.join(numbers)}) after {', '.join(steps)} steps"
