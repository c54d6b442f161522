"""The dynamic oracles against closed forms and against each other; nothing of dem_cli is run."""

from __future__ import annotations

import numpy as np
import pytest
from oracle import bouncing, housner, newmark_slider, rocking_frame, two_blocks
from oracle.base_motion import Record, Sine, pulse, rectangle
from oracle.housner import Block
from reference import result
from scipy.integrate import quad, solve_ivp
from scipy.linalg import block_diag
from scipy.optimize import brentq
from scipy.special import ellipk, ellipkinc

ASPECTS = [2.0, 2.9, 3.6, 5.0]
SLENDER = Block.of(alpha=1e-3, p=2.0)  # the linearised block, but for 1e-6


@pytest.mark.parametrize("motion", [pulse(2.0, 1.5), pulse(-1.0, 3.0, 0.5, 0.4), rectangle(3.0, 0.7)])
def test_integrals_of_pulses(motion):
    for t in (0.1, 0.3, 0.65, 1.0, 3.0):
        inside = min(t, motion.duration)
        moved = quad(motion.velocity, 0.0, inside, epsabs=1e-13)[0] + motion.velocity(t) * (t - inside)
        assert motion.velocity(t) == pytest.approx(quad(motion.acceleration, 0.0, inside, epsabs=1e-13)[0], abs=1e-12)
        assert motion.displacement(t) == pytest.approx(moved, abs=1e-12)


def test_integrals_of_records():
    record = Record(0.02, np.random.default_rng(1).normal(size=40))
    for t in (0.013, 0.02, 0.41, 0.78, 1.5):
        inside = min(t, record.duration)
        fine = np.unique(np.concatenate([np.linspace(0.0, inside, 200_001), record.breaks[record.breaks <= inside]]))
        assert record.velocity(t) == pytest.approx(np.trapezoid(record.acceleration(fine), fine), abs=1e-12)
        moved = np.trapezoid(record.velocity(fine), fine) + record.velocity(t) * (t - inside)
        assert record.displacement(t) == pytest.approx(moved, abs=1e-9)


