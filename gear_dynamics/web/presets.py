"""Machines to choose on the page."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.run_settings import RunSettings


@dataclasses.dataclass(frozen=True)
class Preset:
    """A machine and how it runs.

    Attributes
    ----------
    name : str
    pair_file : str
        Name of a file of config/.
    values : mapping of str to float
        speed, load_torque and friction_coefficient.
    faults : mapping of str to mapping
        Severity, wheel and tooth by kind of fault.
    """

    name: str
    pair_file: str
    values: Mapping[str, float]
    faults: Mapping[str, Mapping[str, float | str]] = dataclasses.field(default_factory=dict)


_DEFAULT = {
    'speed': RunSettings().speed,
    'load_torque': RunSettings().load_torque,
    'friction_coefficient': GearPair().friction_coefficient,
}
_CHAOS = {'speed': 2287.74553, 'load_torque': 455.5147}
"""The operating point of config/friction_chaos.yaml."""

PRESETS = (
    Preset('default pair', 'default.yaml', _DEFAULT),
    Preset('quiet rig', 'quiet.yaml', _DEFAULT),
    Preset(
        'quiet rig, cracked tooth',
        'quiet.yaml',
        _DEFAULT,
        {'root_crack': {'severity': 0.5, 'wheel': 'gear', 'tooth': 17}},
    ),
    Preset('chaos, no friction', 'friction_chaos.yaml', {**_CHAOS, 'friction_coefficient': 0.0}),
    Preset('friction 0.03', 'friction_chaos.yaml', {**_CHAOS, 'friction_coefficient': 0.03}),
    Preset('friction 0.05', 'friction_chaos.yaml', {**_CHAOS, 'friction_coefficient': 0.05}),
)


def preset_of(name: str) -> Preset:
    """Return the preset of a name; KeyError if there is none."""
    return {preset.name: preset for preset in PRESETS}[name]
