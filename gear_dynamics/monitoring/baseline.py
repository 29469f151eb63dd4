"""What is normal: the values of indicators in steady operation, by operating bin, in a file."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from gear_dynamics.machine.machine import Machine
from gear_dynamics.monitoring.operating import centre
from gear_dynamics.monitoring.task import Bin, Normal

MOST_BINS = 2000
MOST_BYTES = 200_000_000
FORM = 1


class BaselineError(ValueError):
    """A baseline file cannot be used; the message says where and why in one line."""


class Baseline:
    """Learned values by operating bin and `SUBJECT/NAME`.

    The first `spans` values of a bin and name are learned; NaN does not count.

    Parameters
    ----------
    spans : int
        Values that make a baseline.
    machine : str
        What the values belong to, as `machine_text` gives it.

    Attributes
    ----------
    changed, unsaved : bool
        Whether anything was learned since `changed` was cleared, and since the last `save`.
    """

    def __init__(self, spans: int, machine: str = '') -> None:
        self._spans = spans
        self.machine = machine
        self._values: dict[Bin, dict[str, list[float]]] = {}
        self.changed = self.unsaved = False

    def learn(self, bin_: Bin, name: str, value: float) -> None:
        """Take the next value of steady operation, unless enough are known already."""
        if not math.isfinite(value):
            return
        names = self._values.get(bin_)
        if names is None:
            if len(self._values) >= MOST_BINS:
                self._values.pop(next(iter(self._values)))
            names = self._values[bin_] = {}
        known = names.setdefault(name, [])
        if len(known) < self._spans:
            known.append(value)
            self.changed = self.unsaved = True

    def normal(self, bin_: Bin, name: str) -> Normal | None:
        """Return what was learned; None as long as that is not enough."""
        known = self._values.get(bin_, {}).get(name, ())
        if len(known) < self._spans:
            return None
        deviation = float(np.std(known, ddof=1)) if len(known) > 1 else 0.0
        return Normal(float(np.mean(known)), deviation, len(known))

    def mean(self, bin_: Bin, name: str) -> float:
        """Return the mean of what was learned so far; NaN for nothing."""
        known = self._values.get(bin_, {}).get(name, ())
        return float(np.mean(known)) if known else math.nan

    def forget(self) -> None:
        """Begin to learn anew in all bins."""
        self._values.clear()
        self.changed = self.unsaved = True

    @property
    def bins(self) -> dict[str, bool]:
        """The operating bins in words, and whether all that was seen in each is learned."""
        found = {}
        for bin_, names in self._values.items():
            speed, load = centre(bin_)
            learned = all(len(values) >= self._spans for values in names.values())
            found[f'{speed:.4g} rad/s, load {load:.4g}'] = learned
        return found

    def save(self, path: str | Path) -> None:
        """Write the file so that a crash leaves the old or the new one, never a part.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        path = Path(path).expanduser()
        content = {
            'form': FORM,
            'machine': self.machine,
            'spans': self._spans,
            'bins': [
                {'speed': bin_[0], 'load': bin_[1], 'values': names}
                for bin_, names in self._values.items()
            ],
        }
        part = path.with_name(f'{path.name}.part')
        with part.open('w', encoding='utf-8') as file:
            json.dump(content, file)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
        self.unsaved = False

    def load(self, path: str | Path) -> None:
        """Take the values of a file; a file that does not exist yet has none.

        Raises
        ------
        BaselineError
            If it cannot be read, is no baseline, or is that of another machine.
        """
        path = Path(path).expanduser()
        try:
            if path.exists() and path.stat().st_size > MOST_BYTES:
                raise BaselineError(f'{path}: it has more than {MOST_BYTES:g} bytes')
            if not path.exists():
                return
            content = json.loads(path.read_text(encoding='utf-8'))
        except (OSError, UnicodeDecodeError, ValueError, RecursionError) as error:
            reason = str(error) if isinstance(error, BaselineError) else f'{path}: {error}'
            raise BaselineError(' '.join(reason.split())) from None
        if not isinstance(content, dict) or content.get('form') != FORM:
            raise BaselineError(f'{path}: it is no baseline of form {FORM}')
        if content.get('machine') != self.machine:
            raise BaselineError(
                f'{path}: it belongs to the machine {str(content.get("machine"))[:200]!r}, '
                f'not to {self.machine!r}: name another file, or remove it to learn anew'
            )
        self._values = _bins(path, content.get('bins'), self._spans)


def _bins(path: Path, entries: Any, spans: int) -> dict[Bin, dict[str, list[float]]]:
    if not isinstance(entries, list) or len(entries) > MOST_BINS:
        raise BaselineError(f'{path}: bins must be a list of at most {MOST_BINS}')
    found: dict[Bin, dict[str, list[float]]] = {}
    for entry in entries:
        if not isinstance(entry, dict) or not isinstance(entry.get('values'), dict):
            raise BaselineError(f'{path}: a bin must be a mapping of speed, load and values')
        bin_ = entry.get('speed'), entry.get('load')
        if not all(type(number) is int and abs(number) < 10_000 for number in bin_):
            raise BaselineError(f'{path}: {str(bin_)[:80]} are no numbers of a bin')
        found[bin_] = {  # type: ignore[index]
            name: _numbers(path, name, values)[:spans] for name, values in entry['values'].items()
        }
    return found


def _numbers(path: Path, name: str, values: Any) -> list[float]:
    if not isinstance(values, list) or not all(
        type(value) in (int, float) and math.isfinite(value) for value in values
    ):
        raise BaselineError(f'{path}: the values of {name[:80]} must be a list of finite numbers')
    return [float(value) for value in values]


def machine_text(machine: Machine, rate: float) -> str:
    """Return what tells one machine from another, for the baseline: wheels, meshes and channels."""
    wheels = ', '.join(f'{wheel.name} {wheel.teeth}' for wheel in machine.wheels)
    channels = ', '.join(f'{channel.name} [{channel.unit}]' for channel in machine.channels)
    return f'{machine.name}; wheels {wheels}; channels {channels}; {rate:g} Hz'
