"""The simulated gear pair as a machine."""

from __future__ import annotations

import math

from gear_dynamics.machine.channel import Channel
from gear_dynamics.machine.columns import CHANNEL_UNITS
from gear_dynamics.machine.machine import Machine
from gear_dynamics.machine.parts import Mesh, Wheel
from gear_dynamics.machine.shaft import Angle, Shaft
from gear_dynamics.machine.source import Source


def rig_machine(
    pinion_teeth: int,
    gear_teeth: int,
    pinion_inertia: float,
    gear_inertia: float,
    half_backlash: float,
    wn: float,
) -> Machine:
    """Return the machine that the simulator is: two shafts, two wheels, one mesh.

    Parameters
    ----------
    pinion_teeth, gear_teeth : int
    pinion_inertia, gear_inertia : float
        [kg m2]
    half_backlash : float
        [m]
    wn : float
        [rad/s]
    """
    return Machine(
        name='gear_pair',
        channels=tuple(
            Channel(name, Source(name), recorded_unit=unit) for name, unit in CHANNEL_UNITS.items()
        ),
        shafts=(
            Shaft('pinion', Angle(Source('pinion_angle'), 2 * math.pi), pinion_inertia),
            Shaft('gear', Angle(Source('gear_angle'), 2 * math.pi), gear_inertia),
        ),
        wheels=(Wheel('pinion', 'pinion', pinion_teeth), Wheel('gear', 'gear', gear_teeth)),
        meshes=(Mesh('mesh', 'pinion', 'gear', 'delta', 'delta_dot', half_backlash, wn),),
    )
