"""The energy balance, with friction and loss of contact.

    change of kinetic and potential energy =
        work of drive and load - supports' and mesh damping + power of friction
        - integral F e' dt + sum over stiffness switches of the jump 1/2 dk f^2

Powers are integrated within every step of the integrator, in which they are smooth, by a Gauss
rule on the step's own series.
"""

import dataclasses

import numpy as np
import pytest

from gear_dynamics.integrator import stepper
from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.system import feed_forward
from gear_dynamics.simulation.simulator import Simulator

ACCURACY = 1e-8
"""Of the energy lost."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


@kernel
def begin(records, zones, ports):
    stepper.begin_step(records[0], zones, ports)


@kernel
def end(records, zones, ports):
    records[0].counts.events = 0
    stepper.end_step(records[0], zones, ports)


class Ledger:
    """What goes in and out of a healthy pair, step by step."""

    def __init__(self, pair, speed, load_torque):
        self.pair, self.d, self.speed, self.load = pair, pair.derived, speed, load_torque
        self.ratio = self.d.pinion_base_radius / self.d.gear_base_radius
        names = 'drive load supports mesh error friction'
        self.work = dict.fromkeys(names.split(), 0.0)
        self.jumps = 0.0
        self.fed_in_tension = self.fed_by_vibration = 0.0

    def motion_over(self, series, length, count=None):
        """Return positions and velocities (6, n) in x1, y1, x2, y2, th1, th2, and delta, delta'."""
        t = length * (NODES + 1) / 2 if count is None else np.linspace(0, length, count)
        value = np.polynomial.polynomial.polyval(t, series[:, :8])
        slope = np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(series[:, :8]))
        u, v = np.array(value[:6]), np.array(slope[:6])
        d = self.d
        inertia = d.pinion_inertia + d.gear_inertia * self.ratio**2
        matrix = np.linalg.inv(
            [
                [d.pinion_base_radius, -d.gear_base_radius],
                [d.pinion_inertia / inertia, self.ratio * d.gear_inertia / inertia],
            ]
        )
        u[4:], v[4:] = matrix @ u[4:], matrix @ v[4:]
        return t, u, v, value[6], slope[6], value[5], slope[5], value[7]

    def pairs(self, record, t):
        """Return lambda and arm l_i1 of the pairs in contact at times t into the step."""
        d = self.d
        angle = np.radians(self.pair.pressure_angle_deg)
        phase = record['phase']['phase'] + self.pair.pinion_teeth * self.speed / (2 * np.pi) * t
        middle = (
            record['phase']['phase']
            + self.pair.pinion_teeth * self.speed / (4 * np.pi) * record['step']['length']
        )
        for ahead in (0, 1):
            if (middle + ahead) * d.base_pitch < d.path_length:
                s = (phase + ahead) * d.base_pitch
                sliding = 1 if (middle + ahead) * d.base_pitch < d.approach_length else -1
                yield sliding, d.pinion_pitch_radius * np.sin(angle) - d.approach_length + s

    def add_step(self, record, series):
        pair, d = self.pair, self.d
        length, contact = record['step']['length'], record['contact']['state'][0, 0]
        t, _, v, delta, delta_dot, q, q_dot, q_sum = self.motion_over(series, length)
        stretch = (delta - contact * pair.half_backlash) if contact else 0 * delta
        touches = contact != 0
        force_i = pair.tooth_pair_stiffness * stretch + touches * d.tooth_pair_damping * delta_dot
        drive_rate = 2 * np.pi * pair.drive_frequency
        inertia = d.pinion_inertia + d.gear_inertia * self.ratio**2
        drive = self.load * (self.ratio + feed_forward(pair)) - inertia * (
            drive_rate**2 * q
            + 2 * pair.drive_damping_ratio * drive_rate * q_dot
            + drive_rate**3 / 5 * q_sum
        )
        w1, w2 = self.speed + v[4], self.speed * self.ratio + v[5]
        pairs = list(self.pairs(record, t))
        arms = (d.pinion_base_radius + d.gear_base_radius) * np.tan(
            np.radians(pair.pressure_angle_deg)
        )
        friction = 0.0
        for sliding, arm in pairs:
            rub = contact * sliding * pair.friction_coefficient * force_i
            power = rub * (v[0] - v[2] + arm * w1 - (arms - arm) * w2)
            friction = friction + power
            self._tell_feeding(power, contact * force_i < 0, length)
        n = len(pairs)
        phase = 2 * np.pi * record['phase']['phase'] + self.pair.pinion_teeth * self.speed * t
        error_dot = pair.transmission_error_amplitude * np.cos(phase) * pair.pinion_teeth
        powers = {
            'drive': drive * w1,
            'load': -self.load * w2,
            'supports': -d.pinion_support_damping * (v[0] ** 2 + v[1] ** 2)
            - d.gear_support_damping * (v[2] ** 2 + v[3] ** 2),
            'mesh': -n * touches * d.tooth_pair_damping * delta_dot**2,
            'error': -n * force_i * error_dot * self.speed,
            'friction': friction,
        }
        for name, power in powers.items():
            self.work[name] += length / 2 * np.dot(WEIGHTS, power * np.ones_like(t))

    def _tell_feeding(self, power, tensile, length):
        fed = length / 2 * WEIGHTS * np.maximum(power, 0.0)
        self.fed_in_tension += fed[tensile].sum()
        self.fed_by_vibration += fed[~tensile].sum()

    def stored(self, record, series, at_end):
        """Return all energy at the beginning or the end of the step, and that of the teeth."""
        pair, d = self.pair, self.d
        _, u, v, delta, *_ = (c[..., -1 if at_end else 0] for c in self.motion_over(
            series, record['step']['length'], 2))  # fmt: skip
        masses = [d.pinion_mass] * 2 + [d.gear_mass] * 2
        w1, w2 = self.speed + v[4], self.speed * self.ratio + v[5]
        kinetic = np.dot(masses, v[:4] ** 2) + d.pinion_inertia * w1**2 + d.gear_inertia * w2**2
        springs = [pair.pinion_support_stiffness] * 2 + [pair.gear_support_stiffness] * 2
        n = len(list(self.pairs(record, 0.0)))
        stretch = (
            delta - record['contact']['state'][0, 0] * pair.half_backlash
            if record['contact']['state'][0, 0]
            else 0.0
        )
        mesh = n * pair.tooth_pair_stiffness * stretch**2
        return (kinetic + np.dot(springs, u[:4] ** 2) + mesh) / 2, mesh / 2


