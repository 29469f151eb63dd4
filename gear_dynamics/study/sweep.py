"""Sweeps of a parameter, each value continued from the last, and the motions that they pass."""

from __future__ import annotations

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.run_settings import RunSettings
from gear_dynamics.study.assessment import assess
from gear_dynamics.study.exponent_tables import EXPONENT_UNITS
from gear_dynamics.study.operating_point import OperatingPoint, unzip
from gear_dynamics.study.outcome import Arrays
from gear_dynamics.study.tasks import Runner, chunks

FOLLOWED = 20
"""Values that one task follows."""

MEASURED = 60
"""Motions that one task measures."""

UP, DOWN = 0, 1

UNITS = {
    'sections': 'b, b wn',
    **EXPONENT_UNITS,
    'discarded': 'cycles',
    'kind': '-',
    'period': 'cycles',
    'zero_one': '1',
}
"""What `measure` returns of each motion."""


def unit_of(parameter: str) -> str:
    """Return the unit of a parameter that can be swept; 1 for a pure number."""
    known = {a.name: a.unit for a in (*RunSettings.parameters(), *GearPair.parameters())}
    return known.get(parameter) or '1'


def check_range(**ends: float) -> None:
    """Refuse a range that does not begin below its end.

    ends : the beginning and the end, by their names.

    Raises
    ------
    ParameterError
        If it does not.
    """
    (first, begin), (last, end) = ends.items()
    if not begin < end:
        raise ParameterError(f'{first} {begin:g} is not below {last} {end:g}: exchange them')


def chain_along(point: OperatingPoint, parameter: str, values: np.ndarray) -> list[OperatingPoint]:
    """Return the point with each value of a parameter."""
    return [point.with_value(parameter, float(value)) for value in values]


def follow_task(points: list[list[OperatingPoint]], states: np.ndarray, cycles: int) -> Arrays:
    """Return the states after `cycles` at each value, each begun where the last one ended.

    points : one list of chains for each value; states : (chains, STATES) array.
    """
    ends = np.empty((len(points), *states.shape))
    for i, chains in enumerate(points):
        states = dynamics.run_cycles(*unzip(chains), cycles, states=states).states
        ends[i] = states
    return {'states': ends}


def follow(
    chains: list[list[OperatingPoint]], states: np.ndarray, cycles: int, runner: Runner
) -> np.ndarray:
    """Return the state after the transient for each chain and value, (chains, values, STATES).

    states : (chains, STATES) array
        Where each chain begins.
    """
    parts = []
    arranged = list(map(list, zip(*chains, strict=True)))
    pieces = chunks(len(arranged), FOLLOWED)
    groups = chunks(len(chains), 1 if runner.at_once else len(chains))
    with runner.progress(len(pieces) * len(groups), 'following'):
        for part in pieces:
            arguments = [
                {
                    'points': [value[group] for value in arranged[part]],
                    'states': states[group],
                    'cycles': cycles,
                }
                for group in groups
            ]
            results = runner.run(follow_task, arguments)
            followed = np.concatenate([result['states'] for result in results], axis=1)
            states = followed[-1]
            parts.append(followed)
    return np.concatenate(parts).swapaxes(0, 1)


def measure_task(points: list[OperatingPoint], states: np.ndarray, cycles: int) -> Arrays:
    """Return what `assess` finds of the motions, by the names of UNITS."""
    assessed = assess(points, states, cycles)
    return {name: assessed[name] for name in UNITS}


def measure(
    chains: list[list[OperatingPoint]], states: np.ndarray, cycles: int, runner: Runner
) -> Arrays:
    """Return what the motions do from the states that `follow` found, (chains, values, ...)."""
    count = len(chains[0])
    arguments = [
        {'points': chain[part], 'states': start[part], 'cycles': cycles}
        for chain, start in zip(chains, states, strict=True)
        for part in chunks(count, MEASURED)
    ]
    results = runner.run(measure_task, arguments, 'orbits and exponents')
    joined = {name: np.concatenate([result[name] for result in results]) for name in UNITS}
    return {
        name: each.reshape(len(chains), count, *each.shape[1:]) for name, each in joined.items()
    }


def by_value(chains: np.ndarray) -> np.ndarray:
    """Return (n, direction, values, ...) of 2 n chains in the order of their sweeps: up, down."""
    array = chains.reshape(-1, 2, *chains.shape[1:])
    return np.stack([array[:, UP], array[:, DOWN, ::-1]], axis=1)