class TestHousner:
    @pytest.mark.parametrize("aspect", ASPECTS)
    def test_restitution_is_the_one_of_the_book(self, aspect):
        named = result("thesis_rocking", f"e_{aspect:.1f}")
        assert Block(1.0, aspect).restitution == pytest.approx(named["value"], abs=5e-5)
        assert Block(1.0, aspect).alpha == pytest.approx(named["alpha_rad"], abs=5e-7)

    @pytest.mark.parametrize("aspect", ASPECTS)
    @pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
    def test_quarter_period_is_the_elliptic_integral(self, aspect, share):
        block = Block(0.4, 0.4 * aspect)
        done = housner.rock(block, duration=5.0, angle=-share * block.alpha)
        assert done.impacts[0] == pytest.approx(quarter(block, share), rel=1e-9)

    def test_quarter_period_of_slender_blocks_is_the_one_of_the_book(self):
        done = housner.rock(SLENDER, duration=2.0, angle=0.5 * SLENDER.alpha)
        assert done.impacts[0] == pytest.approx(np.arccosh(2.0) / SLENDER.p, rel=1e-6)
        assert Block(0.5, 2.0).p == pytest.approx(result("classical_benchmarks", "rock_p")["value"], rel=1e-6)
        book = result("classical_benchmarks", "rock_quarter")["value"]
        assert np.arccosh(2.0) / Block(0.5, 2.0).p == pytest.approx(book, rel=1e-5)

    @pytest.mark.parametrize("aspect", ASPECTS)
    @pytest.mark.parametrize("restitution", [None, 0.95])
    def test_peaks_and_times_of_free_rocking(self, aspect, restitution):
        """Between impacts the energy cos(α − |θ|) + ω²/2p² stays; an impact leaves e² of what is above cos α."""
        block = Block(0.25, 0.25 * aspect)
        e = block.restitution if restitution is None else restitution
        start = 0.6 * block.alpha
        done = housner.rock(block, duration=6.0, angle=start, restitution=restitution, step=5e-4)
        times, peaks = done.extremes()
        expected = decayed(block, start, e, 6)
        assert np.abs(peaks[:5]) == pytest.approx(expected[1:6], rel=1e-6)
        assert (np.sign(peaks[:5]) == [-1, 1, -1, 1, -1]).all()
        quarters = np.array([quarter(block, angle / block.alpha) for angle in expected])
        ends = np.concatenate([[0.0], np.cumsum(quarters[:-1] + quarters[1:])])
        assert times[:5] == pytest.approx(ends[1:6], rel=1e-5)
        assert done.impacts[:5] == pytest.approx(ends[:5] + quarters[:5], rel=1e-8)

    def test_rests_after_all_impacts(self):
        block = Block(0.5, 1.0)
        done = housner.rock(block, duration=10.0, angle=0.5 * block.alpha)
        assert done.angles[-1] == 0.0
        assert done.speeds[-1] == 0.0
        assert 20 < len(done.impacts) < 100

    @pytest.mark.parametrize("aspect", ASPECTS)
    def test_least_speed_that_overturns(self, aspect):
        """½ ω² = p² (1 − cos α)."""
        block = Block(0.3, 0.3 * aspect)
        least = 2.0 * block.p * np.sin(0.5 * block.alpha)
        found = [
            np.isfinite(housner.rock(block, duration=20.0, speed=f * least).overturned) for f in (1 - 1e-7, 1 + 1e-7)
        ]
        assert found == [False, True]

    @pytest.mark.parametrize("ratio", [1.0, 2.0, 4.0, 8.0])
    def test_half_sine_that_overturns_without_impact(self, ratio):
        """√(x² − 1) + x e^(−p t) = ω/p with the time t from start to end of the pulse (Shi and others 1996)."""
        w = ratio * SLENDER.p
        x = brentq(
            lambda x: np.sqrt(x**2 - 1) + x * np.exp(-(np.pi - np.arcsin(1 / x)) / ratio) - ratio, 1.0, 2 * ratio + 2
        )
        assert bisected(SLENDER, w, 0.5, 0.9 * x, 1.1 * x) == pytest.approx(x, rel=1e-5)

    @pytest.mark.parametrize("ratio", [1.0, 2.0, 3.0])
    def test_sine_that_overturns_after_one_impact(self, ratio):
        w = ratio * SLENDER.p
        x = after_one_impact(ratio, SLENDER.restitution)
        assert bisected(SLENDER, w, 1.0, 0.97 * x, 1.03 * x) == pytest.approx(x, rel=1e-5)

    @pytest.mark.parametrize("ratio", [5.0, 8.0])
    def test_sine_that_overturns_without_impact(self, ratio):
        """√(x² − 1) − x e^(−p t) = ω/p with the time t from start to end of the pulse (Zhang and Makris 2001)."""
        w = ratio * SLENDER.p
        x = brentq(
            lambda x: np.sqrt(x**2 - 1) - x * np.exp(-(2 * np.pi - np.arcsin(1 / x)) / ratio) - ratio,
            1.0,
            3 * ratio + 2,
        )
        assert bisected(SLENDER, w, 1.0, 0.98 * x, 1.02 * x) == pytest.approx(x, rel=1e-5)

    @pytest.mark.parametrize("seed", [0, 1, 2, 8])
    def test_against_tight_integration_with_events(self, seed):
        """Records with both components: impacts and angles as DOP853 finds them, to 1e-12, piece by piece."""
        random = np.random.default_rng(seed)
        block = Block(1.0, random.uniform(2.0, 3.0))
        across, up = (Record(0.1, a * random.normal(size=61)) for a in (3.5, 2.0))
        start = 0.3 * block.alpha
        fast = housner.rock(block, across, 4.0, vertical=up, angle=start, step=5e-4)
        impacts, angle = tight(block, across, up, start, 4.0)
        assert len(impacts) > 4
        assert fast.impacts == pytest.approx(impacts, abs=1e-10)
        assert fast.angles[-1] == pytest.approx(angle, abs=1e-10)

    def test_starts_when_the_push_is_enough(self):
        block = Block(0.5, 1.0)
        still, moved = (housner.rock(block, Sine(a * 4.905, 1.0), 3.0) for a in (0.9999, 1.001))
        assert still.peak == 0.0
        assert moved.peak > 0.0
        assert moved.angles[np.flatnonzero(moved.angles)[0]] > 0.0  # the base goes right, the block leans left
        lifted = housner.rock(block, Sine(0.95 * 4.905, 1.0), 3.0, vertical=Sine(-1.0, 0.0, 0.5 * np.pi))
        assert lifted.peak > 0.0


