"""What is said and drawn of each law."""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.laws.registry import LAWS
from dem_cli.core.laws.softening import FRICTION_SOFTENING
from studies.laws.driven_point import Graph, LawPage, Panel, pulled, slid, three_paths, through
from studies.laws.peperino import (
    KG_PER_CM2,
    LOWEST,
    PEPERINO,
    RATIO,
    ROUGH,
    SLID,
    TABLE_5_1,
    barton,
    barton_numbers,
    degrading_numbers,
    scale_for,
)

NORMAL, GAP, RATIO_AXIS = "normal stress [kPa]", "gap [µm]", "shear / normal stress [-]"


def coulomb(page: LawPage) -> list[Panel]:
    gap, normal, _ = pulled(page, -20e-6, 15e-6, -20e-6)
    corner = page.along(through((0, 0, 0), (-10e-6, 0, 0), (-10e-6, 80e-6, 0), (-10e-6, 80e-6, 80e-6)))
    return [
        Panel("Pressed and opened", GAP, NORMAL, [Graph(gap * 1e6, normal * 1e-3)]),
        three_paths(page, 1e5, 80e-6, "Slid under 100 kPa"),
        Panel("Slid round a corner", "slide [µm]", "shear stress [kPa]", [
            Graph(corner.path[400:, 1:].sum(axis=1) * 1e6, -corner.shear[400:, 0] * 1e-3, "along the first way"),
            Graph(corner.path[400:, 1:].sum(axis=1) * 1e6, -corner.shear[400:, 1] * 1e-3, "along the second", "red"),
            Graph(corner.path[400:, 1:].sum(axis=1) * 1e6, np.linalg.norm(corner.shear[400:], axis=1) * 1e-3, "size",
                 "grey", "--"),
        ]),
    ]  # fmt: skip


def softening(page: LawPage) -> list[Panel]:
    one, force, _ = slid(page, 1e5, 1.5e-3)
    both, back, done = slid(page, 1e5, 0.4e-3, -0.4e-3, 0.4e-3, n=2000)
    thesis = Graph([0, 0.9, 1.0, 1.5], [0.6, 0.6, 0.48, 0.48], "μ of the slip", "grey", "-", 5.0)
    return [
        Panel("Slid under 100 kPa", "slide [mm]", RATIO_AXIS,
              [thesis, Graph(one * 1e3, force * 1e-5, "answer", "blue")], legend="lower left"),
        Panel("To and fro", "slide [mm]", RATIO_AXIS, [Graph(both * 1e3, back * 1e-5, arrows=(0.1, 0.5, 0.9))]),
        Panel("The same over the slip", "path of the slip [mm]", RATIO_AXIS,
              [thesis, Graph(done.slip[1999:] * 1e3, np.abs(back) * 1e-5, "answer, its size")], legend="lower left"),
    ]  # fmt: skip


def mohr_coulomb(page: LawPage) -> list[Panel]:
    gap, normal, _ = pulled(page, 15e-6, -10e-6, 10e-6)
    lines = []
    for stress, colour in ((3e5, "ink"), (1e5, "blue"), (0.0, "red")):
        slide, shear, _ = slid(page, stress, 200e-6, -50e-6, keys={"dilation_deg": 0.0})
        lines.append(Graph(slide * 1e6, shear * 1e-3, f"{stress * 1e-3:g} kPa", colour))
    slide, _, done = slid(page, 1e5, 0.6e-3, -0.6e-3, n=2000)
    tangent = math.tan(math.radians(page.keys["dilation_deg"]))
    opening = tangent * np.minimum(np.abs(done.memory[1999:, 2]), page.keys["dilation_slip"])
    return [
        Panel("Pulled, then pressed and pulled", GAP, NORMAL, [Graph(gap * 1e6, normal * 1e-3, arrows=(0.06, 0.45))]),
        Panel("Slid and reversed, ψ = 0", "slide [µm]", "shear stress [kPa]", lines),
        Panel("Opening by dilation", "slide [mm]", "opening [µm]",
              [Graph(slide * 1e3, opening * 1e6, arrows=(0.15, 0.4, 0.6, 0.8))]),
    ]  # fmt: skip


