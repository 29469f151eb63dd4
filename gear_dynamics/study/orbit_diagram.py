"""Orbit diagrams: how the motion changes with a parameter, swept up and down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gear_dynamics.model.cycles import run_cycles
from gear_dynamics.study.exponents import standard_error
from gear_dynamics.study.initial import first_variations, scattered_states
from gear_dynamics.study.kind import kind_of
from gear_dynamics.study.operation import FREQUENCY_RATIO, Operation
from gear_dynamics.study.outcome import Outcome
from gear_dynamics.study.tasks import Arrays, Runner, chunks

ALIGN = 25
"""Cycles in which the variations turn into their directions, before growth is counted."""

FOLLOWED = 20
"""Values that one task follows."""

MEASURED = 60
"""Motions that one task measures."""

IN_A_ROW = 3
"""Neighbouring values that must be chaotic to count as a range of chaos."""

UP, DOWN = 0, 1


def follow_task(operations: list[list[Operation]], states: np.ndarray, cycles: int) -> Arrays:
    """Return the states after `cycles` at each value, each begun where the last one ended.

    operations : one list of chains for each value; states : (chains, STATES) array.
    """
    ends = np.empty((len(operations), *states.shape))
    for i, chains in enumerate(operations):
        pairs, speeds, torques = unzip(chains)
        states = run_cycles(pairs, speeds, torques, cycles, states=states).states
        ends[i] = states
    return {'states': ends}


def measure_task(operations: list[Operation], states: np.ndarray, cycles: int) -> Arrays:
    """Return section, largest exponent with its error, and the sum rule's error of motions."""
    pairs, speeds, torques = unzip(operations)
    vectors = first_variations(len(operations))
    run = run_cycles(pairs, speeds, torques, cycles, states=states, vectors=vectors)
    length = np.array([each.cycle for each in operations])
    rates = run.growth[:, ALIGN:, 0] / length[:, np.newaxis]
    sections = [
        each.scaled(section) for each, section in zip(operations, run.sections, strict=True)
    ]
    return {
        'sections': np.array(sections),
        'exponent': rates.mean(axis=1),
        'standard_error': np.array([standard_error(each) for each in rates]),
        'sum_error': run.growth.sum(axis=(1, 2)) / run.divergence.sum(axis=1) - 1,
    }


def unzip(operations: Sequence[Operation]) -> tuple[list, np.ndarray, np.ndarray]:
    """Return pairs, speeds and load torques as `run_cycles` takes them."""
    return (
        [each.pair for each in operations],
        np.array([each.speed for each in operations]),
        np.array([each.load_torque for each in operations]),
    )


def bifurcation(
    operation: Operation,
    frictions: Sequence[float] = (0.0, 0.03),
    *,
    parameter: str = FREQUENCY_RATIO,
    begin: float = 0.4,
    end: float = 2.0,
    count: int = 600,
    transient: int = 300,
    cycles: int = 150,
    runner: Runner | None = None,
) -> Outcome:
    """Return the orbit diagrams and largest exponents along a parameter, up and down.

    Parameters
    ----------
    operation : Operation
    frictions : sequence of float
        Friction coefficients to compare; if `parameter` is friction_coefficient, one row.
    parameter : str
        What is swept: w, speed, load_torque or a parameter of the pair.
    begin, end : float
        Range, in the parameter's own unit; both ends belong to it.
    count : int
        Values.
    transient, cycles : int
        Mesh cycles before and in the record at each value. The next value begins where the
        transient of this one ended.
    runner : Runner, optional

    Raises
    ------
    ParameterError
        If the parameter cannot be varied or a value is out of its range.
    ValueError
        If the record is too short.
    """
    if cycles < ALIGN + 64:
        raise ValueError(f'{cycles} cycles are too few: give {ALIGN + 64} or more')
    runner = runner or Runner()
    if parameter == 'friction_coefficient':
        frictions = [operation.pair.friction_coefficient]
    values = np.linspace(begin, end, count)
    chains = _chains(operation, frictions, parameter, values)
    states = follow(chains, transient, runner)
    arguments = [
        {'operations': chain[part], 'states': start[part], 'cycles': cycles}
        for chain, start in zip(chains, states, strict=True)
        for part in chunks(count, MEASURED)
    ]
    results = runner.run(measure_task, arguments, 'orbits and exponents')
    shape = (len(frictions), 2, count)
    arrays = {
        name: np.concatenate([result[name] for result in results]).reshape(
            *shape, *results[0][name].shape[1:]
        )
        for name in results[0]
    }
    # Chains that were swept down are turned round: axis 2 is along `values` for all.
    arrays = {
        name: np.stack([array[:, UP], array[:, DOWN, ::-1]], axis=1)
        for name, array in arrays.items()
    }
    arrays |= {'values': values, 'friction': np.array(frictions), 'parameter': np.array(parameter)}
    arrays['kind'] = _kinds(arrays)
    return Outcome('bifurcation', _text(arrays), _table(arrays), arrays)


