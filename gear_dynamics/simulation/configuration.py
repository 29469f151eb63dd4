"""The YAML text of `gear_pair/configuration`, which tells listeners what the rig is."""

from __future__ import annotations

import dataclasses
import math

import yaml

from gear_dynamics.machine.rig import rig_machine
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.versions import versions


def configuration_text(pair: GearPair, settings: SimSettings) -> str:
    """Return every parameter, derived quantity and version as YAML.

    The same run gives the same text on any machine with the same versions.

    Parameters
    ----------
    pair : GearPair
    settings : SimSettings
        As they are at present.

    Returns
    -------
    str
        A mapping of `parameters`, `derived` (SI; `mesh_frequency` [Hz] at the commanded speed),
        `machine` (its shafts, wheels, mesh and channels, as in a machine file) and `versions`.
    """
    derived = dataclasses.asdict(pair.derived)
    derived['mesh_frequency'] = pair.pinion_teeth * settings.speed / (2 * math.pi)
    machine = rig_machine(
        pair.pinion_teeth,
        pair.gear_teeth,
        pair.derived.pinion_inertia,
        pair.derived.gear_inertia,
        pair.half_backlash,
        pair.derived.wn,
    )
    content = {
        'parameters': {**pair.to_mapping(), **settings.to_mapping()},
        'derived': derived,
        'machine': machine.to_mapping(),
        'versions': versions(),
    }
    return yaml.safe_dump(content, sort_keys=False)