class TestSlider:
    @pytest.mark.parametrize("friction", [0.1, 0.3, 0.6])
    def test_rectangular_pulse(self, friction):
        """Newmark: A T² (A / μg − 1) / 2, against the base's motion."""
        a, t = 8.0, 0.4
        done = newmark_slider.slide(newmark_slider.Slope(friction), rectangle(a, t), 10.0)
        yielding = friction * 9.81
        assert done.final == pytest.approx(-0.5 * a * t**2 * (a / yielding - 1.0), rel=1e-12)

    def test_half_sine_pulse(self):
        """Starts at sin ωt = μg/A; stops where the areas are equal, here after the end of the pulse."""
        a, f, yielding = 9.0, 1.0, 0.3 * 9.81
        done = newmark_slider.slide(newmark_slider.Slope(0.3), pulse(a, f, 0.5), 5.0)
        w, t0 = 2 * np.pi * f, np.arcsin(yielding / a) / (2 * np.pi * f)
        base = a / w * (1 + np.cos(w * t0))
        end = t0 + base / yielding
        assert end > 0.5 / f
        moved = a / w * (np.cos(w * t0) * (0.5 / f - t0) - (0 - np.sin(w * t0)) / w) + base * (end - 0.5 / f)
        assert done.final == pytest.approx(-(moved - 0.5 * yielding * (end - t0) ** 2), rel=1e-10)
        assert done.times[-2] == pytest.approx(end, rel=1e-12)

    def test_full_sine_turns_back(self):
        done = newmark_slider.slide(newmark_slider.Slope(0.2), pulse(9.0, 1.0), 5.0)
        fine = stepped(0.2, pulse(9.0, 1.0), 5.0)
        assert done.final == pytest.approx(fine, abs=5e-5)
        assert done.path > abs(done.final)

    def test_steady_sliding_under_harmonic_motion(self):
        """Without sticking it turns every half period, where cos ωt = −π k / 2A, k = μg: so far it goes between."""
        friction, a, f = 0.1, 8.0, 1.0
        done = newmark_slider.slide(newmark_slider.Slope(friction), Sine(a, f), 60.0)
        turns = done.times[1:-1][done.speeds[1:-1] == 0.0]
        assert np.diff(np.unique(turns))[-4:] == pytest.approx(0.5 / f, abs=1e-6)
        w, k = 2 * np.pi * f, friction * 9.81
        half = np.abs(np.diff(done.slips[1:-1][done.speeds[1:-1] == 0.0]))
        assert half[half > 1e-9][-1] == pytest.approx(2 * a / w**2 * np.sqrt(1 - (0.5 * np.pi * k / a) ** 2), rel=1e-6)

    def test_incline_slides_down_only(self):
        """A horizontal rectangular pulse on a slope of 10°: both accelerations are constant."""
        beta, mu, a, t, g = np.radians(10.0), 0.4, 6.0, 0.3, 9.81
        slope = newmark_slider.Slope(mu, beta)
        done = newmark_slider.slide(slope, rectangle(a, t), 10.0)
        rate = g * np.sin(beta) + a * np.cos(beta) - mu * (g * np.cos(beta) - a * np.sin(beta))
        brake = mu * g * np.cos(beta) - g * np.sin(beta)
        assert done.final == pytest.approx(-0.5 * rate * t**2 * (1.0 + rate / brake), rel=1e-11)

    def test_numbers_of_the_book(self):
        incline = newmark_slider.slide(newmark_slider.Slope(0.3, np.radians(30.0)), rectangle(0.0, 1.0), 1.0)
        assert -incline.final == pytest.approx(result("classical_benchmarks", "slide_dist")["value"], rel=1e-6)
        pushed = newmark_slider.slide(newmark_slider.Slope(0.5), rectangle(0.0, 1.0), 3.0, speed=1.0)
        assert pushed.final == pytest.approx(result("classical_benchmarks", "push_stop")["value"], rel=1e-5)


