"""Stages of a run: what is kept, what a resumed run does again, and what it refuses."""

from __future__ import annotations

import os

import numpy as np
import pytest

from dem_cli.core.records.ports import NOTHING_KEPT, stage
from dem_cli.errors import SolverError, UsageError
from dem_cli.results.output.folder import locked
from dem_cli.results.output.resume.checkpoints import Checkpoints
from dem_cli.results.output.resume.kept_objects import all_changing, decoded, encoded
from dem_cli.results.output.resume.kept_values import NotKept
from dem_cli.results.output.resume.stages import Keeping, KeptStages

WHAT = {"the case": "a", "the program": "b"}
ALL = Keeping(first=0.0, every=0.0, worth=0.0)


class Killed(BaseException):
    """As a kill, which no one answers."""


class Stretched:
    """Something that changes while it is worked on."""

    LASTING = frozenset(("model", "stages"))

    def __init__(self, stages=NOTHING_KEPT):
        self.model, self.stages = object(), stages
        self.places, self.steps = np.zeros(3), 0

    def go_on(self):
        self.places += 0.1 * np.arange(3)
        self.steps += 1


class Loop:
    def __init__(self):
        self.number, self.seen = 0, []


@stage
def stretched(sim, times, tell):
    """A loop that tells where it is."""
    loop = Loop()
    sim.stages.resumed(loop)
    while loop.number < times:
        sim.stages.offer(loop)
        sim.go_on()
        loop.number += 1
        loop.seen.append(float(sim.places[1]))
        tell((sim.steps, loop.number))
    return loop.seen


@stage
def gives_up(sim):
    sim.go_on()
    raise SolverError("no rest was found")


def way(folder, killed_at=None, resume=False, keeping=ALL, what=WHAT):
    """A run of three stages; what it found, what it told, and how many steps it worked itself."""
    told = []
    checkpoints = Checkpoints(folder, "out", lambda: what, resume)
    stages = KeptStages(checkpoints, lambda kind, record: told.append(record), keeping)
    sim = Stretched(stages)
    before, worked = Stretched.go_on, []

    def counted(self):
        if self.steps == killed_at:
            raise Killed
        worked.append(1)
        before(self)

    def tell(record):
        told.append(record)
        stages.note("row", record)

    Stretched.go_on = counted
    try:
        tell("begun")
        found = [stretched(sim, 4, tell)]
        tell(sim.places.tolist())
        with pytest.raises(SolverError, match="no rest was found"):
            gives_up(sim)
        found.append(stretched(sim, 3, tell))
        checkpoints.remove()
    finally:
        Stretched.go_on = before
        checkpoints.close()
    return found, told, sim.places.tolist(), len(worked)


@pytest.mark.parametrize("killed_at", range(8))
def test_a_killed_way_goes_on_to_the_same_end(tmp_path, killed_at):
    (tmp_path / "s").mkdir()
    straight = way(tmp_path / "s")
    with pytest.raises(Killed):
        way(tmp_path, killed_at)
    found, told, places, worked = way(tmp_path, resume=True)
    assert (found, told, places) == straight[:3]
    assert worked == 8 - killed_at, "nothing is done twice"
    assert not (tmp_path / ".out.dem-stages").exists()


def test_killed_twice(tmp_path):
    for killed_at, resume in ((2, False), (6, True)):
        with pytest.raises(Killed):
            way(tmp_path, killed_at, resume)
    (tmp_path / "s").mkdir()
    assert way(tmp_path, resume=True)[:3] == way(tmp_path / "s")[:3]


def test_nothing_is_kept_of_the_first_seconds(tmp_path):
    way(tmp_path, keeping=Keeping(first=60.0, every=0.0, worth=0.0))
    with pytest.raises(Killed):
        way(tmp_path, 6, keeping=Keeping(first=60.0, every=0.0, worth=0.0))
    assert not (tmp_path / ".out.dem-stages").exists()


def test_what_is_not_asked_for_or_of_another_case_is_refused(tmp_path):
    with pytest.raises(Killed):
        way(tmp_path, 6)
    with pytest.raises(UsageError, match=r"left 0.1 min of work in .*: go on with --resume"):
        way(tmp_path)
    with pytest.raises(UsageError, match="cannot resume: the program changed"):
        way(tmp_path, resume=True, what=WHAT | {"the program": "c"})
    assert way(tmp_path, what=WHAT | {"the program": "c"})[3] == 8, "begun anew"


