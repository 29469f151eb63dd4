"""Alarm levels of indicators: limits from a YAML file, persistence, hysteresis, latch."""

from __future__ import annotations

import collections
import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from scipy import special

from gear_dynamics.monitoring.level import Level
from gear_dynamics.monitoring.task import Normal
from gear_dynamics.parameters.yaml_text import YamlError, read_yaml

BOUNDS = ('warn', 'error', 'below_warn', 'below_error')
TIMES = ('warn_times', 'error_times')

MOST_CHANGES = 1000


class ThresholdError(ValueError):
    """A threshold file cannot be used; the message says where and why in one line."""


@dataclasses.dataclass(frozen=True)
class Limit:
    """From which value on an indicator is in WARN and in ERROR; infinite for never.

    Attributes
    ----------
    warn, error : float
        Upper limits.
    below_warn, below_error : float
        Lower limits.
    relative : bool
        Whether the limits are multiples of the learned mean. Such a limit does not count until
        the operating bin is learned, and the value must also lie outside what the scatter of the
        learned values explains.
    warn_times, error_times : float
        Where the bin is learned, the upper limits are no less than so many times the learned mean;
        0 for limits that are the same everywhere.
    """

    warn: float = math.inf
    error: float = math.inf
    below_warn: float = -math.inf
    below_error: float = -math.inf
    relative: bool = False
    warn_times: float = 0.0
    error_times: float = 0.0

    @property
    def learns(self) -> bool:
        """Whether the values are learned."""
        return self.relative or max(self.warn_times, self.error_times) > 0


class Change(NamedTuple):
    """An indicator whose level has changed."""

    subject: str
    name: str
    before: Level
    after: Level
    value: float

    def __str__(self) -> str:
        """Return the change in words, on one line."""
        known = '' if math.isnan(self.value) else f' at {self.value:.3g}'
        return f'{self.subject}/{self.name}: {self.before.name} -> {self.after.name}{known}'


@dataclasses.dataclass(frozen=True)
class AlarmRule:
    """How limits become levels.

    Attributes
    ----------
    hysteresis : float
        A level is left when the value is back within its limit by this fraction; 0 to below 1.
    raised, of : int
        A level is taken when `raised` of the last `of` judged values lie beyond its limit.
    latch : bool
        Whether a level is held until it is acknowledged.
    false_alarms : float
        Probability by which a single healthy value may lie beyond a relative limit.
    """

    hysteresis: float = 0.1
    raised: int = 1
    of: int = 1
    latch: bool = False
    false_alarms: float = 1e-3


