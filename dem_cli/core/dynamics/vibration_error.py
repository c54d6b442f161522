"""Error of elastic vibrations at a time step: drift of their history from that of continuous time.

The explicit step makes of a vibration exp(λ t), λ = −ζω + iω√(1 − ζ²), one with z = exp(λ' Δt) where dashpots act at
the mean velocity of the step:

    (1 + ζωΔt) z² − (2 − ω²Δt²) z + (1 − ζωΔt) = 0

With little damping it is too fast by the share δ = (ωΔt)²/24. Its size is right; its phase drifts by δωt until damping
has forgotten how it began. A free vibration is off by δ/(e ζ) of its first swing at most, one at resonance by δ/ζ, an
undamped one by δωT in a time T.

What a motion makes of each mode is found mode by mode. To an acceleration that is linear between samples an oscillator
answers with what follows it slowly, −a/ω² + 2ζa'/ω³, and with a free vibration that begins anew with every kink and
jump; the derivative of that by λ, times λ' − λ, is the error. Modes count by their displacement in the motion.
Blocks that start displaced or moving vibrate freely, with √(q² + (q'/ω)²) in a mode; where joints would open or slip
by it, what follows is no vibration, and nothing is expected of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.dynamics.frequencies import System, modes, system
from dem_cli.core.dynamics.initial_state import chosen_blocks, pivot_of
from dem_cli.core.geometry.rotation import swept

if TYPE_CHECKING:
    from dem_cli.core.dynamics.time_step import TimeStep
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.records.requests import InitialRequest, ShakingRequest

AIM = 0.8  # of the allowed error, that a step is chosen for
MOST_SAMPLES = 20_000  # of a motion
MOST_TOGETHER = 20  # motions that are worked out at once
MOST_RATIO = 0.9  # of damping that is distinguished: beyond, nothing vibrates
FADES = 200.0  # exponents that a stretch of samples goes through at most: exp of them is a number


class VibrationError(NamedTuple):
    """Vibration mode whose history errs most."""

    share: float = 0.0  # error over the largest displacement of all modes, under the motion that is worst
    frequency: float = 0.0  # of this mode [Hz]


class Swing(NamedTuple):
    """Response of oscillators to ground motions, arrays of (n_motions, n)."""

    largest: np.ndarray  # displacement, at samples and after the end [m]
    vibration: np.ndarray  # that of the free vibration in it [m]
    drift: np.ndarray  # by which its rate λ changes the displacement [m s]


def refined(
    found: TimeStep,
    sim: DynamicSimulation,
    motions: Sequence[Motion],
    duration: float,
    analysis: ShakingRequest,
    initial: Sequence[InitialRequest] = (),
) -> tuple[TimeStep, str]:
    """Refine the time step until elastic vibrations are right; returns it and a warning of what is still wrong, or
    "".

    A step or a margin that is given stays; so does one of joints that are all as stiff as the program chose,
    whose vibration is not the structure's.
    """
    settings = sim.settings.history
    if not (found.held and (motions or initial)) or bool(sim.properties.rigid.all()):
        return found, ""
    error = vibration_error(sim, motions, found.step, duration, initial)
    if error.share <= settings.drift:
        return found, ""
    wanted = functions.agreed(math.sqrt(AIM * settings.drift / error.share))
    if analysis.free_step:
        found = found._replace(step=max(wanted, settings.shortest) * found.step)
        error = error if wanted >= settings.shortest else vibration_error(sim, motions, found.step, duration, initial)
        if wanted >= settings.shortest or error.share <= settings.drift:
            return found, ""
    needed = wanted if not analysis.free_step else wanted / settings.shortest
    margin = min(needed * found.step / found.limit, 0.95)
    return found, (
        f"elastic vibration at {error.frequency:.3g} Hz drifts: its history is off by up to {100.0 * error.share:.2g} "
        f"% of the largest displacement; analysis.margin = {math.floor(1e4 * margin) / 1e4:g} keeps that within "
        f"{100.0 * settings.drift:g} %"
    )


def vibration_error(
    sim: DynamicSimulation,
    motions: Sequence[Motion],
    step: float,
    duration: float,
    initial: Sequence[InitialRequest] = (),
) -> VibrationError:
    """Compute the error of elastic vibrations at the time step, under each motion alone for `duration` [s], and from
    how blocks start.

    Joints that touch now act.
    """
    model, d, count = sim.model, sim.model.dimension, sim.settings.frequency.dense
    springs = system(sim, sim.measured().gaps <= sim.settings.modes.closes * sim.smallest)
    lowest = modes(springs, count if springs.masses.size <= count else sim.settings.history.modes, d, model.n_blocks)
    omegas = 2.0 * math.pi * lowest.frequencies
    omegas, shapes = omegas[omegas > 0.0], lowest.shapes[omegas > 0.0]
    if not len(omegas):
        return VibrationError()
    viscosities = sim.damping.viscosities(model, sim.joints)
    viscosity = float(np.median(viscosities)) if len(viscosities) else 0.0
    ratios = np.minimum(0.5 * (viscosity * omegas + sim.damping.mass / omegas), MOST_RATIO)
    shift, fading = np.abs(rates_at(step, omegas, ratios) - rates_of(omegas, ratios)), ratios * omegas
    worst = VibrationError()
    if (shift * duration <= sim.settings.history.drift * np.maximum(1.0, fading * duration)).all():
        return (
            worst  # whatever the motion is: its drift is no more than the largest vibration × min(duration, 1/fading)
        )
    sizes = np.sqrt((shapes[:, :, :d] ** 2).sum(axis=2)).max(axis=1)
    free = free_vibration(sim, springs, omegas, shapes, initial) if initial else np.zeros(len(omegas))
    largest = float((sizes * free).max())  # 0 where blocks spin about their centroids alone
    if largest > 0.0:
        lasts = np.minimum(duration, np.divide(1.0, fading, out=np.full(len(fading), np.inf), where=fading > 0.0))
        drifts = sizes * free * np.minimum(shift * lasts * functions.exp(-fading * lasts), 2.0)
        k = int(drifts.argmax())
        worst = VibrationError(float(drifts[k]) / largest, float(omegas[k]) / (2.0 * math.pi))
    for times, group in _sampled_alike(motions):
        along = np.array([motion.direction for motion in group])
        ways = sizes * np.abs(np.einsum("knj,n,mj->mk", shapes[:, :, :d], model.masses * ~model.fixed, along))
        values = np.array([motion.acceleration(times) for motion in group])
        swings = swing(values, float(times[1] - times[0]), duration - float(times[-1]), omegas, ratios)
        errors = ways * np.minimum(shift * swings.drift, 2.0 * swings.vibration)
        most = (ways * swings.largest).max(axis=1, keepdims=True)
        shares = np.divide(errors, most, out=np.zeros_like(errors), where=most > 0.0)
        if shares.max() > worst.share:
            k = int(shares.max(axis=0).argmax())
            worst = VibrationError(float(shares.max()), float(omegas[k]) / (2.0 * math.pi))
    return worst


def free_vibration(
    sim: DynamicSimulation,
    springs: System,
    omegas: np.ndarray,
    shapes: np.ndarray,
    initial: Sequence[InitialRequest],
) -> np.ndarray:
    """Compute the amplitudes of modes with which blocks start displaced or moving, (n_modes,), shapes of mass one.

    Zero where joints would not take it: where they may slip, and a block would be accelerated by more than its dead
    loads accelerate it.
    """
    d, states = sim.model.dimension, np.zeros((2, sim.model.n_blocks, springs.masses.shape[1]))
    for one in initial:
        blocks = chosen_blocks(sim.model, one)
        if any(one.turn):
            turn = np.array(one.turn)
            states[0][blocks, :d] += swept(turn, sim.bodies.positions[blocks] - pivot_of(sim, blocks, turn))
            states[0][blocks, d : d + len(turn)] += turn
        states[0][blocks, :d] += one.displacement
        states[1][blocks, : len(one.velocity)] = one.velocity
    scaled = [springs.reduced(each[springs.blocks]) * springs.masses for each in (*states, *shapes)]
    places, speeds = (np.array([float((shape * state).sum()) for shape in scaled[2:]]) for state in scaled[:2])
    found = np.sqrt(places**2 + (speeds / omegas) ** 2)
    joints, none = sim.joints, np.zeros(len(sim.contacts.normal))
    limits = sim.law.shear_limit(joints.law[joints.owners], none, sim.contacts.memory, joints.kn)
    if np.isinf(limits).all():
        return found
    loads = np.sqrt((sim.drawn_dead[:, :d] ** 2).sum(axis=1)) / np.where(sim.model.fixed, np.inf, sim.model.masses)
    each = np.sqrt((shapes[:, :, :d] ** 2).sum(axis=2)) * (found * omegas**2)[:, None]
    return found if (each.sum(axis=0) <= loads).all() else np.zeros(len(omegas))


def _sampled_alike(motions: Sequence[Motion]) -> Iterator[tuple[np.ndarray, list[Motion]]]:
    """Sample times [s], and the motions that have the same ones; so many at once that arrays stay small."""
    groups: dict[tuple[int, float, float], list[Motion]] = {}
    for motion in motions:
        times = motion.times(MOST_SAMPLES)
        groups.setdefault((len(times), float(times[0]), float(times[-1])), []).append(motion)
    for group in groups.values():
        times = group[0].times(MOST_SAMPLES)
        for first in range(0, len(group), MOST_TOGETHER):
            yield times, group[first : first + MOST_TOGETHER]


def rates_of(omegas: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    """Compute λ of oscillators with ω [rad/s] and damping ratios below 1 [1/s], (n,) complex."""
    return omegas * (1j * np.sqrt(1.0 - ratios**2) - ratios)


def rates_at(step: float, omegas: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    """Compute λ of oscillators in explicit steps of `step` [s], whose period is too short: [1/s], (n,) complex."""
    middle, lost = 1.0 - 0.5 * (step * omegas) ** 2, ratios * omegas * step
    z = (middle + 1j * np.sqrt(np.maximum(1.0 - lost**2 - middle**2, 0.0))) / (1.0 + lost)
    return (functions.log(np.abs(z)) + 1j * functions.arctan2(z.imag, z.real)) / step


def swing(values: np.ndarray, step: float, rest: float, omegas: np.ndarray, ratios: np.ndarray) -> Swing:
    """Compute the exact response of oscillators with ω [rad/s] and damping ratios to ground motions that rest
    after their end.

    values: acceleration [m/s²], linear between samples `step` [s] apart, (n_motions, n_samples); rest: time after [s].
    """
    count, fading, rates = values.shape[1], ratios * omegas, rates_of(omegas, ratios)
    slopes = np.zeros_like(values)
    slopes[:, :-1] = np.diff(values, axis=1) / step
    kinks, jumps = np.diff(slopes, axis=1, prepend=0.0)[:, None], np.zeros_like(values)[:, None]
    jumps[:, 0, 0], jumps[:, 0, -1] = values[:, 0], -values[:, -1]
    square, cube, turns = omegas[:, None] ** 2, omegas[:, None] ** 3, rates.imag[:, None]
    late = jumps / square - 2.0 * ratios[:, None] * kinks / cube  # what is missing of rest there: of the displacement
    given = (kinks / square + fading[:, None] * late) / turns + 1j * late
    quiet = 2.0 * ratios[:, None] * slopes[:, None] / cube - values[:, None] / square
    held, turned = np.zeros((2, len(values), len(omegas)), complex)
    largest, most, drift = np.zeros((3, len(values), len(omegas)))
    length = max(1, int(min(count, FADES / max(float(fading.max()) * step, 1e-300))))
    on = np.exp(rates * step)
    for first in range(0, count, length):
        now = slice(first, min(first + length, count))
        since = step * np.arange(now.stop - first)
        grows = np.exp(rates[:, None] * since)
        parts = given[:, :, now] / grows
        before = held[:, :, None] + np.cumsum(parts, axis=2)
        vibration = before * grows
        turning = (turned[:, :, None] + since * before - np.cumsum(parts * since, axis=2)) * grows
        largest = np.maximum(largest, np.abs(vibration.imag + quiet[:, :, now]).max(axis=2))
        most = np.maximum(most, np.abs(vibration).max(axis=2))
        drift = np.maximum(drift, np.abs(turning).max(axis=2))
        held, turned = vibration[:, :, -1] * on, (turning[:, :, -1] + step * vibration[:, :, -1]) * on
    size, way, rest = np.abs(vibration[:, :, -1]), np.abs(turning[:, :, -1]), max(rest, 0.0)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # the drift is largest where its rate fades as fast as it grows
        later = np.nan_to_num(np.where(fading > 0.0, 1.0 / fading - way / size, rest), posinf=rest, neginf=0.0)
    later = np.clip(later, 0.0, rest)
    drift = np.maximum(drift, (way + later * size) * functions.exp(-fading * later))
    return Swing(np.maximum(largest, size), most, drift)
