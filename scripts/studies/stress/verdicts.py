"""One stress is one record: what was asked, what came out, and the verdict."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any

from dem_cli.analyses.solve import solve
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.errors import CaseError, DemError
from dem_cli.masonry.assembly.validate import warnings as oddities
from studies.observer import RunKeeper
from studies.stress.structures import StressScene

HELD, WARNED, REFUSED, WRONG = "held", "warned", "refused", "WRONG"
WITHIN = 0.005  # relative error of a failure load that is no error, where the bracket is narrower


@dataclass(frozen=True)
class StressRecord:
    """What one stress did to one structure."""

    axis: str
    structure: str  # with the variant, for example "wall 0.6, fixed"
    value: str  # on the axis
    verdict: str
    found: str  # load or measured figure
    error: float | None = None  # relative, against the exact load or the unstressed answer
    how: str = ""  # how exactly it held
    message: str = ""  # warning or refusal


@dataclass
class PushoverAnswer:
    """A pushover as a user would see it."""

    status: str
    load: float | None = None
    bracket: tuple[float | None, float | None] = (None, None)
    warnings: list[str] = field(default_factory=list)  # about the answer
    summary: dict[str, Any] = field(default_factory=dict)
    frames: list[Any] = field(default_factory=list)
    refusal: str = ""  # message of an error raised on purpose
    crash: str = ""  # any other exception

    @property
    def width(self) -> float:
        """Of the bracket, relative."""
        low, high = self.bracket
        return 0.0 if not low or high is None else (high - low) / low


def push(scene: StressScene, settings: Settings = DEFAULT) -> PushoverAnswer:
    """Solve a scene; nothing is raised, everything is kept."""
    keeper = RunKeeper()
    with warnings.catch_warnings(record=True) as spoken:
        warnings.simplefilter("always")
        try:
            case, model, said = scene.build()
            summary = solve(case, model, keeper, settings=settings).summary
        except CaseError as error:
            return PushoverAnswer("refused", refusal=error.problems[0].message)
        except DemError as error:
            return PushoverAnswer("refused", refusal=str(error))
        except Exception as error:  # whatever it is, it is a bug that the table must show
            return PushoverAnswer("crashed", crash=f"{type(error).__name__}: {error}")
    python = [f"Python: {w.category.__name__}: {w.message}" for w in spoken]
    load = summary.get("failure_load")
    bracket = tuple(summary.get("failure_load_bracket") or (None, None))
    # Doubts about units and words about speed excuse no wrong load.
    about = [line for line in (*oddities(model), *summary["warnings"]) if "expect" not in line]
    return PushoverAnswer(summary["status"], load, bracket, about, {**summary, "said": said + python}, keeper.frames)


def off(load: float, exact: tuple[float, float]) -> float:
    """Relative distance from an interval, with its sign."""
    low, high = exact
    return (load - high) / high if load > high else 0.0 if load >= low else (load - low) / low


def judge(answer: PushoverAnswer, exact: tuple[float, float], within: float = WITHIN) -> tuple[str, float | None]:
    """Verdict and error of a failure load whose exact value lies in an interval."""
    if answer.crash:
        return WRONG, None
    if answer.refusal or answer.status.startswith(("not converged", "interrupted")):
        return REFUSED, None
    if answer.load is None:  # stands for ever, or falls at once: an answer too, and not the exact one
        return (WARNED if answer.warnings else WRONG), None
    error = off(answer.load, exact)
    if abs(error) <= max(within, answer.width):
        return HELD, error
    return (WARNED if answer.warnings else WRONG), error


def load_record(
    axis: str,
    scene: StressScene,
    value: str,
    *,
    variant: str = "",
    base: PushoverAnswer | None = None,
    within: float = WITHIN,
    settings: Settings = DEFAULT,
) -> StressRecord:
    """A stressed pushover against the exact load and, where `base` is given, against the unstressed answer."""
    answer = push(scene, settings)
    verdict, error = judge(answer, scene.exact, within)
    how = "" if error is None else "exact" if error == 0.0 else f"{abs(error):.1e}"
    if verdict == HELD and base is not None and base.load is not None:
        error = answer.load / base.load - 1.0
        how = likeness(answer, base)
        if abs(error) > max(within, answer.width, base.width):
            verdict = WARNED if answer.warnings else WRONG
    found = "–" if answer.load is None else f"{answer.load:.6g}"
    said = answer.refusal or answer.crash or "; ".join(answer.warnings)
    if not said and answer.load is None:
        said = answer.status
    structure = f"{scene.name}, {variant}" if variant else scene.name
    return StressRecord(axis, structure, value, verdict, found, error, how, said)


def likeness(answer: PushoverAnswer, base: PushoverAnswer) -> str:
    """How exactly two answers are the same."""
    if (answer.load, answer.bracket) == (base.load, base.bracket):
        return "bit-identical"
    difference = abs(answer.load / base.load - 1.0)
    return f"{max(difference, 1e-16):.1e}"


def figure(axis: str, structure: str, value: str, measured: float, limit: float) -> StressRecord:
    """A measured figure that must not exceed its limit; not-a-number exceeds every limit."""
    verdict = HELD if measured <= limit else WRONG
    how = "exactly zero" if measured == 0.0 else f"{measured:.1e}"
    return StressRecord(axis, structure, value, verdict, f"{measured:.1e}", measured, how, f"allowed {limit:.0e}")
