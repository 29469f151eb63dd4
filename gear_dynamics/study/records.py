"""Records of motions with tangent vectors, run in stretches, so that long ones show progress."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics import dynamics
from gear_dynamics.study.operating_point import OperatingPoint
from gear_dynamics.study.outcome import Arrays
from gear_dynamics.study.tasks import Runner, chunks

STRETCH = 60_000
"""Mesh cycles in a stretch, of all its motions together: about a second on a core."""


def stretch_task(
    point: OperatingPoint, states: np.ndarray, vectors: np.ndarray, cycles: int
) -> Arrays:
    """Return sections, growth and divergence of n motions, and where they end."""
    run = dynamics.run_cycles(
        [point.pair] * len(states),
        point.speed,
        point.load_torque,
        cycles,
        states=states,
        vectors=vectors,
    )
    return {
        'sections': point.scaled(run.sections),
        'growth': run.growth,
        'divergence': run.divergence,
        'states': run.states,
        'vectors': run.vectors,
    }


def nearby_task(point: OperatingPoint, states: np.ndarray, cycles: int) -> Arrays:
    """Return the growth between each of n motions and one nearby."""
    pairs = [point.pair] * len(states)
    return {'nearby': dynamics.nearby_growth(pairs, point.speed, point.load_torque, cycles, states)}


def records(
    points: Sequence[OperatingPoint],
    states: Sequence[np.ndarray],
    transient: int,
    cycles: int,
    runner: Runner,
    label: str,
) -> list[Arrays]:
    """Return for each point the records of n motions after a transient.

    Parameters
    ----------
    points : sequence of OperatingPoint
    states : sequence of (n, STATES) arrays
        Where the motions of each begin.
    transient, cycles : int
        Mesh cycles before and in the records.
    runner : Runner
    label : str
        Of the progress bar.

    Returns
    -------
    list of dict
        `sections`, `growth` and `divergence` along the records; `states` at their ends; `nearby`,
        the growth between two nearby motions over `nearby_cycles` more.
    """
    # Where a motion goes on from leaves rounding: stretches are as long wherever it runs.
    most = max(STRETCH // len(states[0]), 1)
    before = chunks(transient, most)
    stretches = [*before, *chunks(cycles, most)]
    groups = chunks(len(states[0]), 1 if runner.at_once else len(states[0]))
    which = [point for point in points for _ in groups]
    begins = [each[group] for each in states for group in groups]
    pair = points[0].pair
    ends = [
        {'states': each, 'vectors': dynamics.first_tangent_vectors(len(each), pair=pair)}
        for each in begins
    ]
    done = []
    with runner.progress((len(stretches) + 1) * len(which), label):
        for part in stretches:
            arguments = [
                {
                    'point': point,
                    'states': end['states'],
                    'vectors': end['vectors'],
                    'cycles': part.stop - part.start,
                }
                for point, end in zip(which, ends, strict=True)
            ]
            ends = runner.run(stretch_task, arguments)
            done.append(ends)
        arguments = [
            {'point': point, 'states': end['states'], 'cycles': nearby_cycles(cycles)}
            for point, end in zip(which, ends, strict=True)
        ]
        nearby = runner.run(nearby_task, arguments)
    joined = [
        _joined([stretch[i] for stretch in done[len(before) :]]) | nearby[i]
        for i in range(len(which))
    ]
    return [
        {name: np.concatenate([each[name] for each in joined[part]]) for name in joined[0]}
        for part in chunks(len(joined), len(groups))
    ]


def nearby_cycles(cycles: int) -> int:
    """Return over how many cycles two nearby motions are compared, beside a record of `cycles`.

    It checks the tangent vectors, which needs no more than 10 000 cycles.
    """
    return min(max(cycles // 5, 200), 10_000)


def _joined(stretches: Sequence[Arrays]) -> Arrays:
    along = ('sections', 'growth', 'divergence')
    joined = {name: np.concatenate([each[name] for each in stretches], axis=1) for name in along}
    return joined | {'states': stretches[-1]['states']}