class TestBouncing:
    joint = bouncing.Joint(stiffness=1e9, mass=2000.0)

    def test_numbers_of_the_book(self):
        assert self.joint.static == pytest.approx(result("classical_benchmarks", "spring")["value"], rel=1e-6)
        frequency = result("classical_benchmarks", "bounce_f")["value"]
        assert self.joint.frequency / (2 * np.pi) == pytest.approx(frequency, rel=1e-6)

    @pytest.mark.parametrize("ratio", [0.0, 0.2, 0.7, 1.0, 1.5])
    def test_contact_against_integration(self, ratio):
        joint = self.joint._replace(ratio=ratio)
        c = 2 * ratio * joint.mass * joint.frequency

        def rates(t, y):
            return [y[1], joint.gravity - (joint.stiffness * y[0] + c * y[1]) / joint.mass]

        end = min(bouncing.contact_time(joint, 0.5), 4 * np.pi / joint.frequency)
        done = solve_ivp(rates, (0, end), [0.0, 0.5], "DOP853", rtol=1e-11, atol=1e-14)
        u, rate, force = bouncing.contact(joint, 0.5, end)
        assert done.y[:, -1] == pytest.approx([u, rate], abs=1e-9)
        if ratio < 1.0:
            assert force == pytest.approx(0.0, abs=1e-5 * joint.stiffness * joint.static)

    def test_no_dashpot_no_loss(self):
        assert bouncing.heights(self.joint, 0.1, 5) == pytest.approx(0.1, rel=1e-10)
        assert bouncing.peak_overlap(self.joint, 0.0) == pytest.approx(2 * self.joint.static)
        u = bouncing.contact(self.joint, 1.0, np.linspace(0, bouncing.contact_time(self.joint, 1.0), 20001))[0]
        assert u.max() == pytest.approx(bouncing.peak_overlap(self.joint, 0.5 / 9.81), rel=1e-7)

    def test_a_hard_joint_has_the_restitution_of_a_clipped_dashpot(self):
        """Without gravity, ζ < 1: it leaves where cos ω_d t = 2 ζ² − 1, with e^(−ζ ω t) of its speed."""
        z = 0.3
        joint = self.joint._replace(ratio=z, gravity=1e-9)
        left = np.exp(-z / np.sqrt(1 - z**2) * np.arccos(2 * z**2 - 1))
        assert bouncing.rebound(joint, 1.0) == pytest.approx(left, rel=1e-6)


