"""What the demo tells: read out of the log, in plain words and as a picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import ndimage, signal

from gear_dynamics.bag.reader import read_log
from gear_dynamics.parameters.settings import SimSettings

SETTLED = 4.0
"""The end of each part, in which the motion has settled at its speed [s]."""

AVERAGED = 1.0
"""What an averaged spectrum spans at most, from its stamp on [s]."""

RAMP = 10
"""Blocks before a change of 5 %, at which the speed had not begun to change."""

SHOWN_CYCLES = 8
"""Mesh cycles of the waveform in the picture."""

PER_TOOTH = 64
"""Points of the synchronous average for each tooth."""


class Part(NamedTuple):
    """What was logged at one speed.

    Attributes
    ----------
    rpm : float
        Pinion speed [1/min].
    expected, found : float
        Mesh frequency: of the teeth and the speed, and in the spectrum [Hz].
    waveform : ndarray
        Columns t [s] and pinion_ay [m/s2], a few mesh cycles.
    spectrum : ndarray
        Columns frequency [Hz] and pinion_ay [m/s2].
    section : ndarray
        Columns x and y, one row for each mesh cycle.
    average : ndarray
        Synchronous average of pinion_ay over the pinion's angle, less that of the mean tooth
        [m/s2]; `PER_TOOTH` points a tooth.
    """

    rpm: float
    expected: float
    found: float
    waveform: np.ndarray
    spectrum: np.ndarray
    section: np.ndarray
    average: np.ndarray

    def loudest_place(self) -> float:
        """Return where the average is greatest, in teeth of the pinion from angle 0 on."""
        return float(abs(self.average).argmax() / PER_TOOTH)


def read_parts(log: Path, teeth: int) -> tuple[list[Part], int]:
    """Return what was logged between the changes of speed, and the number of gaps.

    Parameters
    ----------
    log : Path
        Bag folder.
    teeth : int
        Of the pinion.
    """
    settings = SimSettings()
    samples = read_log(log, columns=('t', 'speed'))
    gaps = np.count_nonzero(np.diff(samples['t']) > 1.5 / settings.sample_rate)
    # Averaged by blocks, since the shaft's speed carries the vibration of its rotation.
    blocks = len(samples) // settings.block_size
    speed = samples['speed'][: blocks * settings.block_size].reshape(blocks, -1).mean(axis=1)
    rising = int(np.argmax(speed > 1.05 * speed[0])) - RAMP
    falling = int(np.flatnonzero(speed > 0.95 * speed.max())[-1]) - RAMP
    command = read_log(log, 'gear_pair/cmd/speed')['data'][0]
    ends = [samples['t'][block * settings.block_size] for block in (rising, falling)]
    speeds = (settings.speed, command, settings.speed)
    parts = [
        _read_part(log, end, teeth, each)
        for end, each in zip((*ends, samples['t'][-1]), speeds, strict=True)
    ]
    return parts, int(gaps)


def _read_part(log: Path, end: float, teeth: int, speed: float) -> Part:
    mesh = teeth * speed / (2 * math.pi)
    settled, shown = end - SETTLED, end - SHOWN_CYCLES / mesh
    columns = ('t', 'frequency', 'pinion_ay')
    spectra = read_log(log, 'gear_pair/spectrum', settled, end - AVERAGED, columns)
    spectrum = spectra[spectra['t'] == spectra['t'][-1]]
    turns = read_log(log, 'gear_pair/samples', settled, end, ('pinion_angle', 'pinion_ay'))
    return Part(
        rpm=speed * 30 / math.pi,
        expected=mesh,
        found=mesh_frequency(spectrum['frequency'], spectrum['pinion_ay']),
        waveform=read_log(log, 'gear_pair/samples', shown, end, ('t', 'pinion_ay')),
        spectrum=spectrum,
        section=read_log(log, 'gear_pair/poincare', settled, end, ('x', 'y')),
        average=_synchronous_average(turns['pinion_angle'], turns['pinion_ay'], teeth),
    )


def _synchronous_average(angle: np.ndarray, signal: np.ndarray, teeth: int) -> np.ndarray:
    """Return the mean of a signal over a wheel's angle, less that of the mean tooth."""
    count = teeth * PER_TOOTH
    place = np.minimum((angle / (2 * math.pi) * count).astype(int), count - 1)
    hits = np.maximum(np.bincount(place, minlength=count), 1)
    mean = np.bincount(place, signal, minlength=count) / hits
    return mean - np.tile(mean.reshape(teeth, PER_TOOTH).mean(axis=0), teeth)


def mesh_frequency(frequency: np.ndarray, amplitude: np.ndarray) -> float:
    """Find the frequency of which the lines of a spectrum are multiples.

    The lines are the peaks that stand out of their surroundings. The comb that is chosen has the
    widest spacing of those which meet nearly all of the lines: a comb half as wide meets them too.

    Parameters
    ----------
    frequency : ndarray
        Equally spaced [Hz].
    amplitude : ndarray
        In any unit.

    Returns
    -------
    float
        Spacing of the comb, fitted to the lines weighted by their amplitudes [Hz]; NaN if no
        line stands out.
    """
    bin_width = frequency[1] - frequency[0]
    surroundings = ndimage.median_filter(amplitude, 65)
    least = np.maximum(5 * surroundings, 0.01 * amplitude.max())
    peaks, _ = signal.find_peaks(amplitude, height=least)
    if not len(peaks):
        return math.nan
    # The peak of a windowed line is a parabola in decibels, nearly.
    left, top, right = (np.log(amplitude[peaks + shift]) for shift in (-1, 0, 1))
    at = frequency[peaks] + bin_width * 0.5 * (left - right) / (left - 2 * top + right)
    weight = amplitude[peaks]
    for spacing in np.sort((at[:, np.newaxis] / np.arange(1, 9)).ravel())[::-1]:
        multiple = np.maximum(np.round(at / spacing), 1)
        met = abs(at - multiple * spacing) < bin_width
        if weight[met].sum() > 0.9 * weight.sum():
            weight = weight * met
            return float((weight * multiple * at).sum() / (weight * multiple**2).sum())
    return math.nan
