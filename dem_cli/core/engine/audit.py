"""Audit of a run: energy that does not close, blocks too light or joints too uneven, and what to do about it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.core.contact.block_compliance import block_compliance
from dem_cli.core.contact.layout import SECTION
from dem_cli.core.engine import measures
from dem_cli.core.engine.automatic_stiffness import ratio_of
from dem_cli.core.engine.measures import closure, free_falls, reweighting_shares
from dem_cli.core.model.scales import WEIGHTLESS, own_weights

if TYPE_CHECKING:
    from dem_cli.core.contact.block_compliance import BlockCompliance
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.records.requests import SolverRequest


def warnings(request: SolverRequest, sims: list[Simulation], found: dict[str, Any]) -> list[str]:
    """Warn of doubts about the answer `found`, the worst first; where there is none, say how to get one."""
    said, doubts = [], sims[0].settings.doubts
    worst = max((closure(sim) for sim in sims), key=abs)
    overlap = max(measures.largest_overlap(sim) / sim.smallest for sim in sims)
    overlap = max(overlap, (found.get("largest_overlap") or 0.0) / sims[0].smallest)  # of all of a motion
    if abs(worst) > doubts.closure:
        advice = "lower analysis.margin" if request.in_seconds else "do not trust this run"
        said.append(f"the energy does not close: {worst:.2%} is missing; {advice}")
    if overlap > doubts.overlap:
        crushes = any(getattr(joint, "compression", None) is not None for joint in request.joints.named.values())
        why = "stone that is crushed, beside what joints give" if crushes else "the joints are too soft"
        said.append(f"blocks overlap by {overlap:.1%} of the smallest edge: {why}")
    elif overlap > doubts.rigid_overlap and sims[0].takes_back and not sims[0].properties.given:
        said.append(f"rigid blocks overlap by {overlap:.1%} of the smallest edge: do not trust this run")
    said += _reweighted(request, sims)
    said += (
        _leaning_automatically(request, sims[0])
        + weightless(sims[0])
        + _shear(sims[0])
        + _lumped(sims[0])
        + unbending(request, sims[0])
        + _cracking(request, sims[0])
        + _leaning(request, sims[0], found.get("displacement_at_failure"))
    )
    if found.get("status") == "not converged":
        said.append(_advice(request, sims[0], found))
    return said


def _reweighted(request: SolverRequest, sims: list[Simulation]) -> list[str]:
    """Warn of energy that came or went as sliding blocks changed the areas of contact points."""
    net, total = max((reweighting_shares(sim) for sim in sims), key=max_of)
    allowed = sims[0].settings.doubts.reweighted
    if max_of((net, total)) <= allowed:
        return []
    way = "made" if net < 0.0 else "took"
    of = "largest kinetic energy" if sims[0].most_kinetic > 0.0 else "energy that moved"
    advice = "lower analysis.margin, or stiffen joints" if request.in_seconds else "stiffen joints"
    return [
        f"the areas of contact points {way} {abs(net):.1%} of the {of} as they changed, all amounts together "
        f"{total:.1%}: {advice}"
    ]


def max_of(shares: tuple[float, float]) -> float:
    """Return the larger of a net amount by size and of the sum of all amounts."""
    return max(abs(shares[0]), shares[1])


def weightless(sim: Simulation) -> list[str]:
    """Warn of the first block whose own loads are lost beside those of the others, by which equilibrium is judged."""
    dead, live = sim.model.dead_loads[sim.free], sim.loads.live[sim.free]
    d = sim.model.dimension
    light = np.flatnonzero(np.sqrt((dead[:, :d] ** 2).sum(axis=1)) < own_weights(dead, live, d))
    if not len(light):
        return []
    more = f" (and {len(light) - 1} more)" if len(light) > 1 else ""
    name = sim.model.block_ids[sim.free[light[0]]]
    return [f"the weight of block '{name}'{more} is below {WEIGHTLESS:g} of the mean: its equilibrium is not proven"]


def unproven(request: SolverRequest, sim: Simulation) -> bool:
    """Test whether some block of a static analysis is too light beside others to prove anything about it."""
    weighs = bool(sim.loads.dead[sim.free, : sim.model.dimension].any())
    return weighs and not request.in_seconds and bool(weightless(sim))


def _shear(sim: Simulation) -> list[str]:
    """Warn of a ratio ks/kn outside the usual range; "auto" joints have ks = kn."""
    properties = sim.properties
    ratios = properties.ks / properties.kn
    low, high = sim.settings.doubts.shear_low, sim.settings.doubts.shear_high
    return [
        f"ks/kn = {ratio:.3g} of joint '{name}' is outside {low:g} to {high:g}: sudden sliding may have "
        "lowered the load by some per cent"
        for name, ratio in zip(properties.names, ratios)
        if not low * (1 - 1e-9) <= ratio <= high * (1 + 1e-9)
    ]


def _lumped(sim: Simulation) -> list[str]:
    """Warn of joints that are stiff beside the blocks whose deformation they carry: bending and bulging are lost."""
    return [
        f"blocks deform {times}: lumped into the joints they give way too much, by some 2 % at 0.4 times, 3 % at 1, "
        "6 % at 3"
        for times in _stiff_beside(sim, sim.properties.compliance, sim.settings.doubts.lumped)
    ]


def unbending(request: SolverRequest, sim: Simulation) -> list[str]:
    """Warn of joints that are stiff beside blocks of uniform strain, which do not bend."""
    free = np.repeat(sim.properties.rigid[:, None], 2, axis=1)
    compliance = block_compliance(sim.model, np.repeat(request.joints.uniform[:, None], 2, axis=1), free)
    return [
        f"blocks of uniform strain deform {times}: they do not bend, and give way too little: walls by "
        "some 2 % at 0.1 times, 4 % at 0.4, 9 % at 3; what bends and is few blocks wide by 8, 27 and 70 %, where "
        "deformation = 'joints', the default, is right within 0.3 %"
        for times in _stiff_beside(sim, compliance, sim.settings.doubts.unbending)
    ]


def _stiff_beside(sim: Simulation, compliance: BlockCompliance | None, least: float) -> list[str]:
    """Describe joints that are more than `least` times as stiff as their blocks, and by how many times."""
    if compliance is None:
        return []
    shares, named = measures.shares_of_blocks(sim, compliance), sim.properties.between(sim.model, sim.joints.blocks)
    said = []
    for k, name in enumerate(sim.properties.names):
        share = float(np.median(shares[named == k])) if (named == k).any() else 0.0
        if share > least:
            times = f"{share:.2g} times as much as" if np.isfinite(share) else "and nothing else does at"
            said.append(f"{times} joint '{name}' (kn h/E)")
    return said


class _Worth(NamedTuple):
    """Bending strength of a joint with few points over that of its whole section, about the side of a rectangle."""

    cracked: float  # brittle in tension, at most, at any normal force
    crushed: tuple[float, float]  # perfectly plastic in compression, from 1/20 to 19/20 of what crushes it


# By points along a joint at Gauss-Lobatto places; corners and centre are as three (docs/numerics.md).
WORTH = {
    2: _Worth(3.0, (1.06, 2.0)), 3: _Worth(2.33, (0.67, 1.19)), 4: _Worth(1.48, (0.84, 1.08)),
    5: _Worth(1.26, (0.9, 1.04)), 6: _Worth(1.18, (0.94, 1.03)), 7: _Worth(1.13, (0.95, 1.02)),
    8: _Worth(1.1, (0.97, 1.01)), 9: _Worth(1.08, (0.98, 1.01)),
}  # fmt: skip
NINE = _Worth(1.35, (0.87, 1.15))  # in space, points = 3


def _cracking(request: SolverRequest, sim: Simulation) -> list[str]:
    """Warn of joints that crack or crush at so few points that their bending strength is not that of a section."""
    space, found = sim.contacts.shear.shape[1] == 2, []
    for name, layout in zip(sim.properties.names, sim.properties.plane, strict=True):
        if layout.points == SECTION:
            continue
        worth = (
            NINE
            if space and layout.points == 3 and not layout.centred
            else WORTH[3 if layout.centred else layout.points]
        )
        joint, how = request.joints.named[name], []
        if getattr(joint, "tension", 0.0) > 0.0:
            how.append(f"where it cracks up to {worth.cracked:g} times")
        if getattr(joint, "compression", None) is not None:
            how.append(f"where it is crushed {worth.crushed[0]:g} to {worth.crushed[1]:g} times")
        if how and joint.profile is None:
            found.append(
                f"joint '{name}' has few points: in bending it carries {' and '.join(how)} what a joint does that goes "
                'bit by bit; points = "section" is within 1 %'
            )
    return found


def _leaning_automatically(request: SolverRequest, sim: Simulation) -> list[str]:
    """Warn where even "auto" joints as stiff as round-off allows let a structure lean noticeably."""
    if sim.kinematics == "fixed":
        return []
    resolution = request.analysis.resolution
    allowed = sim.settings.doubts.buckles if sim.takes_back else resolution
    if allowed is None or sim.leans <= allowed:
        return []
    return [
        f'"auto" joints are as stiff as round-off allows (kn·h/W {ratio_of(sim):.2g}), and the structure leans over '
        f"them all the same: that alone may lower its load by {min(sim.leans, 1.0):.0%}; do not trust this run"
    ]


def _leaning(request: SolverRequest, sim: Simulation, moved: float | None) -> list[str]:
    """Warn of a load on soft joints, where large displacements are given and stiff joints were not tried.

    A block that rocks on a face without tension carries b/h (1 − 2c/3b − hθ/b), which is largest where c = 3hθ: its
    centre has then moved by u = hθ/2, and 6 u/b of the load is lost. Points at the ends of a joint lose u/b alone.
    """
    if request.analysis.kinematics != "large" or not sim.properties.given or moved is None:
        return []
    share = moved / float(np.median(sim.widths[sim.free]))
    doubts = sim.settings.doubts
    if share <= (doubts.leans_pressed if sim.integrates else doubts.leans):
        return []
    return [
        f"with the given kn blocks move {share:.2g} of their width before failure: the failure load may differ from "
        "that of blocks on stiff joints by more than 0.5 %"
    ]


def _known(found: dict[str, Any]) -> str:
    """Describe what is known of a failure load that was not found: neither side of so wide a bracket is one."""
    low, high = found.get("failure_load_bracket", [None, None])
    bound = found.get("limit_analysis", {}).get("associated")
    if low is None and high is None:
        return "no equilibrium was proven"
    parts = ["no equilibrium was proven" if low is None else f"it stands at {low:.5g}"]
    if high is not None and "proof_of_failure" in found:
        parts.append(f"it did not come to rest at {high:.5g}")
    if bound is not None:
        parts.append(f"by limit analysis it carries no more than {bound:.5g}")
    if undecided := found.get("undecided_loads"):
        parts.append(f"{len(undecided)} loads in between neither came to rest nor failed")
    return "the failure load was not found: " + ", ".join(parts)


def _advice(request: SolverRequest, sim: Simulation, found: dict[str, Any]) -> str:
    """Describe what is known and what may be done where a search ended without an answer."""
    known = _known(found)
    weightless = not sim.loads.dead[sim.free].any()
    ways = ["give the blocks weight, or dead loads: nothing presses them together"] if weightless else []
    ways.append(f"raise analysis.max_steps ({request.analysis.max_steps:,})")
    if request.analysis.resolution is not None:
        ways.append(f"accept a wider bracket (analysis.resolution {request.analysis.resolution:g})")
    fall, ids = free_falls(sim)[sim.free], sim.model.block_ids
    fastest = fall.max(initial=0.0)
    slow = np.flatnonzero((fall > 0.0) & (fall * sim.settings.doubts.uneven < fastest))
    if len(slow):
        slowest = slow[fall[slow].argmin()]
        ways.append(
            f"make joints or weights more alike: block '{ids[sim.free[slowest]]}' is "
            f"{fastest / fall[slowest]:.0e} times as slow as '{ids[sim.free[fall.argmax()]]}'"
        )
    return f"not converged: {known}; " + "; or ".join(ways)