class TestTwoBlocks:
    lower, upper = two_blocks.Rectangle(0.5, 1.0, 2000.0), two_blocks.Rectangle(0.4, 1.2, 2000.0)

    @pytest.mark.parametrize("angles", [(0.05, 0.1), (0.05, -0.03), (-0.08, 0.02), (0.06, 0.02), (0.0, 0.08)])
    def test_energy_stays(self, angles):
        motion = two_blocks.rock(self.lower, self.upper, angles)
        energy = two_blocks.energies(self.lower, self.upper, motion)
        assert motion.closed is not None
        assert np.ptp(energy) < 1e-9 * energy[0]
        assert (motion.forces[:, :, 1] > 0.0).all()

    def test_upper_block_alone_is_housners(self):
        block = Block(self.upper.width, self.upper.height)
        motion = two_blocks.rock(self.lower, self.upper, (0.0, 0.5 * block.alpha))
        assert motion.closed == "joint"
        assert motion.times[-1] == pytest.approx(quarter(block, 0.5), rel=1e-9)

    def test_a_weightless_upper_block_leaves_housners(self):
        block, dust = Block(self.lower.width, self.lower.height), self.upper._replace(density=1e-9)
        motion = two_blocks.rock(self.lower, dust, (0.2 * block.alpha, -0.3), duration=5.0)
        if motion.closed == "base":
            assert motion.times[-1] == pytest.approx(quarter(block, 0.2), rel=1e-6)
        state = np.interp(0.1, motion.times, motion.angles[:, 0])
        alone = housner.rock(block, duration=0.1, angle=0.2 * block.alpha).angles[-1]
        assert state == pytest.approx(alone, rel=1e-5)

    def test_mirror_image(self):
        one = two_blocks.rock(self.lower, self.upper, (0.05, -0.03))
        other = two_blocks.rock(self.lower, self.upper, (-0.05, 0.03))
        assert one.angles[-1] == pytest.approx(-other.angles[-1], abs=1e-12)

    def test_accelerations_are_those_of_lagrange(self):
        """By finite differences of T − V, from the positions of both centroids alone."""
        stack = two_blocks._Stack(self.lower, self.upper, 1.0, -1.0, False)
        y = np.array([0.07, -0.02, 0.4, -0.9])
        q, v = y[:2], y[2:]

        def kinetic(q, v):
            return stack.energy(np.concatenate([q, v])) - stack.energy(np.concatenate([q, np.zeros(2)]))

        def lagrangian(q, v):
            return kinetic(q, v) - stack.energy(np.concatenate([q, np.zeros(2)]))

        h, unit = 1e-4, np.eye(2)
        force = np.array([(lagrangian(q + h * e, v) - lagrangian(q - h * e, v)) / (2 * h) for e in unit])

        def momentum(q, v):
            return np.array([(kinetic(q, v + h * e) - kinetic(q, v - h * e)) / (2 * h) for e in unit])

        mass = np.column_stack([momentum(q, e) for e in unit])
        drift = (momentum(q + h * v, v) - momentum(q - h * v, v)) / (2 * h)
        assert stack.accelerations(y) == pytest.approx(np.linalg.solve(mass, force - drift), rel=1e-5)


@pytest.mark.parametrize("beam", [0.0, 0.4, 3.0])
@pytest.mark.parametrize("aspect", [2.0, 6.9])
class TestRockingFrame:
    """Two columns and a beam as three bodies, without the formulas of the frame."""

    def test_motion(self, aspect, beam):
        """Kinetic energy is ½ M θ'², M = Σ m |∂r/∂θ|² + I, and what drives it Σ −m (g, a)·∂r/∂θ."""
        column, a, start = Block(0.3, 0.3 * aspect), 0.7, 0.3
        arms = [((0.5, 0.5), 1.0), ((0.5, 0.5), 1.0), ((1.0, 1.0), 2.0 * beam)]  # from the corner it stands on; mass
        size = np.array([column.width, column.height])

        def pull(_, y):
            inertia, force = 2.0 * (size @ size) / 12.0, 0.0
            for share, mass in arms:
                x, z = np.array(share) * size
                rise, shift = np.cos(y[0]) * x - np.sin(y[0]) * z, -np.sin(y[0]) * x - np.cos(y[0]) * z
                inertia += mass * (x * x + z * z)
                force -= mass * (column.gravity * rise + a * shift)
            return [y[1], force / inertia]

        body = rocking_frame.equivalent(column, beam)
        angle, time = start * column.alpha, 0.3 / body.p
        exact = solve_ivp(pull, (0.0, time), [angle, 0.0], rtol=1e-12, atol=1e-14).y[0, -1]
        found = housner.rock(body, rectangle(a, 1.0), time, angle=angle)
        assert exact > 0.0
        assert found.angles[-1] == pytest.approx(exact, rel=1e-9)

    def test_restitution(self, aspect, beam):
        """Impulses at the two new pivots and at the two new places under the beam, all unknown, stop these points."""
        b, h = 0.3, 0.3 * aspect
        found = landed(b, h, max(beam, 1e-12))
        assert found[2] == pytest.approx(rocking_frame.restitution(Block(b, h), beam), rel=1e-9)
        assert found[5] == pytest.approx(found[2], rel=1e-9)
        assert found[8] == pytest.approx(0.0, abs=1e-9)  # the beam does not turn