class Thresholds:
    """Limits by indicator, and the level each indicator is in at present.

    Parameters
    ----------
    limits : mapping of str to Limit
        By `SUBJECT/NAME`; `*/NAME` is for every subject that has no limit of its own.
    hysteresis : float
        0 to below 1.
    rule : AlarmRule, optional
        In place of one with this hysteresis.
    """

    def __init__(
        self, limits: Mapping[str, Limit], hysteresis: float = 0.1, rule: AlarmRule | None = None
    ) -> None:
        self._limits = dict(limits)
        self._rule = AlarmRule(hysteresis) if rule is None else rule
        self._levels: dict[str, Level] = {}
        self._recent: dict[str, collections.deque[Level]] = {}
        self._changes: collections.deque[Change] = collections.deque(maxlen=MOST_CHANGES)

    @classmethod
    def from_yaml(cls, path: str | Path) -> Thresholds:
        """Read `limits`, `hysteresis`, `persistence`, `latch` and `false_alarms` from a file.

        Raises
        ------
        ThresholdError
            If the file cannot be read or says something that is not a limit.
        """
        try:
            content = read_yaml(path)
        except YamlError as error:
            raise ThresholdError(f'{path}: {error}') from None
        if not isinstance(content, dict) or not set(content) <= {'limits', *_RULES}:
            raise ThresholdError(
                f'{path}: it must be a mapping of limits and {", ".join(sorted(_RULES))}'
            )
        limits = content.get('limits') or {}
        if not isinstance(limits, dict):
            raise ThresholdError(f'{path}: limits must be a mapping by SUBJECT/NAME')
        read = {str(key): _limit(path, key, value) for key, value in limits.items()}
        return cls(read, rule=_rule(path, content))

    @property
    def names(self) -> tuple[str, ...]:
        """What has a limit."""
        return tuple(self._limits)

    def limit(self, subject: str, name: str) -> Limit | None:
        """Return the limit of an indicator; None without one."""
        return self._limits.get(f'{subject}/{name}') or self._limits.get(f'*/{name}')

    def held(self, subject: str, name: str) -> Level:
        """Return the level that an indicator is in."""
        return self._levels.get(f'{subject}/{name}', Level.OK)

    def level(
        self,
        subject: str,
        name: str,
        value: float,
        normal: Normal | None = None,
        hold: bool = False,
    ) -> Level:
        """Return the level of an indicator with its new value; NaN leaves it as it was.

        Parameters
        ----------
        subject, name : str
        value : float
        normal : Normal, optional
            What was learned of the indicator in the present operating bin.
        hold : bool
            Whether the level may rise alone, since the fault that raised it is still named.
        """
        limit = self.limit(subject, name)
        if limit is None:
            return Level.OK
        key = f'{subject}/{name}'
        held = self._levels.get(key, Level.OK)
        if math.isnan(value) or (limit.relative and normal is None):
            return held
        recent = self._recent.setdefault(key, collections.deque(maxlen=self._rule.of))
        recent.append(self._momentary(limit, held, value, normal))
        level = Level.OK
        for candidate in (Level.WARN, Level.ERROR):
            if sum(each >= candidate for each in recent) >= self._rule.raised:
                level = candidate
        if self._rule.latch or hold:
            level = max(level, held)
        self._set(subject, name, level, value)
        return level

    def beyond(self, subject: str, name: str, value: float, normal: Normal | None = None) -> bool:
        """Return whether one value lies beyond the first limit, whatever the level is."""
        limit = self.limit(subject, name)
        if limit is None or math.isnan(value) or (limit.relative and normal is None):
            return False
        return self._momentary(limit, Level.OK, value, normal) > Level.OK

    @property
    def rule(self) -> AlarmRule:
        """How limits become levels."""
        return self._rule

    def bounds(self, subject: str, name: str, normal: Normal | None = None) -> dict[str, float]:
        """Return the limits in force: `warn`, `error`, `below_warn`, `below_error` where finite.

        Parameters
        ----------
        subject, name : str
        normal : Normal, optional
            What was learned of the indicator in the present operating bin.
        """
        limit = self.limit(subject, name)
        if limit is None or (limit.relative and normal is None):
            return {}
        found = {}
        for level in (Level.WARN, Level.ERROR):
            word = level.name.lower()
            found[f'below_{word}'], found[word] = self._between(limit, level, normal)
        return {word: bound for word, bound in found.items() if math.isfinite(bound)}

    def _between(self, limit: Limit, level: Level, normal: Normal | None) -> tuple[float, float]:
        """Return between which values an indicator is below a level."""
        word, chance = level.name.lower(), self._rule.false_alarms
        upper = _bound(getattr(limit, word), limit, normal, chance, 1)
        times = getattr(limit, f'{word}_times')
        if times and normal is not None:
            upper = max(upper, times * normal.mean)
        return _bound(getattr(limit, f'below_{word}'), limit, normal, chance, -1), upper

    def _momentary(self, limit: Limit, held: Level, value: float, normal: Normal | None) -> Level:
        level = Level.OK
        for candidate in (Level.WARN, Level.ERROR):
            lower, upper = self._between(limit, candidate, normal)
            inside = self._rule.hysteresis if held >= candidate else 0.0
            if value >= upper - inside * abs(upper) or value <= lower + inside * abs(lower):
                level = candidate
        return level

    def _set(self, subject: str, name: str, level: Level, value: float) -> None:
        key = f'{subject}/{name}'
        before = self._levels.get(key, Level.OK)
        if level != before:
            self._changes.append(Change(subject, name, before, level, value))
        self._levels[key] = level

    def acknowledge(self) -> None:
        """Take all levels back to OK; a value that is still beyond its limit raises it again."""
        for key in self._levels:
            subject, _, name = key.partition('/')
            self._set(subject, name, Level.OK, math.nan)
        self._recent.clear()

    def take_changes(self) -> list[Change]:
        """Return the changes of level since the last call, each once."""
        changes = list(self._changes)
        self._changes.clear()
        return changes


