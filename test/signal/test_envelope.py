import numpy as np
import pytest

from gear_dynamics.signal.cepstrum import power_cepstrum
from gear_dynamics.signal.envelope import (
    envelope,
    envelope_spectrum,
    kurtogram,
    most_impulsive_band,
    spectral_kurtosis,
)

RATE = 20480.0
T = np.arange(20480) / RATE


def test_envelope_of_a_modulated_tone_is_the_modulation():
    modulation = 2.0 * (1 + 0.4 * np.cos(2 * np.pi * 25 * T))
    x = modulation * np.sin(2 * np.pi * 4000 * T)
    np.testing.assert_allclose(envelope(x, RATE, 3000, 5000), modulation, rtol=1e-9)


def test_envelope_spectrum_shows_the_modulation_and_not_what_lies_outside_the_band():
    x = (1 + 0.4 * np.cos(2 * np.pi * 25 * T)) * np.sin(2 * np.pi * 4000 * T)
    x += 5 * np.sin(2 * np.pi * 100 * T)
    frequency, amplitude = envelope_spectrum(x, RATE, 3000, 5000)
    assert frequency[np.argmax(amplitude)] == 25
    assert amplitude.max() == pytest.approx(0.4, rel=1e-6)


def test_spectral_kurtosis_of_noise_is_zero_and_of_a_tone_minus_one():
    noise = np.random.default_rng(0).normal(size=400_000)
    _, of_noise = spectral_kurtosis(noise, RATE)
    # 3100 segments, of which half are independent: standard error sqrt(4 / 1550) = 0.05
    assert np.abs(of_noise[1:-1]).mean() < 0.15
    assert np.mean(of_noise[1:-1]) == pytest.approx(0, abs=0.05)
    frequency, of_tone = spectral_kurtosis(np.sin(2 * np.pi * 1600 * T), RATE)
    assert of_tone[np.argmin(np.abs(frequency - 1600))] == pytest.approx(-1, abs=1e-6)


def test_kurtogram_finds_the_band_of_hidden_impacts():
    rng = np.random.default_rng(3)
    x = rng.normal(size=len(T))
    ringing = np.exp(-np.arange(200) / 30) * np.sin(2 * np.pi * 6400 / RATE * np.arange(200))
    for start in range(100, len(T) - 200, 1024):
        x[start : start + 200] += 6 * ringing
    band = most_impulsive_band(x, RATE)
    assert band.low <= 6400 <= band.high
    assert band.high - band.low < 4000
    assert band.kurtosis > 1


def test_kurtogram_covers_halves_and_thirds():
    widths = {round(RATE / 2 / (band.high - band.low)) for band in kurtogram(T, RATE, levels=3)}
    assert widths == {1, 2, 3, 4, 6, 8}


def test_an_empty_band_is_refused():
    with pytest.raises(ValueError, match='5000 to 4000 Hz'):
        envelope(T, RATE, 5000, 4000)


def test_cepstrum_of_an_echo():
    # log|1 + a z^-q|^2 = 2 Re sum (-1)^(k+1) a^k / k z^-kq: a at q, -a^2/2 at 2 q.
    x = np.random.default_rng(4).normal(size=1 << 16)
    echo = x + 0.5 * np.roll(x, 300)
    quefrency, of_echo = power_cepstrum(echo, RATE, window='boxcar')
    _, of_source = power_cepstrum(x, RATE, window='boxcar')
    added = of_echo - of_source
    assert quefrency[300] == pytest.approx(300 / RATE)
    assert added[300] == pytest.approx(0.5, abs=0.02)
    assert added[600] == pytest.approx(-0.125, abs=0.02)
