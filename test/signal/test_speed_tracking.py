import numpy as np
import pytest

from gear_dynamics.signal.speed_tracking import track_speed

RATE = 12800.0


def vibration(duration, drift, noise=0.5):
    """Return a mesh of 34 teeth at 17 revolutions/s, the shaft's true angle, and the time."""
    t = np.arange(int(duration * RATE)) / RATE
    swing = 17 * drift / 2 * duration / (2 * np.pi)
    angle = 17 * t + swing * (1 - np.cos(2 * np.pi * t / duration))
    x = np.cos(2 * np.pi * 34 * angle) + 0.5 * np.cos(2 * np.pi * 68 * angle + 1)
    x += 0.2 * np.cos(2 * np.pi * 33 * angle) + 0.2 * np.cos(2 * np.pi * 35 * angle)
    return x + noise * np.random.default_rng(2).normal(size=len(t)), angle, t


@pytest.mark.parametrize(('duration', 'drift'), [(1.0, 0.0), (1.0, 0.02), (4.0, 0.02), (10.0, 0)])
def test_the_angle_follows_the_mesh_line(duration, drift):
    x, angle, t = vibration(duration, drift)
    line = track_speed(x, RATE, 15.0, 19.0, [34, 68], 1.0)
    inside = (t > 0.05) & (t < line.phase.end - 0.05)
    error = line.phase.at(t[inside]) - angle[inside]
    # 0.002 revolutions are a quarter of a radian of the mesh line, which costs 3 % of it.
    assert np.std(error) < 5e-4
    assert line.phase.speed == pytest.approx(angle[-1] / t[-1], rel=5e-4)
    assert not line.at_limit


def test_the_uncertainty_covers_the_error():
    errors, stated = [], []
    for seed in range(8):
        t = np.arange(int(2 * RATE)) / RATE
        x = np.cos(2 * np.pi * 400 * t) + np.random.default_rng(seed).normal(size=len(t))
        line = track_speed(x, RATE, 19.0, 21.0, [20], 1.0)
        errors.append(line.phase.speed - 20)
        stated.append(line.uncertainty)
    assert np.std(errors) < 4 * np.mean(stated)
    assert np.std(errors) > 0.1 * np.mean(stated)


def test_a_speed_at_the_limit_of_its_range_is_flagged():
    x, _, _ = vibration(2.0, 0.0)
    assert track_speed(x, RATE, 17.05, 19.0, [34], 1.0).at_limit


def test_noise_has_no_line():
    noise = np.random.default_rng(3).normal(size=int(RATE))
    with pytest.raises(ValueError, match='no line stands out from 900 to 1140 rpm'):
        track_speed(noise, RATE, 15.0, 19.0, [34], 1.0)


def test_lines_beyond_the_sample_rate_are_refused():
    with pytest.raises(ValueError, match='half of the sample rate'):
        track_speed(np.zeros(1000), 1000.0, 15.0, 19.0, [34], 1.0)