def barton_panels(page: LawPage) -> list[Panel]:
    stresses = np.geomspace(100.0, 1e8, 200)
    stress, mean, scatter = np.array(TABLE_5_1).T
    lines = []
    for at, colour in ((4e4, "ink"), (2e4, "blue"), (5e3, "red")):
        slide, shear, _ = slid(page, at, 20e-6, -20e-6)
        lines.append(Graph(slide * 1e6, shear / at, f"{at * 1e-3:g} kPa", colour))
    wide = np.geomspace(1.0, 1e9, 300)
    return [
        Panel("Friction and stress", "normal stress [kPa]", "tan φ [-]", [
            Graph(stresses * 1e-3, [barton(s) for s in stresses], "law"),
            Graph(stress * KG_PER_CM2 * 1e-3, mean, "thesis Table 5-1", "red", points=True, scatter=scatter),
        ], log=True),
        Panel("Slid and reversed", "slide [µm]", RATIO_AXIS, lines),
        Panel("JRC = 15, JCS = 100 MPa, φr = 30°", "normal stress [kPa]", "φ [deg]", [
            Graph(wide * 1e-3, [math.degrees(math.atan(barton(s, **ROUGH))) for s in wide]),
        ], log=True),
    ]  # fmt: skip


def degrading(page: LawPage) -> list[Panel]:
    one, force, _ = slid(page, 1e4, 0.5)
    back, both, _ = slid(page, 1e4, 0.05, -0.05, 0.05, -0.05, n=1000)
    slips = np.linspace(0.0, 0.5, 300)
    curves = [
        Graph(
            100 * slips,
            r + (1 - r) * np.exp(-slips / scale_for(r)),
            f"r = {r:g}, S0 = {1e3 * scale_for(r):.0f} mm",
            colour,
        )
        for r, colour in ((0.0, "grey"), (LOWEST, "blue"), (0.67, "green"))
    ]
    return [
        Panel("Slid one way", "slide [cm]", RATIO_AXIS, [Graph(one * 1e2, force * 1e-4)]),
        Panel("To and fro", "slide [cm]", RATIO_AXIS, [Graph(back * 1e2, both * 1e-4, arrows=(0.1, 0.4, 0.6, 0.9))]),
        Panel("Curves through the tests", "slip [cm]", "friction / first friction [-]", [
            *curves,
            Graph([100 * SLID], [RATIO], "mean of 5 pairs", "red", points=True),
            Graph([100 * SLID], [LOWEST], "lowest pair", "orange", points=True),
        ]),
    ]  # fmt: skip


def rate(page: LawPage) -> list[Panel]:
    step, static, dynamic, vc = 1e-4, page.keys["friction"], page.keys["friction_dynamic"], page.keys["velocity"]
    lines, speeds, found = [], np.array([0.02, 0.1, 0.3, 1.0, 2.0, 4.0]) * vc, []
    for speed in speeds:
        n = int(60e-6 / (speed * step)) + 5
        slide, shear, _ = slid(page, 1e5, speed * step * n, n=n, step=step)
        found.append(shear[-1] * 1e-5)
        if speed / vc in (0.1, 1.0, 4.0):
            lines.append(
                Graph(slide * 1e6, shear * 1e-5, f"{speed:g} m/s", {0.1: "ink", 1.0: "blue", 4.0: "red"}[speed / vc])
            )
    v = np.linspace(0.0, 4.2 * vc, 200)
    cycle = np.cumsum(step * vc * 3 * np.sin(np.linspace(0.0, 4 * np.pi, 2000)))
    swing = page.along(np.concatenate([[(-10e-6, 0.0)], np.column_stack([np.full(2000, -10e-6), cycle])]), step=step)
    return [
        Panel("Friction and speed", "speed [m/s]", "tan φ [-]", [
            Graph(v, dynamic + (static - dynamic) * np.exp(-v / vc), "law"),
            Graph(speeds, found, "steady slip, driven", "red", points=True),
        ]),
        Panel("Slid at constant speed", "slide [µm]", RATIO_AXIS, lines, legend="lower right"),
        Panel("Swung, at most 0.03 m/s", "slide [mm]", RATIO_AXIS,
              [Graph(swing.path[1:, 1] * 1e3, -swing.shear[1:, 0] * 1e-5, arrows=(0.2, 0.4, 0.7, 0.9))]),
    ]  # fmt: skip


def crushing(page: LawPage) -> list[Panel]:
    gap, normal, _ = pulled(page, -3e-3, -1.0e-3, -4e-3, -2e-3)
    path = through((0.0, 0.0), (-0.4e-3, 0.0), (-0.4e-3, 1.5e-3), (-2.5e-3, 5e-3), n=500)
    done = page.along(path)
    fc, mu = page.keys["compression"] * 1e-6, page.keys["friction"]
    return [
        Panel("Pressed, unloaded, pressed further", "gap [mm]", "normal stress [MPa]",
              [Graph(gap * 1e3, normal * 1e-6, arrows=(0.05, 0.18, 0.29, 0.42, 0.79, 0.92))]),
        Panel("Slid while pressed harder", "normal stress [MPa]", "shear stress [MPa]", [
            Graph([0, fc, fc], [0, mu * fc, 0], "limit", "grey", "-", 5.0),
            Graph(done.normal * 1e-6, -done.shear[:, 0] * 1e-6, "answer", arrows=(0.15, 0.5, 0.75)),
        ], legend="upper left"),
    ]  # fmt: skip


