"""Commands that are interrupted: their cases, what shows that they are at work, what they have promised to keep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from studies.places import CASES

COLUMN = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "column"
block = [0.04, 0.02]
courses = {courses}
base_extension = 0.02
[[monitor]]
block = "top"
"""
FRAGILITY = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.7
kn = 1e9
[[structure]]
kind = "column"
id = "c"
courses = 2
block = [0.4, 0.8]
[analysis]
kind = "fragility"
intensities = [0.15, 0.3, 0.45, 0.6, 0.9]
unit_acceleration = 9.81
[[motion]]
kind = "artificial"
spectrum = "EC8-1"
soil = "B"
ag = 3.0
duration = 4.0
rise = 0.5
plateau = 2.5
count = 4
"""
SWEEP = COLUMN.format(courses=3) + (
    "[analysis]\nresolution = 0.01\nfollow = 0.0\n"
    '[sweep]\n"joints.dry.friction" = { from = 0.2, to = 0.7, count = 40 }\n'
)
CALIBRATION = (
    COLUMN.format(courses=3).replace("0.6", "3.0")
    + """\
[analysis]
kind = "pushover"
resolution = 0.005
[calibration]
failure_load = 0.55
displacement = 0.0006
point = [0.0, 0.06]
component = "x"
apertures = [1e-4, 4e-4]
shapes = [{ name = "narrow", sides = 3, central = 0.1 }, { name = "equal", lengths = [1.0, 1.0, 1.0] }]
"""
)
RUNS = "out/runs/[!.]*/summary.json"
Kept = Mapping[Path, bytes]  # files, and what they must go on holding


@dataclass(frozen=True)
class InterruptedCommand:
    """A command with `out` as the folder of its results, in a folder of its own."""

    words: tuple[str, ...]
    text: str = ""  # of case.toml
    begun: str = ".out.dem-new-*"  # files that show that it is at work
    promised: str = ""  # files that are whole once they are there; those of a journal may grow
    table: str = ""  # of the answer, the same bytes after an interrupt and another go
    again: tuple[str, ...] | None = None  # more words that go on where it stopped

    def kept(self, folder: Path) -> dict[Path, bytes]:
        """What must be there after the interrupt: whole lines of a journal, whole files."""
        found = {path: path.read_bytes() for path in folder.glob(self.promised)} if self.promised else {}
        whole = {path: text[: text.rfind(b"\n") + 1] for path, text in found.items()}
        return {path: text for path, text in whole.items() if text.count(b"\n") > 1}  # a journal has a first line


def case(name: str) -> str:
    return str(CASES / "verification" / f"{name}.toml")


COMMANDS: dict[str, InterruptedCommand] = {
    "pushover": InterruptedCommand(("run", case("wall_21"), "-o", "out")),
    "time_history": InterruptedCommand(
        ("run", case("rocking_free"), "-o", "out", "--set", "analysis.duration=4.0", "--set", "output.rate=200"),
    ),
    "fragility": InterruptedCommand(
        ("run", "case.toml", "-o", "out"), FRAGILITY, begun=".out.dem-runs", promised=".out.dem-runs",
        table="out/fragility.csv", again=("--resume",),
    ),
    "sweep": InterruptedCommand(
        ("sweep", "case.toml", "-o", "out", "-j", "2"), SWEEP, begun="out/runs/*", promised=RUNS,
        table="out/sweep.csv", again=(),
    ),
    "sweep_alone": InterruptedCommand(
        ("sweep", "case.toml", "-o", "out", "-j", "1"), SWEEP, begun="out/runs/*", promised=RUNS,
        table="out/sweep.csv", again=(),
    ),
    "verify": InterruptedCommand(
        ("verify", *map(case, ("wall_21", "arch_21", "rocking_free", "portal")), "-j", "2"),
        begun="tmp/*",
    ),
    "calibrate": InterruptedCommand(("calibrate", "case.toml", "-o", "out", "-j", "2"), CALIBRATION),
}  # fmt: skip