def _bound(bound: float, limit: Limit, normal: Normal | None, chance: float, side: int) -> float:
    """Return a limit in the unit of the value; that of a relative one is beyond the scatter."""
    if not limit.relative or math.isinf(bound):
        return bound
    assert normal is not None
    mean, deviation, count = normal
    if mean <= 0:
        return side * math.inf
    # A new value of a normal distribution known by `count` samples (prediction interval).
    margin = -special.stdtrit(max(count - 1, 1), chance) * math.sqrt(1 + 1 / count) * deviation
    return max(bound * mean, mean + margin) if side > 0 else min(bound * mean, mean - margin)


_RULES = {'hysteresis', 'persistence', 'latch', 'false_alarms'}


def _rule(path: str | Path, content: Mapping[str, Any]) -> AlarmRule:
    hysteresis = _number(path, 'hysteresis', content.get('hysteresis', 0.1))
    if not 0 <= hysteresis < 1:
        raise ThresholdError(f'{path}: hysteresis is {hysteresis:g}: it must be in [0, 1)')
    persistence = content.get('persistence', [1, 1])
    if (
        not isinstance(persistence, list)
        or [type(each) for each in persistence] != [int, int]
        or not 1 <= persistence[0] <= persistence[1] <= 1000
    ):
        raise ThresholdError(
            f'{path}: persistence is {persistence!r}: it must be [n, m] with 1 <= n <= m <= 1000'
        )
    latch = content.get('latch', False)
    if not isinstance(latch, bool):
        raise ThresholdError(f'{path}: latch is {latch!r}: it must be true or false')
    chance = _number(path, 'false_alarms', content.get('false_alarms', 1e-3))
    if not 1e-12 <= chance <= 0.5:
        raise ThresholdError(f'{path}: false_alarms is {chance:g}: it must be from 1e-12 to 0.5')
    return AlarmRule(hysteresis, persistence[0], persistence[1], latch, chance)


def _limit(path: str | Path, key: Any, value: Any) -> Limit:
    if str(key).count('/') != 1:
        raise ThresholdError(f'{path}: limit {key!r} must be named SUBJECT/NAME or */NAME')
    if not isinstance(value, dict) or not value or not set(value) <= {*BOUNDS, *TIMES, 'relative'}:
        allowed = ', '.join((*BOUNDS, *TIMES))
        raise ThresholdError(f'{path}: {key} must be a mapping of {allowed}, relative')
    relative = value.get('relative', False)
    if not isinstance(relative, bool):
        raise ThresholdError(f'{path}: {key} relative is {relative!r}: it must be true or false')
    bounds = {
        word: _number(path, f'{key} {word}', bound)
        for word, bound in value.items()
        if word != 'relative'
    }
    limit = Limit(**bounds, relative=relative)
    if 'warn' in value and limit.warn > limit.error:
        raise ThresholdError(f'{path}: {key}: warn {limit.warn:g} is above error {limit.error:g}')
    if 'below_warn' in value and limit.below_warn < limit.below_error:
        raise ThresholdError(
            f'{path}: {key}: below_warn {limit.below_warn:g} is below below_error '
            f'{limit.below_error:g}'
        )
    return limit


def _number(path: str | Path, name: str, value: Any) -> float:
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not (math.isfinite(number) and number >= 0):
        raise ThresholdError(f'{path}: {name} is {value!r}: it must be a number of 0 or more')
    return number
