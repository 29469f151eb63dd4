"""The angle of a shaft from a line of its own vibration, where there is no tachometer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from gear_dynamics.signal.arguments import positive, real_series
from gear_dynamics.signal.shaft_phase import ShaftPhase

LEAST_HEIGHT = 8.0
"""Height over its surroundings that the line must have [dB]."""


GAIN = 1.7
"""Height [dB] that a line must gain with each doubling of the frames to count as steady in them;
one in noise that is perfectly steady gains 3 dB."""


PHASE_NOISE = 0.15
"""Standard deviation of the phase of a line [rad] by noise, to which the low-pass is narrowed."""


ANGLE_NOISE = 0.002
"""Likewise of the angle [revolutions]: orders of a hundred are of use then."""


class TrackedLine(NamedTuple):
    """An angle that was tracked.

    Attributes
    ----------
    phase : ShaftPhase
    uncertainty : float
        Standard deviation of the mean speed, by the noise beside the line [revolutions/s].
    height : float
        Of the lines over their surroundings [dB].
    at_limit : bool
        Whether the speed stays at a limit of the range, so that the true one may lie beyond.
    """

    phase: ShaftPhase
    uncertainty: float
    height: float
    at_limit: bool


def track_speed(
    x: npt.ArrayLike,
    rate: float,
    lowest: float,
    highest: float,
    orders: Sequence[float],
    bandwidth: float,
    start: float = 0.0,
) -> TrackedLine:
    """Return the angle of a shaft by the lines of given orders.

    First the speed by the maximum of the lines together, in a spectrogram whose steps it may
    change between by one line (Viterbi 1967). Then the strongest of the lines is demodulated by
    that speed, and its phase, low-passed, completes the angle (Bonnardot et al. 2005, Use of the
    acceleration signal of a gearbox in order to perform angular resampling).

    Parameters
    ----------
    x : array_like, shape (n,)
    rate : float
        [Hz]
    lowest, highest : float
        Range of the speed [revolutions/s].
    orders : sequence of float
        Lines that move with the shaft, in events a revolution.
    bandwidth : float
        Distance of the nearest other line that is to be kept out [orders].
    start : float
        Time of the first sample [s].

    Raises
    ------
    ValueError
        If no line stands out, or a value is not finite.
    """
    x, rate = real_series(x).astype(float, copy=False), positive(rate, 'rate')
    orders = [order for order in orders if order * highest < 0.45 * rate]
    if not orders:
        raise ValueError('all lines to track lie beyond half of the sample rate')
    count = min(len(x), fft.next_fast_len(int(2.6 * max(orders) * highest * len(x) / rate) + 256))
    slow_rate = rate * count / len(x)
    slow = signal.resample(x - np.mean(x), count)
    found = _coarse(slow, slow_rate, lowest, highest, orders)
    if not found.height >= LEAST_HEIGHT:
        raise ValueError(
            f'no line stands out from {60 * lowest:g} to {60 * highest:g} rpm: the best is '
            f'{found.height:.1f} dB above its surroundings, {LEAST_HEIGHT:g} dB are needed'
        )
    instants = np.arange(count) / slow_rate
    speed = np.interp(instants, found.times, found.speeds)
    phase = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / (2 * slow_rate))])
    # The phase changes no faster than frames of the best length can follow.
    width = min(0.4 * bandwidth * speed.min(), 4 / found.frame)
    # Twice: what is left of the phase after the first time is even at both ends.
    for _ in range(2):
        phase, uncertainty = _refine(slow, slow_rate, phase, found.order, width)
    step = max(1, int(slow_rate / (16 * max(width, 4 * slow_rate / count))))
    kept = slice(0, count, min(step, max(1, count // 64)))
    return TrackedLine(
        ShaftPhase(start + instants[kept], phase[kept]), uncertainty, found.height, found.at_limit
    )


class _Path(NamedTuple):
    """Speeds at times; height [dB] and order of the best line; the flag; frame length [s]."""

    times: np.ndarray
    speeds: np.ndarray
    height: float
    order: float
    at_limit: bool
    frame: float


def _coarse(
    x: np.ndarray, rate: float, lowest: float, highest: float, orders: list[float]
) -> _Path:
    """Return the path of that length of frames in which the lines stand out most.

    A steady line gains with the length of the frames; one that moves is smeared in long ones.
    """
    shortest = max(int(min(0.5 * rate, len(x) / 4)), int(16 * rate / (max(orders) * highest)))
    length = min(shortest, len(x))
    best = _path_of_frames(x, rate, lowest, highest, orders, length)
    doublings = 0
    while length < len(x):
        length = len(x) if 2 * length > 0.75 * len(x) else 2 * length
        doublings += 1
        path = _path_of_frames(x, rate, lowest, highest, orders, length)
        if path.height >= best.height + GAIN * doublings:
            best, doublings = path, 0
    return best


def _path_of_frames(
    x: np.ndarray, rate: float, lowest: float, highest: float, orders: list[float], length: int
) -> _Path:
    hop = max(1, length // 4)
    padded = fft.next_fast_len(4 * length, real=True)
    frequency, times, lines = signal.stft(
        x, rate, 'hann', length, length - hop, padded, boundary=None, padded=False
    )
    decibel = 10 * np.log10(np.abs(lines) ** 2 + 1e-300)
    step = frequency[1]
    count = int(np.ceil((highest - lowest) * max(orders) / step)) + 2
    grid = np.linspace(lowest, highest, max(count, 16))
    scores = []
    for order in orders:
        places = order * grid / step
        near = _interpolated(decibel, places)
        width = max(int(0.5 * order * (highest - lowest) / step), 24)
        low = max(int(places[0]) - width, 1)
        scores.append(near - np.median(decibel[low : int(places[-1]) + width], axis=0))
    path = _best_path(np.mean(scores, axis=0))
    heights = [float(np.mean(score[path, np.arange(len(path))])) for score in scores]
    best = int(np.argmax(heights))
    at_edge = np.mean((path <= 1) | (path >= len(grid) - 2))
    return _Path(times, grid[path], heights[best], orders[best], bool(at_edge > 0.5), length / rate)


def _interpolated(table: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return rows of a table at fractional places."""
    below = np.clip(places.astype(int), 0, len(table) - 2)
    share = (places - below)[:, np.newaxis]
    return (1 - share) * table[below] + share * table[below + 1]


