import numpy as np
import pytest

from gear_dynamics.signal.decimation import ATTENUATION, PASS_BAND, Decimator, lowpass_taps


@pytest.mark.parametrize('ratio', [2, 5, 20, 64])
def test_lowpass_is_flat_below_and_stops_above(ratio):
    response = np.abs(np.fft.rfft(lowpass_taps(ratio), 2**18))
    share = np.fft.rfftfreq(2**18) * ratio  # of the decimated rate
    # A stop band of 60 dB means a ripple of 0.001 in the pass band of a windowed sinc.
    assert np.abs(response[share <= PASS_BAND] - 1).max() < 2e-3
    assert response[share >= 1 - PASS_BAND].max() < 10 ** (-ATTENUATION / 20)


@pytest.mark.parametrize('ratio', [1, 2, 20])
def test_how_the_stream_is_cut_does_not_matter(ratio):
    random = np.random.default_rng(1)
    stream = random.normal(size=(5000, 3))
    whole = Decimator(ratio).feed(stream, 11)
    pieces, cut = Decimator(ratio), 0
    numbers, values = [], []
    while cut < len(stream):
        length = int(random.integers(1, 700))
        number, value = pieces.feed(stream[cut : cut + length], 11 + cut)
        numbers.append(number)
        values.append(value)
        cut += length
    assert np.array_equal(whole[0], np.concatenate(numbers))
    assert np.abs(whole[1] - np.concatenate(values)).max() < 1e-14


def test_slow_sine_comes_out_in_phase_at_the_numbers_given():
    ratio, frequency = 20, 0.1 / 20  # a tenth of the decimated rate
    stream = np.sin(2 * np.pi * frequency * np.arange(100, 20100))[:, None]
    numbers, values = Decimator(ratio).feed(stream, 100)
    assert np.all(numbers % ratio == 0)
    assert np.all(np.diff(numbers) == ratio)
    settled = slice(20, None)
    expected = np.sin(2 * np.pi * frequency * numbers[settled])
    assert np.abs(values[settled, 0] - expected).max() < 2e-3


def test_what_would_fold_is_gone():
    # 1.1 of the decimated rate would fold to 0.1 of it.
    stream = np.sin(2 * np.pi * 1.1 / 20 * np.arange(20000))[:, None]
    _, values = Decimator(20).feed(stream, 0)
    assert np.abs(values[20:]).max() < 10 ** (-ATTENUATION / 20)


def test_constant_stays_constant_from_the_first_value():
    decimator = Decimator(20)
    _, values = decimator.feed(np.full((2000, 1), 7.0), 0)
    assert values == pytest.approx(7.0, abs=1e-12)
    decimator.reset()
    numbers, values = decimator.feed(np.full((2000, 1), -3.0), 40)
    assert numbers[0] == 40
    assert values == pytest.approx(-3.0, abs=1e-12)


def test_ratio_one_passes_all():
    stream = np.arange(10.0)[:, None]
    numbers, values = Decimator(1).feed(stream, 5)
    assert np.array_equal(numbers, np.arange(5, 15))
    assert np.array_equal(values, stream)
