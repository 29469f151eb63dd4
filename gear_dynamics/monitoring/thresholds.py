"""Alarm levels of indicators, by limits from a YAML file, with hysteresis."""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gear_dynamics.parameters.yaml_text import YamlError, read_yaml


class ThresholdError(ValueError):
    """A threshold file cannot be used; the message says where and why in one line."""


class Level(enum.IntEnum):
    """How bad a value is; the numbers are those of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


@dataclasses.dataclass(frozen=True)
class Limit:
    """From which value on an indicator is in WARN and in ERROR; infinite for never."""

    warn: float = math.inf
    error: float = math.inf


class Thresholds:
    """Limits by indicator, and the level each indicator is in at present.

    A level is entered at its limit and left when the value has fallen below the limit by the
    share `hysteresis` of it, so that a value at the limit does not make the alarm flicker.

    Parameters
    ----------
    limits : mapping of str to Limit
        By `CHANNEL/NAME`; `*/NAME` is for every channel that has no limit of its own.
    hysteresis : float
        0 to below 1.
    """

    def __init__(self, limits: Mapping[str, Limit], hysteresis: float = 0.1) -> None:
        self._limits = dict(limits)
        self._hysteresis = hysteresis
        self._levels: dict[str, Level] = {}

    @classmethod
    def from_yaml(cls, path: str | Path) -> Thresholds:
        """Read `hysteresis` and `limits` from a file.

        Raises
        ------
        ThresholdError
            If the file cannot be read or says something that is not a limit.
        """
        try:
            content = read_yaml(path)
        except YamlError as error:
            raise ThresholdError(f'{path}: {error}') from None
        if not isinstance(content, dict) or not set(content) <= {'hysteresis', 'limits'}:
            raise ThresholdError(f'{path}: it must be a mapping of hysteresis and limits')
        hysteresis = _number(path, 'hysteresis', content.get('hysteresis', 0.1))
        if not 0 <= hysteresis < 1:
            raise ThresholdError(f'{path}: hysteresis is {hysteresis:g}: it must be in [0, 1)')
        limits = content.get('limits') or {}
        if not isinstance(limits, dict):
            raise ThresholdError(f'{path}: limits must be a mapping by CHANNEL/NAME')
        return cls(
            {str(key): _limit(path, key, value) for key, value in limits.items()}, hysteresis
        )

    @property
    def names(self) -> tuple[str, ...]:
        """What has a limit."""
        return tuple(self._limits)

    def level(self, channel: str, name: str, value: float) -> Level:
        """Return the level of an indicator with its new value; NaN is OK, for it says nothing."""
        key = f'{channel}/{name}'
        limit = self._limits.get(key) or self._limits.get(f'*/{name}')
        if limit is None:
            return Level.OK
        held = self._levels.get(key, Level.OK)
        level = Level.OK
        for candidate, bound in ((Level.WARN, limit.warn), (Level.ERROR, limit.error)):
            if value >= (bound * (1 - self._hysteresis) if held >= candidate else bound):
                level = candidate
        self._levels[key] = level
        return level


def _limit(path: str | Path, key: Any, value: Any) -> Limit:
    if str(key).count('/') != 1:
        raise ThresholdError(f'{path}: limit {key!r} must be named CHANNEL/NAME or */NAME')
    if not isinstance(value, dict) or not value or not set(value) <= {'warn', 'error'}:
        raise ThresholdError(f'{path}: {key} must be a mapping of warn and error')
    limit = Limit(**{word: _number(path, f'{key} {word}', bound) for word, bound in value.items()})
    if 'warn' in value and limit.warn > limit.error:
        raise ThresholdError(f'{path}: {key}: warn {limit.warn:g} is above error {limit.error:g}')
    return limit


def _number(path: str | Path, name: str, value: Any) -> float:
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not (math.isfinite(number) and number >= 0):
        raise ThresholdError(f'{path}: {name} is {value!r}: it must be a number of 0 or more')
    return number