def _best_path(score: np.ndarray, reach: int = 3) -> np.ndarray:
    """Return the row of each column on the path of the greatest sum, moving by few rows a step."""
    rows, columns = score.shape
    best = score[:, 0].copy()
    back = np.zeros((columns, rows), dtype=int)
    penalty = 0.3
    for column in range(1, columns):
        padded = np.pad(best, reach, constant_values=-np.inf)
        moves = np.stack(
            [padded[m : m + rows] - penalty * abs(m - reach) for m in range(2 * reach + 1)]
        )
        chosen = moves.argmax(axis=0)
        back[column] = np.arange(rows) + chosen - reach
        best = moves.max(axis=0) + score[:, column]
    path = np.empty(columns, dtype=int)
    path[-1] = int(best.argmax())
    for column in range(columns - 1, 0, -1):
        path[column - 1] = back[column, path[column]]
    return path


def _refine(
    x: np.ndarray, rate: float, coarse: np.ndarray, order: float, width: float
) -> tuple[np.ndarray, float]:
    """Return the angle by the phase of one line, and the uncertainty of its mean speed."""
    duration = len(x) / rate
    # Mirrored at both ends, so that the low-pass sees no jump from the end to the beginning.
    reach = min(int(2 * rate / width), len(x) - 1)
    mixed = np.pad(x * np.exp(-2j * np.pi * order * coarse), reach, mode='reflect')
    lines = fft.fft(mixed)
    frequency = np.abs(fft.fftfreq(len(mixed), 1 / rate))
    beside = (frequency > width * 1.2) & (frequency < width * 2.4)
    if not np.any(beside):
        beside = frequency > width
    # Power of the noise in 1 Hz, and of the line without it.
    density = float(np.mean(np.abs(lines[beside]) ** 2)) / len(mixed) / rate
    power = float(np.sum(np.abs(lines[frequency <= width]) ** 2)) / len(mixed) ** 2
    power = max(power - 2 * width * density, density / duration)
    # In noise only a narrower band leaves a phase that tells of the line.
    allowed = min(PHASE_NOISE, 2 * np.pi * order * ANGLE_NOISE)
    width = min(width, allowed**2 * power / density)
    least = 1.5 / duration
    slow = fft.ifft(lines * np.exp(-((frequency / max(width, least)) ** 8)))
    left = np.unwrap(np.angle(slow[reach : reach + len(x)])) / (2 * np.pi * order)
    if width < least:
        # Not even so: the speed is taken as constant over what there is.
        width = least
        left = np.polyval(np.polyfit(np.arange(len(x)), left, 1), np.arange(len(x)))
    sigma = np.sqrt(density * width / power)
    independent = max(2 * width * duration, 2)
    speed = sigma / (2 * np.pi * order) * np.sqrt(12 / independent) / duration
    return coarse + left, float(speed)
