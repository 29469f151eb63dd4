import numpy as np
import pytest
from scipy import signal

from gear_dynamics.signal.demodulation import (
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
    assert np.abs(of_noise).mean() < 0.15
    assert np.mean(of_noise) == pytest.approx(0, abs=0.05)
    # Real lines are Gaussian too, with a standard error of sqrt(96 / 1550) = 0.25.
    assert of_noise[[0, -1]] == pytest.approx(0, abs=0.75)
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
    noise = np.random.default_rng(5).normal(size=len(T))
    bands = kurtogram(noise, RATE, levels=3)
    assert {round(0.4 * RATE / (band.high - band.low)) for band in bands} == {1, 2, 3, 4, 6, 8}
    assert max(band.high for band in bands) <= 0.4 * RATE


def test_an_empty_band_is_refused():
    with pytest.raises(ValueError, match='5000 to 4000 Hz'):
        envelope(T, RATE, 5000, 4000)


def test_the_jump_from_the_last_to_the_first_sample_is_no_impact():
    # A tone that does not close on itself, in faint noise: nothing in it is impulsive.
    x = np.sin(2 * np.pi * 100.3 * T[:8192]) + 0.02 * np.random.default_rng(6).normal(size=8192)
    # 20 with the jump; the narrowest band has 49 samples within its ends, and scatters.
    assert most_impulsive_band(x, RATE).kurtosis < 3


def test_a_band_without_power_is_not_chosen():
    # The impulsive band lies 80 dB below the rest.
    rng = np.random.default_rng(7)
    x = signal.sosfilt(signal.butter(8, 2000, output='sos', fs=RATE), rng.normal(size=len(T)))
    burst = np.zeros(len(T))
    burst[5000:5040] = 1e-5 * np.sin(2 * np.pi * 6000 * T[:40])
    assert most_impulsive_band(x + burst, RATE).low < 4000


def test_the_least_width_is_kept_and_the_full_band_is_always_there():
    x = np.random.default_rng(8).normal(size=len(T))
    assert min(b.high - b.low for b in kurtogram(x, RATE, least_width=900.0)) >= 900.0
    assert len(kurtogram(x, RATE, least_width=RATE)) == 1


def test_a_constant_has_no_impulsive_band():
    assert np.isnan(most_impulsive_band(np.ones(1000), RATE).kurtosis)
