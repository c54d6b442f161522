"""Cases drawn at random: every generator in 2D and 3D, crossed with what a case may have beside it. A seed is a case.

What is drawn is sound on its face, small, and may stand, fall or be refused: walls with outlines, openings, leaves;
imperfections, loads, pressures, fill, ties, bars, head joints, joint laws, blocks that deform, ground, all analyses.
"""

from __future__ import annotations

from fuzzing.draw import Draw, Tables
from fuzzing.structures import IN_SPACE, STRUCTURES


def joint(d: Draw) -> Tables:
    """A joint of any law, most often of friction alone."""
    friction = {"friction": d.size(0.3, 0.95)}
    bond = {"tension": d.power(3, 5), "cohesion": d.power(5.1, 5.6)}
    energies = {"fracture_energy_tension": 10.0, "fracture_energy_shear": 50.0}
    stiff = {"kn": d.power(8, 11), "ks": d.power(8, 11)}
    softening = {"residual": 0.7, "slip_start": 1e-3, "slip_length": 1e-3}
    laws: list[Tables] = [
        friction | d.some(0.5, softening=softening),
        {"law": "mohr-coulomb", **friction, "cohesion": d.power(3, 5)},
    ]
    laws += [
        {"law": "fracture", **friction, **bond, **energies},
        {"law": "crushing", **friction, "compression": d.power(5.5, 7)},
    ]
    laws += [{"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 28.0}, {"law": "elastic", **stiff}]
    laws += [{"law": "slip-degrading", **friction, "residual": 0.7, "slip_scale": 0.01}]
    laws += [{"law": "rate-dependent", **friction, "friction_dynamic": 0.25, "velocity": 0.05}]
    table = friction if d.random() < 0.85 else d.choice(laws)
    profile = {"sides": d.randint(2, 4), "aperture": 1e-4} | d.some(0.3, over="face") | d.some(0.3, only="bed")
    return (
        table
        | d.some(0.25, **stiff)
        | (d.some(0.05, profile=profile))
        | d.some(0.1, points=d.choice([2, 3, 5]))
        | d.some(0.05, variation=0.1)
    )


def beside(d: Draw, kind: str) -> Tables:
    """Loads, ties, bars and the like on the structure "s" of this kind."""
    on = d.choice([{"structure": "s"}, {"block": "s-*"}, {"at": d.point(d.size(0.0, 0.5), 3.0)}])
    walls = kind in ("wall", "column")
    foot, head = (0.0, 0.0) if kind in ("column", "drums") else (d.size(0.1, 0.4), d.size(0.1, 0.9))
    ends = [d.point(foot, d.size(0.05, 0.2)), d.point(head, d.size(0.3, 0.7))]
    earth = {"density": 1800.0, "level": 0.8, "coefficient": 0.3}
    acts = d.choice([{"uniform": d.size(-500.0, 900.0)}, {"fluid": {"level": 0.6}}, {"earth": earth}])
    error = d.choice(["height", "length", "wedge", "lean", "shift"])
    spread = [0.001, 0.0] if error == "shift" else d.choice([-0.002, [-0.001, 0.001], {"deviation": 0.0003}])
    tie = {"ends": ends, "area": 1e-4, "young": 2e11} | d.some(0.3, yield_force=1e4) | d.some(0.3, prestress=200.0)
    bar = {"area": 1e-4, "young": 2e11, "bond_stiffness": 1e9} | d.some(0.5, bond_strength=4e4)
    quantity = d.choice(["displacement", "rotation", "velocity"])
    monitors = [{"structure": "s", "component": "x"}, {"block": "s-*", "quantity": quantity}]
    tables = d.some(0.35, load=[on | {"force": d.vector(1500.0)} | d.some(0.3, kind="live")])
    pressed = {"structure": "s", "face": d.choice(["+x", "-x", "top", "all"]), **acts} | d.some(0.3, kind="live")
    tables |= d.some(0.2, pressure=[pressed])
    tables |= d.some(0.08, fill=[{"structure": "s", "density": 1800.0, "level": 2.5} | d.some(0.4, coefficient=0.3)])
    held = 0.2 if kind not in ("arch", "bridge", "vault", "temple-front") else 0.03  # where there is a block to hold
    tables |= d.some(held, tie=[tie | d.some(0.1, anchored=True)])
    tables |= d.some(
        0.6 * held, bars={"b": bar | d.some(0.3, yield_stress=4e8)}, reinforcement=[{"bar": "b", "path": ends}]
    )
    tables |= d.some(0.4 if walls else 0.02, imperfection=[{error: spread} | d.some(0.3, restack=False)])
    tables |= d.some(0.1, restraint=[{"structure": "s", "fixed": [d.choice(["x", "rotation"])]}]) | d.some(
        0.1, ground={}
    )
    return tables | d.some(0.3, monitor=monitors[: d.randint(1, 2)]) | d.some(0.4, output={"frames": d.choice([0, 3])})


def analysis(d: Draw) -> Tables:
    """What is computed, with the motion, damping and supports that belong to it."""
    kind = d.choice(["pushover"] * 6 + ["gravity", "cycle", "safety", "modes", "settlement"] + ["time-history"] * 3)
    table: Tables = {"kind": kind} | (
        d.some(0.3, kinematics=d.choice(["fixed", "large", "large"])) if kind != "time-history" else {}
    )
    tables: Tables = {"analysis": table}
    if kind in ("pushover", "cycle", "safety"):
        sideways = [d.choice([1.0, -1.0]), *([d.choice([0.0, 1.0])] if d.space else []), d.choice([0.0, 0.0, 0.2])]
        table |= {"direction": sideways} | d.some(0.35, pattern=d.choice(["tilt", "live"]))
    if kind in ("pushover", "safety"):
        table |= (
            {"resolution": d.choice([0.01, 0.05])} | d.some(0.3, follow=d.size(0.01, 0.1)) | d.some(0.2, limit=True)
        )
    if kind == "pushover":
        table |= d.some(0.1, control="displacement", follow=0.02, increments=10)
    elif kind == "cycle":
        table |= {"path": [0.03, -0.03, 0.0], "step": 0.015}
    elif kind == "settlement":
        tables["settlement"] = [{"block": "s-base*", "displacement": [0.001, *([0.0] if d.space else []), -0.001]}]
    elif kind == "time-history":
        strength = {"amplitude": d.size(0.5, 8.0), "frequency": d.size(2.0, 8.0)}
        motion = d.choice(
            [{"kind": "pulse", "shape": d.choice(["sine", "cosine", "ricker"])}, {"kind": "harmonic", "cycles": 1.0}]
        )
        dampings: list[Tables] = [
            {"restitution": "housner"},
            {"mass": 0.5},
            {"local": 0.3},
            {"stiffness": 1e-5},
            {"none": True},
        ]
        table |= {"duration": d.size(0.03, 0.2), "coda": 0.0} | d.some(0.1, settle=False) | d.some(0.05, repeats=2)
        tables |= {"motion": [motion | strength] if d.random() < 0.9 else [{"kind": "none"}]} | d.some(
            0.5, damping=d.choice(dampings)
        )
        tables |= d.some(0.2, initial=[{"structure": "s", "velocity": [0.1, *([0.0] * (4 if d.space else 1)), 0.0]}])
    return tables


def case(seed: str) -> Tables:
    """The tables of a case."""
    d = Draw(seed)
    d.space = d.random() < 0.4
    kind = d.choice([kind for kind in STRUCTURES if d.space or kind not in IN_SPACE])
    structure = (
        {"kind": kind, "id": "s", "material": "stone"}
        | STRUCTURES[kind](d)
        | d.some(0.04, crack="bond")
        | d.some(0.1, rotation_deg=d.size(-5.0, 30.0))
    )
    stone = {"density": d.size(1500.0, 2800.0)} | d.some(
        0.08, young=d.power(9, 10.5), deformation=d.choice(["joints", "uniform-strain"])
    )
    joints = {"dry": joint(d)}
    bond = {
        "law": "fracture",
        "friction": 0.7,
        "tension": 1e5,
        "cohesion": 2e5,
        "fracture_energy_tension": 10.0,
        "fracture_energy_shear": 50.0,
    }
    joints |= {"bond": bond} if "crack" in structure else {}
    if d.random() < 0.15:
        joints["dry"]["head"] = d.choice(["none", "head"])
        joints |= {"head": {"friction": 0.4}} if joints["dry"]["head"] == "head" else {}
    head: Tables = {"title": seed, "seed": d.randrange(1000)} | ({"dimension": 3} if d.space else {})
    asked, more = analysis(d), beside(d, kind)
    if asked["analysis"].get("pattern") == "live" and d.random() < 0.95:
        more["load"] = [*more.get("load", []), {"structure": "s", "force": d.vector(1500.0), "kind": "live"}]
    return head | {"materials": {"stone": stone}, "joints": joints, "structure": [structure]} | more | asked
