"""Bearing defects of a channel in a span: the lines of each, and which one wins clearly."""

from __future__ import annotations

import numpy as np
from scipy import fft

from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Bearing
from gear_dynamics.monitoring.spans.data import BearingState, Signal
from gear_dynamics.monitoring.spans.gears import Angles
from gear_dynamics.signal.bearing import (
    HARMONICS,
    DefectLine,
    envelope_orders,
    find_defect,
)
from gear_dynamics.signal.demodulation import most_impulsive_band
from gear_dynamics.signal.interpolation import ACCURATE_BAND

LEAST_LEVEL = 10.0
"""Least height of the three lines [dB] of a defect that is named."""

LEAD = 6.0
"""Height, and amplitude, by which a defect must exceed every other [dB]."""


LEVELS = 4
"""Deepest level of the kurtogram: bands of a sixteenth of 0.4 of the sample rate."""

FEWEST_FOR_ENVELOPE = 1024
"""Samples that an envelope spectrum needs."""

FEWEST_SAMPLES, IMPACTS = 16384, 30
"""Samples, and impacts, by which the band of the envelope is chosen at least."""


def bearing_state(
    signal: Signal, angles: Angles, bearing: Bearing, machine: Machine
) -> BearingState | None:
    """Return what a channel shows of a bearing; None if it is too short or sampled too slowly.

    The band with the most impacts and the full band are both tried; the one in which a defect
    stands out most is taken for all defects.
    """
    known, revolutions = angles.at(bearing.shaft, signal)
    # The Fourier transforms of a length with large prime factors are slow.
    length = _fast_length(len(revolutions))
    values, revolutions = signal.values[known][:length], revolutions[:length]
    if length < FEWEST_FOR_ENVELOPE or not np.ptp(values) > 0:
        return None
    speed = (revolutions[-1] - revolutions[0]) / (length - 1) * signal.rate
    highest = 1.1 * HARMONICS * max(bearing.orders.values())
    if highest * speed > ACCURATE_BAND * signal.rate:
        return None
    explained = explained_orders(bearing, machine, highest)
    states = []
    for low, high in _bands(values, signal.rate, speed, bearing):
        spectrum = envelope_orders(values, signal.rate, revolutions, low, high, highest)
        lines = {
            each: find_defect(spectrum, order, bearing.slip, explained)
            for each, order in bearing.orders.items()
        }
        named = name_defect(lines, spectrum.width)
        states.append(BearingState(lines, named, spectrum, (low, high)))
    return max(states, key=_greatest)


def _fast_length(count: int) -> int:
    """Return the greatest length up to `count` of which Fourier transforms are fast."""
    for length in range(count, max(count - 512, 0), -1):
        if fft.next_fast_len(length, real=True) == length:
            return length
    return count


def _greatest(state: BearingState) -> float:
    return max((line.level for line in state.lines.values() if line.level == line.level), default=0)


def _bands(
    values: np.ndarray, rate: float, speed: float, bearing: Bearing
) -> list[tuple[float, float]]:
    # A band must hold three harmonics of the impacts on either side of its centre.
    least = 3 * speed * max(bearing.impacts)
    length = int(max(FEWEST_SAMPLES, IMPACTS * rate / (speed * min(bearing.impacts))))
    chosen = most_impulsive_band(values[:length], rate, LEVELS, least_width=least)
    bands = [(0.0, rate / 2)]
    if np.isfinite(chosen.kurtosis) and chosen.high - chosen.low < 0.79 * rate / 2:
        bands.append((chosen.low, chosen.high))
    return bands


def explained_orders(bearing: Bearing, machine: Machine, highest: float) -> np.ndarray:
    """Return the orders, of the bearing's shaft, at which shafts and meshes have lines.

    All orders of the shaft itself, the first three of the others that turn with it, and the mesh
    lines.
    """
    root, ratio = machine.root(bearing.shaft)
    orders = [np.arange(1, int(highest) + 1, dtype=float)]
    for shaft in machine.shafts:
        its_root, its_ratio = machine.root(shaft.name)
        if its_root.name == root.name and shaft.name != bearing.shaft:
            orders.append(np.arange(1, 4) * float(its_ratio / ratio))
    for mesh in machine.meshes:
        wheel = machine.wheel(mesh.driver)
        its_root, its_ratio = machine.root(wheel.shaft)
        if its_root.name == root.name:
            order = wheel.teeth * float(its_ratio / ratio)
            orders.append(np.arange(1, int(highest / order) + 1) * order)
    return np.unique(np.concatenate(orders))


def name_defect(lines: dict[str, DefectLine], width: float) -> str:
    """Return the defect that wins clearly, `undecided`, or nothing.

    A race fault that is modulated by the shaft has lines at all sums of its harmonics and shaft
    orders, and the orders of outer and inner race add up to a whole number: in a long record the
    lines of another defect may then stand out of the noise as well. They are weaker, so that the
    amplitudes must be close too before two defects count as rivals.

    Parameters
    ----------
    lines : dict of str to DefectLine
    width : float
        Half width of a line [orders].
    """
    standing = {name: line for name, line in lines.items() if line.level >= LEAST_LEVEL}
    if not standing:
        return ''
    first = max(standing, key=lambda name: standing[name].level + _decibel(standing[name]))
    winner = standing[first]
    for name, line in standing.items():
        rival = line.level > winner.level - LEAD and _decibel(line) > _decibel(winner) - LEAD
        if name != first and rival and not _explained_by(line, winner, width):
            return 'undecided'
    return first


def _decibel(line: DefectLine) -> float:
    return 20 * float(np.log10(max(line.amplitude, 1e-300)))


def _explained_by(line: DefectLine, stronger: DefectLine, width: float) -> bool:
    """Return whether a harmonic of a line is a harmonic or sideband of a stronger defect's."""
    families = np.array(
        [k * stronger.order + j for k in range(5) for j in range(-3, 4)], dtype=float
    )
    harmonics = line.order * np.arange(1, HARMONICS + 1)
    return bool(np.min(np.abs(harmonics[:, np.newaxis] - families)) < width)