def landed(b: float, h: float, beam: float) -> np.ndarray:
    """Velocities (x, z, turn) of two columns of mass 1, 2 m apart, and of a beam of 2 `beam`, which turned about the
    lower left corners of the columns at 1 rad/s, after landing on the right ones: pivots do not move.
    """

    def cross(arm):
        return np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])  # velocity of a point: (x, z, turn) of its body

    masses = [np.diag([1.0, 1.0, (b * b + h * h) / 12.0])] * 2 + [2.0 * beam * np.diag([1.0, 1.0, 1.0])]
    before = np.concatenate([[-0.5 * h, 0.5 * b, 1.0]] * 2 + [[-h, b, 0.0]])
    held = np.zeros((8, 9))  # velocities of the four places: pivots, then beam against columns
    for k in (0, 1):
        held[2 * k : 2 * k + 2, 3 * k : 3 * k + 3] = cross([0.5 * b, -0.5 * h])
        held[4 + 2 * k : 6 + 2 * k, 3 * k : 3 * k + 3] = -cross([-0.5 * b, 0.5 * h])
        held[4 + 2 * k : 6 + 2 * k, 6:] = cross([2.0 * k - 1.0, -0.1])
    mass = block_diag(*masses)
    system = np.block([[mass, -held.T], [held, np.zeros((8, 8))]])
    return np.linalg.solve(system, np.concatenate([mass @ before, np.zeros(8)]))[:9]


def quarter(block: Block, share: float) -> float:
    """Time from rest at share · α to θ = 0, by elliptic integrals: an inverted pendulum turned upside down."""
    k = np.cos(0.5 * (1.0 - share) * block.alpha)
    return float((ellipk(k**2) - ellipkinc(np.arcsin(np.cos(0.5 * block.alpha) / k), k**2)) / block.p)


def decayed(block: Block, start: float, e: float, count: int) -> np.ndarray:
    """Peaks |θ| of free rocking, the start first."""
    above = (np.cos(block.alpha - start) - np.cos(block.alpha)) * e ** (2.0 * np.arange(count))
    return block.alpha - np.arccos(np.cos(block.alpha) + above)


def bisected(block: Block, w: float, cycles: float, low: float, high: float) -> float:
    """x = A / (g α) between which a pulse does and does not overturn."""
    for _ in range(24):
        x = 0.5 * (low + high)
        motion = pulse(x * block.gravity * block.alpha, w / (2 * np.pi), cycles)
        if housner.overturns(block, motion, 2 * np.pi / w + 25.0 / block.p, bound=5 * block.alpha, step=2e-3):
            high = x
        else:
            low = x
    return 0.5 * (low + high)