@pytest.mark.parametrize("damaged", ["told", "1+.state", "about.json"])
def test_what_a_kill_cut_short_is_done_again(tmp_path, damaged):
    (tmp_path / "s").mkdir()
    with pytest.raises(Killed):
        way(tmp_path, 3)
    file = tmp_path / ".out.dem-stages" / damaged
    file.write_bytes(file.read_bytes()[:-3])
    assert way(tmp_path, resume=True)[:3] == way(tmp_path / "s")[:3]


def test_another_way_is_not_mixed_with_what_was_kept(tmp_path):
    with pytest.raises(Killed):
        way(tmp_path, 6)
    checkpoints = Checkpoints(tmp_path, "out", lambda: WHAT, True)
    stages = KeptStages(checkpoints, lambda kind, record: None, ALL)
    assert len(stretched(Stretched(stages), 5, lambda record: None)) == 5
    assert not {"2", "3+"} & set(checkpoints.names())


def test_a_second_run_of_the_same_folder_is_refused(tmp_path):
    with pytest.raises(Killed):
        way(tmp_path, 3)
    first = Checkpoints(tmp_path, "out", lambda: WHAT, True)
    with pytest.raises(UsageError, match="another run is writing"):
        Checkpoints(tmp_path, "out", lambda: WHAT, True)
    first.close()


def test_only_data_is_read():
    class Unkept:
        def __reduce__(self):
            return (print, ("called",))

    with pytest.raises(NotKept, match="is not among the records"):
        encoded([], Unkept())
    sim = Stretched()
    here = all_changing([sim, sim])
    assert here == [sim]
    data, model = encoded(here, {"of": sim, "model": sim.model}), sim.model
    sim.go_on()
    sim.later = 1
    again = decoded(data, here)
    assert again == {"of": sim, "model": model}
    assert sim.steps == 0
    assert not hasattr(sim, "later")


def test_what_cannot_be_kept_costs_the_run_nothing(tmp_path):
    """A fault of the program: it is said once, nothing more is kept, and what was kept before stays sound."""
    said = []
    checkpoints = Checkpoints(tmp_path, "out", lambda: WHAT, False)
    stages = KeptStages(checkpoints, lambda kind, record: None, ALL)
    stages.gives_up = said.append
    sim = Stretched(stages)
    first = stretched(sim, 2, lambda record: None)
    sim.more = object()
    stages.note("row", 1)
    assert stretched(sim, 2, lambda record: stages.note("row", record)) == [0.1 * 3, 0.4]
    assert said == ["builtins.object is not among the records that checkpoints hold"]
    assert checkpoints.names() == ["1"]
    checkpoints.close()
    again = KeptStages(Checkpoints(tmp_path, "out", lambda: WHAT, True), lambda kind, record: None, ALL)
    assert stretched(Stretched(again), 2, lambda record: None) == first
    again.kept.close()


@pytest.mark.parametrize("loop", [{"number": "x"}, {"seen": 1}, {"number": 1, "__class__": 1}, {3: 1}], ids=repr)
def test_a_loop_takes_back_what_it_had(tmp_path, monkeypatch, loop):
    with pytest.raises(Killed):
        way(tmp_path, 3)
    read = KeptStages._read

    def other(*words):
        found = read(*words)
        return found._replace(loop=loop) if hasattr(found, "loop") else found

    monkeypatch.setattr(KeptStages, "_read", other)
    with pytest.raises(UsageError, match="is damaged; delete it to start anew"):
        way(tmp_path, resume=True)


ABOUTS = [None, "5", '{"format', '{"format": 1, "what": 3, "seconds": 1.0}', '{"what": {}}', "[" * 100_000]
ABOUTS += [f'{{"format": 2, "what": {{}}, "seconds": {each}}}' for each in ("NaN", "1e400", "-1.0", '"1"', "9" * 400)]


@pytest.mark.parametrize("about", ABOUTS)
def test_a_folder_that_says_nothing_of_its_run(tmp_path, about):
    """Of a run that was killed, or is under way, as it made it, or damaged by the disk."""
    folder = tmp_path / ".out.dem-stages"
    folder.mkdir()
    if about is not None:
        (folder / "about.json").write_text(about)
    lock = os.open(folder / ".lock", os.O_CREAT | os.O_RDWR)
    assert locked(lock)
    with pytest.raises(UsageError, match="another run is writing"):
        Checkpoints(tmp_path, "out", lambda: WHAT, True)
    assert folder.exists()
    os.close(lock)
    assert not Checkpoints(tmp_path, "out", lambda: WHAT, True).found
    assert not folder.exists()