def balance(pair, rpm, load_torque, cycles):
    """Return the ledger over whole cycles, and change of stored energy."""
    speed = rpm * np.pi / 30
    simulator = Simulator(
        pair, speed=speed, load_torque=load_torque, anti_alias=False, rtol=1e-11, atol=1e-14
    )
    motion = simulator.state().motion
    record, series = motion.records[0], motion.records[0]['series']
    ledger = Ledger(pair, speed, load_torque)
    first = last = teeth_before = None
    while record['phase']['cycle'] < cycles:
        begin(*motion)
        if record['step']['length'] > 0:
            before, teeth = ledger.stored(record, series, at_end=False)
            first = before if first is None else first
            # Where a pair enters or leaves with its spring stretched, 1/2 dk f^2 comes or goes.
            ledger.jumps += teeth - teeth_before if teeth_before is not None else 0.0
            ledger.add_step(record, series)
            last, teeth_before = ledger.stored(record, series, at_end=True)
        end(*motion)
    ledger.losses = record['counts']['contact_losses']
    return ledger, last - first


@pytest.mark.parametrize(
    ('rpm', 'load_torque', 'changes', 'losses'),
    [
        (1000, 150.0, {}, False),
        (1000, 150.0, {'drive_feed_forward': True}, False),
        (3200, 150.0, {}, True),
        (8000, 150.0, {'friction_coefficient': 0.1}, True),
        (9500, 60.0, {'friction_coefficient': 0.2, 'half_backlash': 15e-6}, True),
    ],
)
def test_energy_closes_only_if_all_is_counted(rpm, load_torque, changes, losses):
    pair = dataclasses.replace(GearPair(), **changes)
    ledger, change = balance(pair, rpm, load_torque, cycles=15)
    assert (ledger.losses > 0) == losses
    work = ledger.work
    lost = -(work['supports'] + work['mesh'] + work['friction'])
    assert lost > 0
    given = sum(work[name] for name in ('drive', 'load', 'supports', 'mesh', 'error', 'friction'))
    assert abs(change - given - ledger.jumps) < ACCURACY * lost
    # Each term matters: without it the balance is open by far more.
    for name in ('drive', 'load', 'supports', 'mesh', 'error', 'friction'):
        assert abs(work[name]) > 100 * ACCURACY * lost, name
    assert abs(ledger.jumps) > 100 * ACCURACY * lost


@pytest.mark.parametrize(
    ('rpm', 'in_tension', 'by_vibration'),
    [(1000, 0.0, 2e-5), (3200, 9e-5, 4e-4), (8000, 3e-4, 1e-5)],
)
def test_friction_feeds_energy_in_by_the_documented_shares(rpm, in_tension, by_vibration):
    # The shares are those of docs/model.md; the start and the number of cycles are too.
    ledger, _ = balance(GearPair(), rpm, 150.0, cycles=30)
    lost = -ledger.work['friction']
    assert lost > 0
    assert in_tension / 2 <= ledger.fed_in_tension / lost <= 2 * in_tension
    assert by_vibration / 2 < ledger.fed_by_vibration / lost < 2 * by_vibration
