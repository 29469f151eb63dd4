"""Bearing faults 10 dB below the tones of a gearbox, in spans of 1 s."""

import numpy as np
import pytest

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.spans.analysis import SpanAnalysis
from gear_dynamics.monitoring.spans.bearings import name_defect
from gear_dynamics.monitoring.spans.data import Signal, Span
from gear_dynamics.signal.bearing import DefectLine

RATE, SPEED, SPANS = 12800.0, 30.0, 20
ORDERS = {'outer': 3.585, 'inner': 5.415, 'element': 4.714, 'cage': 0.398}
MACHINE = Machine.from_mapping(
    {
        'channels': {'a': {'unit': 'm/s2'}},
        'shafts': {'input': {'speed_rpm': SPEED * 60}, 'output': {'driven_by': 'first'}},
        'wheels': {'p': {'shaft': 'input', 'teeth': 23}, 'g': {'shaft': 'output', 'teeth': 59}},
        'meshes': {'first': ['p', 'g']},
        'bearings': {'B': {'shaft': 'input', 'orders': ORDERS}},
    }
)


def gearbox(random):
    """Return a second of mesh lines with sidebands of both shafts, noise 10 dB below them."""
    t = np.arange(int(RATE)) / RATE
    x = np.zeros(len(t))
    for harmonic, amplitude in ((1, 1.0), (2, 0.6), (3, 0.3)):
        a, b, c = random.uniform(0, 2 * np.pi, 3)
        modulation = 1 + 0.3 * np.cos(2 * np.pi * SPEED * t + a)
        modulation += 0.2 * np.cos(2 * np.pi * SPEED * 23 / 59 * t + b)
        x += amplitude * modulation * np.sin(2 * np.pi * 23 * harmonic * SPEED * t + c)
    return x, x + np.std(x) * 10**-0.5 * random.normal(size=len(t))


def impacts(random, defect):
    """Return impacts at a defect's order within 1.5 %, with slip, modulated as the defect is."""
    period = 1 / (SPEED * ORDERS[defect] * (1 + random.uniform(-0.015, 0.015)))
    turning = {'outer': 0.0, 'inner': SPEED, 'element': SPEED * ORDERS['cage']}[defect]
    ring = np.arange(76) / RATE
    ring = np.exp(-1200 * ring) * np.sin(2 * np.pi * random.uniform(2500, 4500) * ring)
    x, at, phase = np.zeros(int(RATE)), random.uniform(0, period), random.uniform(0, 2 * np.pi)
    while at < 0.99:
        strength = 1 + 0.8 * np.cos(2 * np.pi * turning * at + phase) if turning else 1.0
        first = int(at * RATE)
        x[first : first + len(ring)] += strength * ring
        at += period * (1 + 0.01 * random.normal())
    return x


@pytest.mark.parametrize('defect', ['', 'outer', 'inner', 'element'])
def test_each_defect_is_named_in_95_percent_of_spans(defect):
    random = np.random.default_rng(3)
    named = []
    for _ in range(SPANS):
        tones, x = gearbox(random)
        if defect:
            fault = impacts(random, defect)
            x += fault * np.std(tones) / np.std(fault) * 10**-0.5
        span = Span(0.0, 1.0, {'a': Signal(x, RATE, 0.0)}, {})
        named.append(SpanAnalysis(MACHINE).analyse(span).bearings['a', 'B'].named)
    assert named.count(defect) >= 0.95 * SPANS


def lines(**levels):
    """Return lines of defects by height [dB], the amplitude following the height."""
    return {
        name: DefectLine(ORDERS[name], level, 10 ** (level / 20)) for name, level in levels.items()
    }


def test_nothing_is_named_below_10_dB():
    assert name_defect(lines(outer=9.0, inner=3.0), 0.03) == ''


def test_two_defects_that_stand_out_alike_are_undecided():
    assert name_defect(lines(outer=20.0, inner=17.0), 0.03) == 'undecided'
    assert name_defect(lines(outer=24.0, inner=17.0), 0.03) == 'outer'


def test_a_sideband_of_the_stronger_is_no_rival():
    found = lines(inner=20.0, element=18.0)
    found['element'] = found['element']._replace(order=ORDERS['inner'] - 1)
    assert name_defect(found, 0.03) == 'inner'