def _chains(
    operation: Operation, frictions: Sequence[float], parameter: str, values: np.ndarray
) -> list[list[Operation]]:
    chains = []
    for mu in frictions:
        rubbing = operation.with_value('friction_coefficient', mu)
        chain = [rubbing.with_value(parameter, float(value)) for value in values]
        chains += [chain, chain[::-1]]
    return chains


def follow(chains: list[list[Operation]], cycles: int, runner: Runner) -> np.ndarray:
    """Return the state after the transient for each chain and value, (chains, values, STATES)."""
    states = np.concatenate([scattered_states(chain[0], 1) for chain in chains])
    parts = []
    arranged = list(map(list, zip(*chains, strict=True)))
    for part in runner.track(chunks(len(arranged), FOLLOWED), 'following'):
        argument = {'operations': arranged[part], 'states': states, 'cycles': cycles}
        followed = runner.run(follow_task, [argument])[0]['states']
        states = followed[-1]
        parts.append(followed)
    return np.concatenate(parts).swapaxes(0, 1)


def _kinds(arrays: dict[str, np.ndarray]) -> np.ndarray:
    exponent, error = arrays['exponent'], arrays['standard_error']
    words = [
        kind_of(arrays['sections'][at], exponent[at], error[at]).words
        for at in np.ndindex(exponent.shape)
    ]
    return np.array(words).reshape(exponent.shape)


def chaotic_ranges(values: np.ndarray, kinds: np.ndarray) -> list[tuple[float, float]]:
    """Return the first and last of the values in each stretch of IN_A_ROW or more with chaos."""
    chaotic = np.concatenate([[False], kinds == 'chaotic', [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(chaotic) == 1), np.flatnonzero(np.diff(chaotic) == -1)
    return [
        (float(values[begin]), float(values[end - 1]))
        for begin, end in zip(begins, ends, strict=True)
        if end - begin >= IN_A_ROW
    ]


def _text(arrays: dict[str, np.ndarray]) -> str:
    values, parameter = arrays['values'], arrays['parameter']
    lines = [f'{parameter} from {values[0]:g} to {values[-1]:g}, {len(values)} values', '']
    for mu, kinds, sections in zip(
        arrays['friction'], arrays['kind'], arrays['sections'], strict=True
    ):
        for direction, kind in zip(('up', 'down'), kinds, strict=True):
            ranges = [f'{first:.4g} to {last:.4g}' for first, last in chaotic_ranges(values, kind)]
            words = 'chaos at ' + ', '.join(ranges) if ranges else 'no chaos'
            share = np.mean(kind == 'chaotic')
            lines.append(f'mu = {mu:g}, swept {direction}: {words} ({share:.1%} of the values)')
        apart = np.mean(_differs(sections))
        lines.append(f'mu = {mu:g}: up and down differ at {apart:.1%} of the values')
    worst = np.abs(arrays['sum_error']).max()
    lines += ['', f'The sum of the exponents differs from the mean divergence by {worst:.1e} of it']
    return '\n'.join(lines)


def _differs(sections: np.ndarray) -> np.ndarray:
    """Return where the two directions end on different attractors, by the mean of delta / b."""
    mean, spread = sections[..., 0].mean(axis=-1), sections[..., 0].std(axis=-1)
    count = sections.shape[-2]
    return np.abs(mean[UP] - mean[DOWN]) > 0.01 + 4 * spread.max(axis=0) / np.sqrt(count)


def _table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    shape = arrays['exponent'].shape
    mu, direction, value = np.meshgrid(
        arrays['friction'], ['up', 'down'], arrays['values'], indexing='ij'
    )
    delta = arrays['sections'][..., 0]
    columns = {
        f'{arrays["parameter"]}': value,
        'friction_coefficient [1]': mu,
        'swept': direction,
        'kind': arrays['kind'],
        'largest_exponent [1/tau]': arrays['exponent'],
        'standard_error [1/tau]': arrays['standard_error'],
        'least_delta [b]': delta.min(axis=-1),
        'greatest_delta [b]': delta.max(axis=-1),
        'sum_error [1]': arrays['sum_error'],
    }
    return {name: column.reshape(np.prod(shape)) for name, column in columns.items()}
