import numpy as np
import pytest
from scipy import signal

from gear_dynamics.signal.segments import SegmentBuffer
from gear_dynamics.signal.spectrum import (
    PowerAverage,
    amplitude_spectrum,
    mean_square_lines,
    window_samples,
)

RATE = 51200.0


def sine(amplitude, frequency, count, phase=0.3):
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(count) / RATE + phase)


@pytest.mark.parametrize('offset', [0.0, 0.17, 0.3, 0.5, 0.81])
def test_flat_top_reads_a_sine_within_a_thousandth_wherever_it_lies(offset):
    frequency = (500 + offset) * RATE / 8192
    _, amplitude = amplitude_spectrum(
        sine(2.5, frequency, 32768), RATE, window='flattop', length=8192
    )
    assert amplitude.max() == pytest.approx(2.5, rel=1e-3)


@pytest.mark.parametrize('window', ['boxcar', 'hann', 'blackman', 'flattop'])
def test_a_sine_on_a_line_reads_its_amplitude_and_rms(window):
    x = sine(3.0, 100 * RATE / 4096, 4096)
    frequency, peak = amplitude_spectrum(x, RATE, window=window)
    _, rms = amplitude_spectrum(x, RATE, window=window, scale='rms')
    assert frequency[100] == 100 * RATE / 4096
    assert peak[100] == pytest.approx(3.0, rel=1e-12)
    assert rms[100] == pytest.approx(3.0 / np.sqrt(2), rel=1e-12)


def test_the_mean_and_the_nyquist_line_read_their_value():
    _, amplitude = amplitude_spectrum(2.0 + 0.5 * (-1.0) ** np.arange(1024), RATE, window='boxcar')
    assert amplitude[0] == pytest.approx(2.0)
    assert amplitude[-1] == pytest.approx(0.5)


def test_two_tones_of_two_channels_keep_apart():
    first = sine(1.0, 625.0, 8192)
    second = sine(1e-3, 6250.0, 8192)
    _, amplitude = amplitude_spectrum(np.stack([first + second, second], axis=1), RATE)
    line, other = 100, 1000
    assert amplitude[line, 0] == pytest.approx(1.0, rel=1e-9)
    assert amplitude[other, 0] == pytest.approx(1e-3, rel=1e-6)
    assert amplitude[line, 1] < 1e-12


def test_a_swept_tone_reads_as_the_same_energy():
    # A chirp of constant amplitude has mean square A^2 / 2, spread over the band it sweeps.
    t = np.arange(65536) / RATE
    x = signal.chirp(t, 1000.0, t[-1], 5000.0)
    frequency, rms = amplitude_spectrum(x, RATE, window='boxcar', scale='rms')
    inside = (frequency > 900) & (frequency < 5100)
    assert np.sum(rms[inside] ** 2) == pytest.approx(0.5, rel=1e-2)


@pytest.mark.parametrize('length', [1000, 1001])
def test_parseval(length):
    x = np.random.default_rng(1).normal(size=length)
    lines = mean_square_lines(x[:, np.newaxis], np.ones(length))
    assert lines.sum() == pytest.approx(np.mean(x**2), rel=1e-12)


def test_linear_average_equals_scipy_welch():
    x = np.random.default_rng(2).normal(size=20000)
    frequency, rms = amplitude_spectrum(x, RATE, length=1024, scale='rms')
    expected_frequency, power = signal.welch(
        x, RATE, nperseg=1024, scaling='spectrum', detrend=False
    )
    np.testing.assert_allclose(frequency, expected_frequency)
    np.testing.assert_allclose(rms**2, power, rtol=1e-10)


def test_exponential_average_forgets_by_its_count():
    # Mean square 1 for two spectra, then 0 with weight 1/4 each: (3/4)^3.
    average = PowerAverage('exponential', 4)
    for _ in range(4):
        average.add(np.ones((1, 1)))
    for _ in range(3):
        average.add(np.zeros((1, 1)))
    assert average.mean_square[0, 0] == pytest.approx(0.75**3)


def test_segments_do_not_depend_on_how_the_rows_arrive():
    x = np.arange(10000.0)[:, np.newaxis]
    expected = [x[start : start + 700] for start in range(0, 10000 - 699, 300)]
    for step in (1, 64, 999, 10000):
        buffer = SegmentBuffer(700, 300, 1)
        found = [
            segment.copy()
            for start in range(0, 10000, step)
            for segment in buffer.push(x[start : start + step])
        ]
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ({'window': 'nonsense'}, 'nonsense'),
        ({'overlap': 1.0}, 'overlap is 1'),
        ({'averaging': 'median'}, 'median'),
        ({'scale': 'power'}, 'power'),
        ({'length': 4096}, 'fewer than one segment of 4096'),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        amplitude_spectrum(np.zeros(1000), RATE, **arguments)


def test_window_is_scipys_apart_from_the_flat_top():
    np.testing.assert_array_equal(window_samples('hann', 64), signal.get_window('hann', 64))
