"""Band-limited output: the filter, tones through it, its delay, and what it keeps from folding."""

import functools

import numpy as np
import pytest
from reference_equations import COLUMNS

from gear_dynamics.integrator.band_limit import BandLimiter, taps
from gear_dynamics.integrator.layout import AX1, DELAY, HIGH_RATE_COLUMNS, OVERSAMPLING, SPEED
from gear_dynamics.machine.columns import CHANNELS, SAMPLE_COLUMNS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.simulation.simulator import Simulator

RATE = 51200.0
HIGH = OVERSAMPLING * RATE
RIPPLE = 10 ** (0.001 / 20) - 1
"""Greatest departure from 1 up to 20 kHz: 0.001 dB."""
STOP = 1e-4
"""80 dB down."""


def response(frequencies):
    """Return the filter's response without its delay."""
    h = taps()
    n = np.arange(len(h)) - len(h) // 2
    return np.exp(-2j * np.pi * np.outer(frequencies, n) / HIGH) @ h


def test_filter_is_flat_to_20_khz_and_80_db_down_from_where_it_folds():
    passed = response(np.linspace(0, 20000, 2001))
    np.testing.assert_allclose(passed, 1, atol=RIPPLE)
    stopped = response(np.linspace(25600, HIGH / 2, 4001))
    assert np.max(np.abs(stopped)) < STOP
    assert response([0.0])[0] == pytest.approx(1, abs=1e-15)


def test_filter_is_of_linear_phase():
    h = taps()
    np.testing.assert_array_equal(h, h[::-1])
    assert len(h) == 2 * DELAY * OVERSAMPLING + 1


def through(signal, count, block):
    """Return `count` samples of a limiter that is fed with signal(t) at the high rate: (2, count).

    One of the columns that are filtered together, and the one that is filtered alone.
    """
    fed, out, shafts = 0, np.zeros((count, len(SAMPLE_COLUMNS))), np.zeros((count, 2))

    def feed(rows):
        nonlocal fed
        rows[:] = signal((fed + np.arange(len(rows))) / HIGH)[:, None]
        fed += len(rows)

    limiter = BandLimiter(block, RATE, feed)
    limiter.start(np.full((1, HIGH_RATE_COLUMNS), signal(np.zeros(1))[0]))
    for begin in range(0, count, block):
        part = out[begin : begin + block]
        limiter.make(part, shafts[: len(part)])
    return out[:, [AX1, SPEED]].T


@pytest.mark.parametrize('frequency', [0.0, 50.0, 4533.3, 12345.0, 19999.0])
def test_tones_in_the_band_pass_at_their_own_instant(frequency):
    got = through(lambda t: np.cos(2 * np.pi * frequency * t + 0.3), 300, 64)
    expected = np.cos(2 * np.pi * frequency * np.arange(300) / RATE + 0.3)
    # The first DELAY samples see the standstill before the start.
    np.testing.assert_allclose(got[:, DELAY:], np.stack([expected[DELAY:]] * 2), atol=RIPPLE)


@pytest.mark.parametrize('frequency', [25700.0, 31200.0, 51200.0, 71000.0, 102000.0])
def test_tones_that_would_fold_are_80_db_down(frequency):
    got = through(lambda t: np.cos(2 * np.pi * frequency * t + 0.3), 300, 64)
    assert np.max(np.abs(got[:, DELAY:])) < STOP


def test_tone_in_the_transition_has_the_gain_of_the_closed_form():
    frequency = 22800.0
    gain = response([frequency])[0].real
    got = through(lambda t: np.cos(2 * np.pi * frequency * t), 300, 17)
    expected = gain * np.cos(2 * np.pi * frequency * np.arange(300) / RATE)
    np.testing.assert_allclose(got[:, DELAY:], np.stack([expected[DELAY:]] * 2), atol=1e-12)


def test_smooth_motion_is_the_same_raw_and_band_limited():
    # Constant stiffness, no friction, no loss: nothing jumps, all is far below 20 kHz.
    pair = GearPair(mesh_stiffness='constant', friction_coefficient=0.0)
    options = {'load_torque': 500.0, 'rtol': 1e-10, 'atol': 1e-13}
    raw = Simulator(pair, anti_alias=False, **options).advance(2000)[500:]
    limited = Simulator(pair, anti_alias=True, **options).advance(2000)[500:]
    np.testing.assert_array_equal(limited['t'], raw['t'])
    np.testing.assert_array_equal(limited['load_torque'], raw['load_torque'])
    for name in ('pinion_angle', 'gear_angle'):
        np.testing.assert_allclose(limited[name], raw[name], atol=1e-12)
    for name in COLUMNS[:8]:
        variation = np.std(raw[name])
        np.testing.assert_allclose(limited[name], raw[name], rtol=0, atol=2 * RIPPLE * variation)


