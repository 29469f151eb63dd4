"""Runs of a whole hunting-tooth period, whose lines fall on bins."""

import numpy as np

import gear_dynamics as gd

SHAFT = 20.0
"""Rotation of the pinion [Hz]."""

PINION_TEETH, GEAR_TEETH = 34, 59
"""No common factor: the same teeth meet again after 59 revolutions of the pinion."""

PER_CYCLE = 75
"""Samples in a mesh cycle: what folds stays on the same lines."""

RATE = PER_CYCLE * PINION_TEETH * SHAFT
PERIOD = PER_CYCLE * PINION_TEETH * GEAR_TEETH
"""Samples in a hunting-tooth period. In its bins the pinion shaft has order 59, the gear shaft 34
and the mesh 59 x 34."""

MESH = PINION_TEETH * GEAR_TEETH

QUIET = gd.GearPair(
    pinion_bore=0.03,
    gear_bore=0.05,
    mesh_stiffness='potential_energy',
    transmission_error_amplitude=5e-6,
    friction_coefficient=0.0,
)
"""config/quiet.yaml without friction, with which the drive would take seconds to settle."""


def period(pair, faults=(), load_torque=150.0, settle=6, rtol=1e-9, speed=SHAFT):
    """Return the samples of one hunting-tooth period in steady state, from mesh phase 0 on.

    The first sample of each cycle is left out, by repeating the next: it lies on the instant at
    which a tooth pair enters, just before or after by the rounding of time.
    """
    first = settle * PER_CYCLE * PINION_TEETH
    run = gd.simulate(
        pair,
        (first + PERIOD) / (RATE * speed / SHAFT),
        sample_rate=RATE * speed / SHAFT,
        speed=2 * np.pi * speed,
        load_torque=load_torque,
        faults=faults,
        anti_alias=False,
        rtol=rtol,
        atol=1e-12,
    )
    samples = np.roll(run.samples[first:], first)
    samples[::PER_CYCLE] = samples[1::PER_CYCLE]
    return samples


def lines(signal):
    """Return complex peak amplitudes by bin."""
    return np.fft.rfft(signal) * 2 / len(signal)


def average(signal, teeth):
    """Return the synchronous average of a wheel over the period, less the mean tooth."""
    turns = MESH // teeth
    mean = signal.reshape(turns, -1).mean(axis=0)
    return mean - np.tile(mean.reshape(teeth, -1).mean(axis=0), teeth)
