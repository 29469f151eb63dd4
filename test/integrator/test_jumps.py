"""The jumps at events, which band-limiting takes out, against those of the reference equations."""

import dataclasses

import numpy as np
import pytest
from reference_equations import COLUMNS
from reference_run import Reference
from scipy.integrate import solve_ivp

from gear_dynamics.integrator.band_limit import BandLimiter
from gear_dynamics.integrator.jumps import CURVATURE, SLOPE, VALUE
from gear_dynamics.integrator.layout import (
    AX1,
    AX2,
    AY1,
    AY2,
    FORCE,
    FRICTION,
    SAMPLE_DELTA,
    SAMPLE_DELTA_DOT,
    SPEED,
    T,
)
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

LOAD = 150.0
FORCES = {
    'pinion_ax': AX1,
    'pinion_ay': AY1,
    'gear_ax': AX2,
    'gear_ay': AY2,
    'mesh_force': FORCE,
    'friction_force': FRICTION,
}
"""What jumps itself; the others jump in their derivatives."""
KNOWN = {
    VALUE: FORCES,
    SLOPE: {**FORCES, 'delta_dot': SAMPLE_DELTA_DOT, 'speed': SPEED},
    CURVATURE: {**FORCES, 'delta_dot': SAMPLE_DELTA_DOT, 'delta': SAMPLE_DELTA},
}
"""Of which columns the values, slopes and curvatures are known to jump."""


class Watched(Reference):
    """Notes the state at each event, and the tooth pairs before and after it."""

    def run(self, times):
        self.seen = []
        return super().run(times)

    def _interval(self, begin, end, y, pairs, *rest):
        self._note(begin, y, pairs)
        return super()._interval(begin, end, y, pairs, *rest)

    def _change_contacts(self, t, out, meanings):
        super()._change_contacts(t, out, meanings)
        self._note(t, out.y[:, -1], list({pair.number: pair for pair, _ in meanings}.values()))

    def _note(self, t, y, pairs):
        self.seen.append((t, y, [dataclasses.replace(pair) for pair in pairs]))


def derivatives(equations, t, y, pairs):
    """Return the columns and their first two derivatives at t, (3, 12), with these pairs.

    Central differences of fourth order on the motion as these pairs alone would have it, which is
    smooth. The fastest mode turns by 0.02 in a step, which leaves an error of 1e-8.
    """
    step = 0.02 / 8e4

    def row(steps):
        if steps == 0:
            return np.array(equations.row(t, y, pairs))
        end = t + steps * step
        moved = solve_ivp(
            lambda t, y: equations.slope(t, y, pairs), (t, end), y, 'DOP853', rtol=1e-12, atol=1e-18
        )
        return np.array(equations.row(end, moved.y[:, -1], pairs))

    rows = np.stack([row(steps) for steps in range(-2, 3)])
    first = np.array([1, -8, 0, 8, -1]) / (12 * step)
    second = np.array([-1, 16, -30, 16, -1]) / (12 * step**2)
    return np.stack([rows[2], first @ rows, second @ rows])


@pytest.mark.parametrize(('rpm', 'losses'), [(1000, False), (8000, True)])
def test_jumps_are_those_of_the_equations(monkeypatch, rpm, losses):
    pair, speed = GearPair(), rpm * np.pi / 30
    found = []
    monkeypatch.setattr(BandLimiter, 'smooth', lambda _, jumps: found.append(jumps.copy()))
    simulator = Simulator(pair, speed=speed, load_torque=LOAD, rtol=1e-12, atol=1e-15)
    high_rate = float(simulator.state().motion.records[0]['sampling']['sample_rate'])
    simulator.advance(round(8 * 2 * np.pi / (34 * speed) * simulator.sample_rate))
    assert (simulator.counters['contact_losses'] > 0) == losses
    jumps = np.concatenate(found)
    times = jumps[:, VALUE, T] / high_rate

    reference = Watched(pair, speed, LOAD)
    reference.run(np.array([times[-1] + 1e-6]))
    got, expected = [], []
    for (_, _, before), (t, y, after) in zip(reference.seen, reference.seen[1:], strict=False):
        reference._follow_commands(0.0)
        (i,) = np.flatnonzero(np.abs(times - t) < 1e-9)
        sides = (derivatives(reference, t, y, pairs) for pairs in (before, after))
        expected.append(-np.subtract(*sides))
        got.append(jumps[i])
    assert len(got) == len(jumps)
    got, expected = np.array(got), np.array(expected)
    for row, columns in KNOWN.items():
        for name, column in columns.items():
            right = expected[:, row, COLUMNS.index(name)]
            scale = np.max(np.abs(right))
            np.testing.assert_allclose(
                got[:, row, column], right, rtol=0, atol=1e-6 * scale, err_msg=f'{row} of {name}'
            )