FINE = 64
"""Times the rate at which folding shows what there is below 20 kHz without any filter."""


@functools.cache
def lines_at_8000_rpm(rate_factor, anti_alias):
    """Return the spectrum below 20 kHz of each column."""
    speed, cycles = 8000 * np.pi / 30, 272
    count = round(cycles * 2 * np.pi / (34 * speed) * RATE)
    run = Simulator(GearPair(), speed=speed, sample_rate=rate_factor * RATE, anti_alias=anti_alias)
    run.advance(10240 * rate_factor)
    samples = run.advance(count * rate_factor)
    window = np.hanning(len(samples) + 1)[:-1]
    lines = slice(int(20000 / RATE * count))
    return {
        name: np.fft.rfft(window * samples[name])[lines] / len(samples)
        for name in (*CHANNELS, 'speed')
    }


# What jumps itself folds at FINE times the rate still by one FINE-th, so that no more can be told:
# half of that. The others jump in their derivatives, the third of which nothing is known of, and
# the second of the speed; evaluation at a higher rate alone is good for 5 to 7, 46 and 215.
@pytest.mark.parametrize(
    ('name', 'least'),
    [
        *((name, FINE / 2) for name in CHANNELS[:6]),
        ('delta', 250),
        ('delta_dot', 600),
        ('speed', 80),
    ],
)
def test_folding_at_8000_rpm_is_kept_out(name, least):
    fine = lines_at_8000_rpm(FINE, False)[name]
    raw = np.linalg.norm(lines_at_8000_rpm(1, False)[name] - fine)
    limited = np.linalg.norm(lines_at_8000_rpm(1, True)[name] - fine)
    assert limited < raw / least


@pytest.mark.parametrize('samples_per_cycle', [64, 90, 125])
def test_samples_at_the_instants_of_events_do_not_stand_out(samples_per_cycle):
    # Every so many samples one falls on a mesh event, to either side of it by rounding.
    pair = GearPair(friction_coefficient=0.03)
    speed = 2 * np.pi * RATE / samples_per_cycle / pair.pinion_teeth
    simulator = Simulator(pair, speed=speed)
    simulator.advance(400 * samples_per_cycle)
    force = simulator.advance(200 * samples_per_cycle)['mesh_force']
    cycles = force.reshape(200, samples_per_cycle)
    # A jump on the wrong side of its sample stands out by half a kilonewton.
    assert np.max(np.abs(cycles - cycles.mean(axis=0))) < 1.0


@pytest.mark.parametrize(('rate', 'lines'), [(800.0, 0), (3200.0, 2), (12800.0, 8)])
def test_lower_rates_keep_the_lines_of_their_band_and_no_others(rate, lines):
    # 1000 rpm and no friction: 340 mesh cycles of 566.7 Hz fill 0.6 s, and nothing lies between.
    pair = GearPair(friction_coefficient=0.0)
    spectra = []
    for each in (rate, RATE):
        simulator = Simulator(pair, speed=1000 * np.pi / 30, sample_rate=each)
        simulator.advance(round(0.6 * each))
        samples = simulator.advance(round(0.6 * each))
        spectra.append(np.abs(np.fft.rfft(samples['pinion_ay'])) / len(samples))
    found, fine = spectra
    harmonics = 340 * np.arange(1, lines + 1)
    assert 340 * (lines + 1) / 0.6 > 20 / 51.2 * rate
    np.testing.assert_allclose(found[harmonics], fine[harmonics], rtol=1e-3)
    # 80 dB below the highest line of all: what folds, and what has not died out yet.
    between = np.delete(found[1 : int(20 / 51.2 * rate * 0.6)], harmonics - 1)
    assert between.max() < STOP * fine.max()


def test_low_rates_do_not_depend_on_the_size_of_the_blocks():
    one, other = (Simulator(GearPair(), sample_rate=150.0) for _ in range(2))
    whole = one.advance(60)
    parts = np.concatenate([other.advance(n) for n in (1, 2, 7, 50)])
    np.testing.assert_array_equal(whole, parts)
    np.testing.assert_array_equal(whole['t'], np.arange(60) / 150.0)