def elastic(page: LawPage) -> list[Panel]:
    gap, normal, _ = pulled(page, -20e-6, 20e-6)
    later, pressed, _ = pulled(page, -20e-6, 20e-6, touches=False)
    slide, shear, _ = slid(page, 1e5, 80e-6, -80e-6)
    return [
        Panel("Pressed and pulled", GAP, NORMAL, [
            Graph(later * 1e6, pressed * 1e-3, "points that meet later", "grey", "-", 5.0),
            Graph(gap * 1e6, normal * 1e-3, "joined at the start"),
        ]),
        Panel("Slid and reversed", "slide [µm]", "shear stress [kPa]", [Graph(slide * 1e6, shear * 1e-3)]),
    ]  # fmt: skip


def fracture(page: LawPage) -> list[Panel]:
    wide, far = 300e-6, 1.5e-3
    one, straight, _ = pulled(page, wide, n=3000)
    gap, normal, _ = pulled(page, 40e-6, -3e-6, 120e-6, -3e-6, wide, n=3000)
    lines = []
    for stress, colour in ((3e5, "ink"), (1e5, "blue"), (0.0, "red")):
        slide, shear, _ = slid(page, stress, 0.7 * far, -0.7 * far, n=3000)
        lines.append(Graph(slide * 1e3, shear * 1e-3, f"{stress * 1e-3:g} kPa", colour, arrows=(0.3,)))
    opened = np.linspace(0.0, 250e-6, 6)
    strengths = []
    for width in opened:
        path = through((0.0, 0.0), (width, 0.0), (-1e-6, 0.0), (-1e-6, 60e-6), n=1500)
        done = page.along(path)
        strengths.append(np.max(-done.shear[:, 0] - page.keys["friction"] * np.maximum(done.normal, 0.0)) * 1e-3)
    ft, c, energy = page.keys["tension"], page.keys["cohesion"], page.keys["fracture_energy_tension"]
    w = np.linspace(0.0, 250e-6, 200)
    return [
        Panel("Pulled and unloaded", GAP, "tension [kPa]", [
            Graph(gap * 1e6, -normal * 1e-3, "with unloading", "grey", "-", 4.0, (0.25, 0.5, 0.72)),
            Graph(one * 1e6, -straight * 1e-3, "one way"),
        ]),
        Panel("Slid and reversed", "slide [mm]", "shear stress [kPa]", lines),
        Panel("Cohesion left after opening", "largest gap [µm]", "cohesion [kPa]", [
            Graph(w * 1e6, c * np.exp(-ft / energy * w) * 1e-3, "c exp(−ft w / G_I)"),
            Graph(opened * 1e6, strengths, "opened, closed, slid", "red", points=True),
        ]),
    ]  # fmt: skip


PAGES = (
    LawPage(LAWS["coulomb"], {"friction": 0.6}, 1e10, 4e9, coulomb),
    LawPage(
        FRICTION_SOFTENING,
        {"friction": 0.6, "softening": {"residual": 0.8, "slip_start": 0.0009, "slip_length": 0.0001}},
        1e10, 4e9, softening, chosen='`law = "coulomb"` with `softening`',
    ),
    LawPage(
        LAWS["mohr-coulomb"],
        {"friction": 0.75, "cohesion": 4e5, "tension": 2e5, "dilation_deg": 10.0, "dilation_slip": 3e-4},
        2e10, 8e9, mohr_coulomb,
    ),
    LawPage(LAWS["barton"], PEPERINO, 1e10, 4e9, barton_panels, barton_numbers),
    LawPage(
        LAWS["slip-degrading"],
        {"friction": 0.6, "residual": LOWEST, "slip_scale": round(scale_for(LOWEST), 3)},
        1e10, 4e9, degrading, degrading_numbers,
    ),
    LawPage(LAWS["rate-dependent"], {"friction": 0.6, "friction_dynamic": 0.45, "velocity": 0.01}, 1e10, 4e9, rate),
    LawPage(LAWS["crushing"], {"friction": 0.6, "compression": 8e6}, 1e10, 4e9, crushing),
    LawPage(
        LAWS["fracture"],
        {
            "friction": 0.75, "tension": 2.5e5, "cohesion": 3.5e5,
            "fracture_energy_tension": 18.0, "fracture_energy_shear": 125.0,
        },
        8.2e10, 3.6e10, fracture,
    ),
    LawPage(LAWS["elastic"], {}, 1e10, 4e9, elastic),
)  # fmt: skip
