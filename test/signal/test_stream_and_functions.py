"""The online engine gives what the plain functions give on the same record."""

import numpy as np
import pytest
from monitoring.streams import RATE, RIG, START_NS, blocks, rotation, samples

from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import ConditionResult, TableResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings
from gear_dynamics.signal import indicators
from gear_dynamics.signal.order_tracking import (
    mesh_phase,
    order_spectrum,
    pinion_inertia_share,
    resample_by_phase,
)
from gear_dynamics.signal.synchronous import separate, synchronous_average

POINTS = 128  # in a cycle: the power of two above the samples in it, 51200 / 566.7


@pytest.fixture(scope='module')
def record():
    """A signal with a bad tooth of either wheel, its phase, and the results of its stream."""
    angle = rotation(4.5, turned=1.0)
    signal = np.cos(34 * angle) + 0.2 * np.cos(35 * angle)
    for turned, order in ((angle, 90), (angle * 34 / 59, 150)):
        tooth = np.exp(-((np.mod(turned, 2 * np.pi) - 2.0) ** 2) / 0.01)
        signal += tooth * np.cos(order * turned)
    rig = samples(angle, gear_ay=signal)
    sent = list(blocks(rig))
    monitor = Monitor(AnalyzerSettings(), Thresholds({}))
    monitor.configure(RIG)
    results = [result for stamp, rows in sent for result in monitor.add_block(stamp, rows)]
    rows = np.concatenate([rows for _, rows in sent])
    share = pinion_inertia_share(RIG.pinion_inertia, RIG.gear_inertia, 34, 59)
    phase = mesh_phase(rows['pinion_angle'], rows['gear_angle'], 34, 59, share)
    return rows['gear_ay'].astype(float), phase, results


def test_order_spectrum(record):
    signal, phase, results = record
    table = next(r for r in results if isinstance(r, TableResult) and r.name == 'order_spectrum')
    first = round((table.span.start_ns - START_NS) / 1e9 * RATE)
    # The stream's segments begin at its first point, 16 samples after its start.
    assert first in (16, 17)
    revolutions = 7 * 4 + 8  # 8 segments of 8 revolutions, each half over the one before
    begin, _ = resample_by_phase(signal, phase, POINTS)
    last = np.searchsorted(phase, (begin + revolutions * 34 * POINTS) / POINTS)
    order, amplitude = order_spectrum(signal[: last + 16], phase[: last + 16], 34, points=POINTS)
    np.testing.assert_allclose(table.rows['order'], order, rtol=1e-6)
    # The stream transforms in single precision.
    np.testing.assert_allclose(table.rows['gear_ay'], amplitude, atol=1e-5)


@pytest.mark.parametrize(('wheel', 'teeth', 'revolutions'), [('pinion', 34, 59), ('gear', 59, 34)])
def test_synchronous_average(record, wheel, teeth, revolutions):
    signal, phase, results = record
    row = next(
        row
        for result in results
        if isinstance(result, ConditionResult)
        for row in result.rows
        if row.subject == 'gear_ay' and f'{wheel}_fm4' in row.values
    )
    begin, values = resample_by_phase(signal, phase, POINTS)
    length = teeth * POINTS
    # Both wheels of the stream were at angle 0 together: their zeros of phase are one.
    skipped = -begin % length
    average = synchronous_average(values[skipped : skipped + revolutions * length], length)
    parts = separate(average, teeth)
    expected = {
        'fm0': indicators.fm0(average, teeth),
        'fm4': indicators.fm4(parts.difference),
        'energy_ratio': indicators.energy_ratio(parts),
        'sideband_index': indicators.sideband_index(average, teeth),
        'na4': indicators.RunningKurtosis().add(parts.residual),
    }
    for name, value in expected.items():
        assert row.values[f'{wheel}_{name}'] == pytest.approx(float(value), rel=1e-6, abs=1e-8), (
            name
        )
