"""The studies as the command line knows them: what they do, and their options."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

PRESET = 'config/friction_chaos.yaml'
DEFAULT = 'the default pair'


class Option(NamedTuple):
    """An option of a study, and the argument of the same name of its function.

    Attributes
    ----------
    default : int, float, str, tuple or list
        What the function takes if it is not given; its type is the option's. A tuple takes as many
        values, a list one or more.
    text : str
        For the help.
    least : float
        Least value allowed; any number must be finite.
    """

    default: Any
    text: str
    least: float = -math.inf

    def check(self, name: str, value: Any) -> None:
        """Refuse a number that is not allowed.

        Raises
        ------
        ValueError
            With the option's name, the value, and what is allowed.
        """
        if isinstance(value, str):
            return
        least = f', {self.least:g} or more' if math.isfinite(self.least) else ''
        kind = 'an integer' if isinstance(value, int) else 'a finite number'
        if not (math.isfinite(value) and value >= self.least):
            option = name.replace('_', '-')
            raise ValueError(f'--{option} is {value:g}: it must be {kind}{least}')


class Study(NamedTuple):
    """What the command line knows of a study.

    Attributes
    ----------
    summary : str
    operation : str
        Function of `gear_dynamics.study` that gives what is studied without --params.
    options : dict of str to Option
    sweeps : str
        What is swept, if anything is; an option `parameter` may name another.
    """

    summary: str
    operation: str
    options: dict[str, Option]
    sweeps: str = ''


_TRANSIENT = 'mesh cycles before each record'
_COUNT = 'values in the range'

STUDIES = {
    'spectrum': Study(
        'RMS and mesh harmonics with and without friction, and a map over phase and speed',
        'default_operation',
        {
            'frictions': Option((0.0, 0.03), 'two friction coefficients to compare'),
            'phases': Option(24, 'phases of the transmission error in the map; 0 for no map', 0),
            'speeds': Option(40, 'speeds in the map', 1),
            'slowest': Option(20.0, 'lowest speed of the map [rad/s]'),
            'fastest': Option(1200.0, 'highest speed of the map [rad/s]'),
            'transient': Option(300, _TRANSIENT, 0),
        },
    ),
    'lyapunov': Study(
        'all Lyapunov exponents with standard errors, from several initial states',
        'friction_chaos',
        {
            'frictions': Option([0.0, 0.03, 0.05], 'friction coefficients to compare'),
            'initial_states': Option(6, 'initial states for each friction coefficient', 1),
            'transient': Option(500, _TRANSIENT, 0),
            'cycles': Option(10000, 'mesh cycles in each record', 100),
        },
    ),
    'bifurcation': Study(
        'orbit diagrams and largest exponents along a parameter, swept up and down',
        'friction_chaos',
        {
            'frictions': Option([0.0, 0.03], 'friction coefficients to compare, if not swept'),
            'parameter': Option(
                'w', 'what is swept: w, speed, load_torque or a parameter of the pair'
            ),
            'begin': Option(0.4, 'beginning of the range; must be given unless w is swept'),
            'end': Option(2.0, 'end of the range; must be given unless w is swept'),
            'count': Option(600, _COUNT, 2),
            'transient': Option(300, _TRANSIENT, 0),
            'cycles': Option(150, 'mesh cycles in each record', 100),
        },
        sweeps='w',
    ),
    'attractor': Study(
        'history, spectrum, phase portrait, section and exponents of one motion',
        'friction_chaos',
        {
            'frictions': Option([0.0, 0.03, 0.05], 'friction coefficients to compare'),
            'transient': Option(1000, _TRANSIENT, 0),
            'cycles': Option(4000, 'mesh cycles in the record', 100),
        },
    ),
    'basins': Study(
        'which attractor each initial state reaches',
        'friction_chaos',
        {
            'size': Option(80, 'initial states along each side of the picture', 2),
            'reach': Option((2.0, 1.0), 'greatest delta / b and delta_dot / (b wn), above 0'),
            'transient': Option(400, _TRANSIENT, 0),
        },
    ),
    'response': Study(
        'RMS and peaks against speed, swept up and down, with the jumps',
        'default_operation',
        {
            'begin': Option(0.05, 'lowest mesh frequency over wn'),
            'end': Option(1.5, 'highest mesh frequency over wn'),
            'count': Option(300, _COUNT, 2),
            'transient': Option(1000, _TRANSIENT, 0),
        },
        sweeps='w',
    ),
}
