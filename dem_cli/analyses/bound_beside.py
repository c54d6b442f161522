"""Upper bound of a failure load: the associated load of limit analysis, for any kinematics, control and law.

Above that of the geometry of the start no forces inside the friction cones are in equilibrium. A structure may carry
more after its blocks have moved: then the bound of the geometry that it rests in says so. Where this one lies below the
load as well, the run is not to be trusted.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.engine import measures
from dem_cli.core.engine.kinematics import gaps_may_close
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.records.statuses import ABOVE, FALLS
from dem_cli.core.statics.certificates import certificates
from dem_cli.core.statics.failure_bracket import OK
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.state import SavedState
    from dem_cli.core.limit.analysis import LimitLoads
    from dem_cli.core.model.model import Model
    from dem_cli.core.statics.failure_bracket import FailureLoad

WIDEST = 0.1  # of the smallest edge: gaps between blocks that have moved, over which faces still touch at most


class Moved(NamedTuple):
    """State in which a load above the bound was carried: displacement of the blocks, and the bound there."""

    displacement: float  # largest of a block, since it rested under its dead loads [m]
    bound: float | None  # associated load of the geometry there; None: not known, or there is none


class Carried(NamedTuple):
    """Equilibrium under a live load, with its state and load."""

    load: float  # its multiplier
    standing: SavedState
    settled: float  # largest displacement of a block under the dead loads alone [m]


class StartBound:
    """Associated load of the initial geometry, computed on first use.

    asked: whether the case requests limit analysis, and so a message where it is impossible. model: that of the job, or
    one with other live loads. why_not: reason for the lack of a bound, known once `loads` was used; None: there is one.
    """

    def __init__(self, job: CaseJob, model: Model | None = None) -> None:
        self.job, self.model = job, job.model if model is None else model
        self.why_not: str | None = None
        self.asked = bool(getattr(job.case.analysis, "limit", False))

    def upper(self) -> float | None:
        """Upper bound of the load multiplier of rigid blocks in the initial geometry; None: not known."""
        return None if self.loads is None else self.loads.associated.upper

    @property
    def known(self) -> LimitLoads | None:
        """Limit analysis of the initial geometry, if it was done already; None: it was not."""
        return self.loads if "loads" in vars(self) else None

    @cached_property
    def loads(self) -> LimitLoads | None:
        """Limit analysis of the initial geometry; None, with the reason in `why_not`, where it is impossible."""
        job = self.job
        job.clock.imported("dem_cli.core.limit.analysis")
        from dem_cli.core.limit.analysis import limit_loads, require_scalable, taken_as_plane

        properties, law = joint_properties(job.request, self.model, job.stiffness("fixed")), law_of(job.request)
        note = taken_as_plane(properties)
        if note and self.asked:
            job.warnings.append(note)
        elif note:
            self.why_not = note
            return None
        job.clock.progress("limit analysis", 0.0, 0.0, None)
        try:
            if job.case.analysis.pattern == "tilt":
                require_scalable(self.model, properties, law)
            loads = limit_loads(
                self.model, properties, law, associated_only=not self.asked, settings=job.settings.limit
            )
        except UsageError as error:
            self.why_not = str(error)
            if self.asked:
                job.warnings.append(f"no limit analysis: {error}")
            return None
        if loads.associated.upper is None:
            self.why_not = f"limit analysis says: {loads.associated.status}"
        return loads

    def follow_path(self, search: FailureLoad, sim: Simulation) -> None:
        """Follow the zero-dilation path of the initial geometry as a second load history of a moving-geometry search.

        Only where nothing but the way of loading parts them: joints as stiff as dem chooses, no gaps that close. What
        blocks carry below it because they have moved is no other history: then the search is left as it is.
        """
        job, low, resolution = self.job, search.low, self.job.case.analysis.resolution
        if not (search.found and low) or not _differs_by_its_history(job, sim):
            return
        loads = self.loads
        if (
            loads is None
            or loads.associated.upper is None
            or abs(loads.associated.upper - low) <= resolution * abs(low)
        ):
            return
        if not self.asked:  # else the path is there
            from dem_cli.core.limit.analysis import with_path

            job.clock.progress("limit analysis", 0.0, 0.0, None)
            self.loads = loads = with_path(loads, job.settings.limit)
        path, still = loads.non_associated, search.peak_displacement <= resolution * sim.smallest
        if path is None or path.load is None or not path.finished:
            search.alone = "the zero-dilation path in the geometry of the start was not followed to its end"
        elif still or path.load <= low * (1.0 + resolution):
            search.path_of_start = path.load


def _differs_by_its_history(job: CaseJob, sim: Simulation) -> bool:
    """Test whether a failure load with moving geometry depends on the load path: stiff joints, friction, no gaps."""
    if sim.kinematics == "fixed" or sim.properties.given or sim.properties.rough or sim.law.bonded:
        return False
    return not gaps_may_close(job.request, job.model)


def beside(job: CaseJob, search: FailureLoad, sim: Simulation, start: StartBound) -> dict[str, Any]:
    """Compare the load of a search with its upper bound; returns keys of the summary and warns where it is above.

    sim: that of the search; it is left as it was.
    """
    limits = search.limits
    if limits is None or not search.low:
        return {}
    if job.case.analysis.limit:
        _ = limits.path  # computes the path
    loads = limits.loads() or start.loads
    found: dict[str, Any] = {}
    if loads is not None and (start.asked or loads.associated.upper is not None):
        found["limit_analysis"] = {key: value for key, value in loads.summary().items() if not key.endswith("seconds")}
    if loads is None:
        return found | {"no_bound": start.why_not}
    if loads.associated.upper is None:
        rests = _where_it_rests(job, search, sim, search.low) if loads.associated.status == FALLS else {}
        return found | (rests or {"no_bound": start.why_not or f"limit analysis says: {loads.associated.status}"})
    bound, resolution = loads.associated.upper, job.case.analysis.resolution
    job.warnings += _clamped(job, search, bound)
    if not is_above(search.low, bound, resolution):
        return found
    moved = _moved(job, search, sim)
    told = {"bound": bound, "displacement": moved.displacement, "bound_where_it_rests": moved.bound}
    explained = moved.bound is not None and not is_above(search.low, moved.bound, resolution)
    job.warnings.append(in_words(search.low, bound, moved, explained))
    return found | {"above_the_bound": told | {"explained": explained}}


def certified(job: CaseJob, search: FailureLoad, sim: Simulation, start: StartBound) -> dict[str, Any]:
    """Hand over the certificates of what a search claims; returns the key of the summary that says which have one.

    sim: that of the search; it is left as it was.
    """
    found = certificates(sim, search, start.known)
    job.clock.certificates(found)
    return {"certificates": found.in_one_line()}


def _where_it_rests(job: CaseJob, search: FailureLoad, sim: Simulation, load: float) -> dict[str, Any]:
    """Return the bound of blocks that rest only after gaps have closed, in their geometry at the load; {}: not known.

    Warns where the load is above it.
    """
    moved = _moved(job, search, sim)
    if moved.bound is None:
        return {}
    found: dict[str, Any] = {"bound_where_it_rests": {"bound": moved.bound, "displacement": moved.displacement}}
    if not is_above(load, moved.bound, job.case.analysis.resolution):
        return found
    job.warnings.append(in_words(load, moved.bound, moved, explained=False))
    told = {"bound": moved.bound, "displacement": moved.displacement, "bound_where_it_rests": moved.bound}
    return found | {"above_the_bound": told | {"explained": False}}


def beside_path(job: CaseJob, sim: Simulation, highest: Carried, lowest: Carried, resolution: float) -> dict[str, Any]:
    """Compare the highest and lowest load multiplier of a cyclic path with their bounds; returns keys of the summary.

    sim: that of the path; it is left as it was. resolution: of loads that are compared with their bounds.
    """
    found: dict[str, Any] = {}
    limits: dict[str, Any] = {}
    for key, sense, carried in (("associated", 1.0, highest), ("associated_back", -1.0, lowest)):
        load, way = sense * carried.load, "" if sense > 0.0 else " against its direction"
        if load <= 0.0:
            continue
        start = StartBound(job, job.model._replace(live_loads=sense * job.model.live_loads))
        bound = None if start.loads is None else start.loads.associated.upper
        if bound is None:
            return {"no_bound": start.why_not}
        limits[key] = sense * bound
        if not is_above(load, bound, resolution):
            continue
        moved = _moved(job, carried, sim, sense)
        explained = moved.bound is not None and not is_above(load, moved.bound, resolution)
        job.warnings.append(in_words(load, bound, moved, explained, f"load {load:.5g}{way}"))
        if found.get("above_the_bound", {"explained": True})["explained"]:  # one that nothing explains counts
            told: dict[str, Any] = {"bound": sense * bound, "displacement": moved.displacement}
            told |= {"bound_where_it_rests": None if moved.bound is None else sense * moved.bound}
            found["above_the_bound"] = told | {"explained": explained}
    return found | ({"limit_analysis": limits} if limits else {})


def is_above(load: float, bound: float, resolution: float) -> bool:
    """Test whether a load lies above its bound by more than the resolution."""
    return load - bound > resolution * abs(bound)


def in_words(load: float, bound: float, moved: Moved, explained: bool, named: str = "") -> str:
    """Return the warning for a load above its bound; explained: by how far blocks had moved.

    named: what load it is, with its value; default: the failure load.
    """
    named = named or f"failure load {load:.5g}"
    if explained:
        return (
            f"the {named} lies above {bound:.5g}, which the geometry of the start can carry at most: "
            f"it is that of blocks that have moved by {moved.displacement:.3g} m"
        )
    there = "" if moved.bound is None else f" ({moved.bound:.5g} where blocks had moved by {moved.displacement:.3g} m)"
    return (
        f"the {named} lies above {bound:.5g}, which no structure of this geometry can carry{there}: "
        "do not trust this run"
    )


def status_beside(status: str, found: dict[str, Any]) -> str:
    """Return the status of a run after the comparison with its bound: an unexplained load is not "ok"."""
    above = found.get("above_the_bound")
    return ABOVE if above is not None and not above["explained"] and status == OK else status


def _clamped(job: CaseJob, search: FailureLoad, bound: float) -> list[str]:
    """Warn where ties or bars may carry more in the associated mechanism, whose joints dilate, than in the run."""
    limits = search.limits
    if not (job.model.links and search.found and limits is not None and limits.slides):
        return []
    if search.carried > (1.0 - job.settings.doubts.clamped) * bound:
        return []
    return [
        f"ties or bars may hold more in the associated load {bound:.5g} than in the run: joints that slide open in it, "
        "which stretches what crosses them; without that, friction alone holds them"
    ]


def _moved(job: CaseJob, search: FailureLoad | Carried, sim: Simulation, sense: float = 1.0) -> Moved:
    """Measure the displacement in the highest equilibrium, and the bound of limit analysis in that geometry.

    sense: 1 or −1, by which live loads are multiplied.
    """
    end = sim.save()
    sim.restore(search.standing)
    try:
        since_start = measures.largest_displacement(sim)
        displacement = max(since_start - search.settled, 0.0)
        return Moved(displacement, _bound_there(job, sim, since_start, sense))
    except UsageError:
        return Moved(displacement, None)
    finally:
        sim.restore(end)


def _bound_there(job: CaseJob, sim: Simulation, displacement: float, sense: float) -> float | None:
    """Compute the associated load multiplier in the displaced geometry of a simulation, on faces as drawn.

    With fixed geometry the joints are those of the start, with the gaps that have closed since. displacement: how far
    blocks have moved since the start, under their dead loads as well [m]; sense: as in `_moved`.
    """
    from dem_cli.core.limit.analysis import load_of_points, load_where_it_rests

    settings, law = job.settings.limit, sim.law
    if sim.kinematics == "fixed":
        model = sim.model._replace(live_loads=sense * sim.model.live_loads)
        return load_of_points(model, sim.joints, sim.measured().gaps <= 0.0, law, settings).upper
    dead, live = sim.present_loads()
    model = sim.model._replace(dead_loads=dead, live_loads=sense * live, links=sim.links)
    touch = 2.0 * measures.largest_overlap(sim), min(WIDEST * sim.smallest, 10.0 * displacement)
    return load_where_it_rests(model, sim.properties, law, sim.bodies, touch, settings).upper
