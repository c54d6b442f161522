"""Joint stiffness over 8 decades, ks/kn over 6, stiffness ratios between joints, and thesis 5.3.3."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from studies.stress.structures import StressScene, explicit, named, stiffness_unit
from studies.stress.verdicts import StressRecord, load_record, push

KINEMATICS = ("auto", "fixed", "large")


def joint_stiffness(short: bool) -> Iterator[StressRecord]:
    """Given kn with kn·h/W from 1e2 to 1e10, ks = kn, for every kinematics."""
    scenes = named()
    chosen = ("rock", "wall 0.6") if short else ("slide", "rock", "column", "wall 0.6", "wall 0.75", "arch")
    for name in chosen:
        scene, unit = scenes[name].having("analysis.max_steps", 500_000), stiffness_unit(scenes[name])
        for kinematics in ("auto",) if short else KINEMATICS:
            for decade in (3, 6, 9) if short else range(2, 11):
                stiff = scene.joint(kn=unit * 10.0**decade).having("analysis.kinematics", kinematics)
                yield load_record("joint stiffness", stiff, f"1e{decade}", variant=kinematics)


def shear_stiffness(short: bool) -> Iterator[StressRecord]:
    """ks/kn at kn·h/W = 1e6 and 1e8; auto takes fixed geometry there."""
    scenes = named()
    chosen = ("column",) if short else ("column", "wall 0.5", "wall 0.6", "wall 0.75", "arch", "arch 0.4", "portal")
    for name in chosen:
        scene, unit = scenes[name].having("analysis.max_steps", 500_000), stiffness_unit(scenes[name])
        for kinematics, kn in (("fixed", 1e6),) if short else (("fixed", 1e6), ("large", 1e8)):
            for decade in (-1, 1) if short else range(-3, 4):
                given = scene.joint(kn=unit * kn, ks=unit * kn * 10.0**decade)
                given = given.having("analysis.kinematics", kinematics)
                yield load_record("shear over normal stiffness", given, f"1e{decade}", variant=kinematics)


def mixed(scene: StressScene, weak: float, strong: float) -> StressScene:
    """Every third block of another material; joints between like blocks are `strong`, all others `weak`."""
    scene = explicit(scene)
    materials = list(scene.tables["materials"].values())
    joint = next(iter(scene.tables["joints"].values()))
    blocks = [{**b, "material": f"m{i % 3 // 2}"} for i, b in enumerate(scene.tables["block"])]
    interface = [{"between": [m, m], "joint": "strong"} for m in ("m0", "m1")]
    tables = {
        **scene.tables, "materials": {"m0": materials[0], "m1": materials[0]}, "block": blocks,
        "joints": {"weak": {**joint, "kn": weak}, "strong": {**joint, "kn": strong}}, "interface": interface,
    }  # fmt: skip
    return replace(scene, tables=tables)


def stiffness_ratio(short: bool) -> Iterator[StressRecord]:
    """Some joints of kn·h/W = 1e6, others up to a million times stiffer or softer."""
    scenes = named()
    for name in ("wall 0.6",) if short else ("column", "trilith", "wall 0.6", "wall 0.75", "arch"):
        scene, unit = scenes[name].having("analysis.max_steps", 500_000), stiffness_unit(scenes[name])
        for decade in (3,) if short else (-6, -4, -2, 2, 4, 6):
            given = mixed(scene, unit * 1e6, unit * 10.0 ** (6 + decade))
            yield load_record("stiffness ratio between joints", given, f"1e{decade}")


BASE = 1e8  # kn·h/W of the stone of the thesis: joints about as stiff as the blocks, E/h
THESIS = {  # what is changed: factor of kn, factor of density, ks/kn
    "stiffness × 1e-2": (1e-2, 1.0, 1.0),
    "stiffness × 1e-4": (1e-4, 1.0, 1.0),
    "masses × 1e2": (1.0, 1e2, 1.0),
    "masses × 1e4": (1.0, 1e4, 1.0),
    "stiffness × 1e-2, masses × 1e2": (1e-2, 1e2, 1.0),
    "ks/kn = 0.1": (1.0, 1.0, 0.1),
    "ks/kn = 0.01": (1.0, 1.0, 0.01),
    "ks/kn = 10": (1.0, 1.0, 10.0),
    "ks/kn = 100": (1.0, 1.0, 100.0),
}


def thesis(short: bool) -> Iterator[StressRecord]:
    """The 21-block wall of the thesis: first its error, then changes against it, below 1 % or with a warning."""
    scenes = named()
    chosen = ("wall 0.6",) if short else ("wall 0.5", "wall 0.6", "wall 0.65", "wall 0.7", "wall 0.75", "wall 1.0")
    for name in chosen:
        scene, unit = scenes[name], stiffness_unit(scenes[name])
        for kinematics in ("auto",) if short else ("auto", "large"):
            case = scene.having("analysis.kinematics", kinematics)
            given = case.joint(kn=unit * BASE, ks=unit * BASE)
            base = push(given)
            yield load_record("thesis 5.3.3", given, "as in the thesis", variant=kinematics)
            if base.load is None:
                continue
            for what, (stiffness, masses, ratio) in list(THESIS.items())[:: 4 if short else 1]:
                kn = unit * BASE * stiffness
                changed = case.joint(kn=kn, ks=kn * ratio).material(density=masses)
                changed = replace(changed, exact=(base.load, base.load))
                yield load_record("thesis 5.3.3", changed, what, variant=kinematics, within=0.01)