def after_one_impact(ratio: float, e: float) -> float:
    """Least x = A / (g α) of one sine of ω = ratio · p that overturns the linearised block after an impact; p = 1.

    φ'' − φ = x sin ωt − s. With u = φ + φ', what comes after t is enough where u e^(−t) + ∫ (x sin ωτ − s) e^(−τ) dτ
    has the sign of φ, s = −1 after the impact.
    """
    end = 2 * np.pi / ratio

    def forced(t, x):
        """φ, φ' of the particular solution of x sin ωt."""
        return -x / (1 + ratio**2) * np.array([np.sin(ratio * t), ratio * np.cos(ratio * t)])

    def after(t, start, state, x, s):
        """φ, φ' a time after `start`."""
        inside = start < end
        rest = np.array([s, 0.0])
        free = state - rest - (forced(start, x) if inside else 0.0)
        c, h = np.cosh(t - start), np.sinh(t - start)
        return rest + [c * free[0] + h * free[1], h * free[0] + c * free[1]] + (forced(t, x) if inside else 0.0)

    def missing(x):
        start = np.arcsin(1 / x) / ratio
        path = [(start, np.zeros(2)), (end, after(end, start, np.zeros(2), x, 1.0))]
        times = np.linspace(start, end, 2000)[1:]
        back = np.flatnonzero(np.array([after(t, start, np.zeros(2), x, 1.0)[0] for t in times]) < 0.0)
        if len(back):
            hit = brentq(lambda t: after(t, *path[0], x, 1.0)[0], times[back[0] - 1], times[back[0]], xtol=1e-14)
            speed = e * after(hit, *path[0], x, 1.0)[1]
        else:
            later = brentq(lambda t: after(t, *path[1], x, 1.0)[0], end, end + 30.0, xtol=1e-14)
            hit, speed = later, e * after(later, *path[1], x, 1.0)[1]
        past = np.array([min(hit, end), end])
        sine = -np.exp(-past) * (np.sin(ratio * past) + ratio * np.cos(ratio * past)) / (1 + ratio**2)
        return (speed + 1.0) * np.exp(-hit) + x * (sine[1] - sine[0])

    scan = np.linspace(1.02, 12.0, 400)
    below = next(k for k, x in enumerate(scan) if missing(x) < 0.0)
    return brentq(missing, scan[below - 1], scan[below])


def tight(block: Block, across: Record, up: Record, angle: float, duration: float) -> tuple[np.ndarray, float]:
    """Impacts, and θ at the end, of a block that never rests."""
    ends = np.unique(np.concatenate([across.breaks[across.breaks < duration], [duration]]))
    state, s, impacts = np.array([angle, 0.0]), np.sign(angle), []
    for begin, end in zip(ends[:-1], ends[1:]):
        t = begin
        while t < end:

            def rates(t, y, s=s):
                phi = block.alpha - s * y[0]
                pull = s * np.sin(phi) * (block.gravity + up.acceleration(t)) - np.cos(phi) * across.acceleration(t)
                return [y[1], -(block.p**2) / block.gravity * pull]

            def closes(t, y, s=s, begin=begin):
                return s * y[0] if t > begin or s * y[1] < 0.0 else 1.0

            closes.terminal, closes.direction = True, -1.0
            done = solve_ivp(rates, (t, end), state, "DOP853", rtol=1e-12, atol=1e-14, events=closes)
            t, state = done.t[-1], done.y[:, -1]
            if done.status == 1:
                impacts.append(t)
                state = np.array([0.0, block.restitution * state[1]])
                s = np.sign(state[1])
                assert abs(state[1]) > 1e-4
    return np.array(impacts), state[0]


def stepped(friction: float, motion, duration: float, step: float = 2e-5) -> float:
    """Final slip by small steps: within each, friction stops the block or slows it as much as it can."""
    v = s = 0.0
    base = np.diff(motion.velocity(np.arange(0.0, duration + step, step)))
    for push in -base:
        free = v + push
        new = np.sign(free) * max(abs(free) - friction * 9.81 * step, 0.0)
        s += 0.5 * (v + new) * step
        v = new
    return s
