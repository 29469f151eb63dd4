"""Files of measuring instruments: TDMS (npTDMS) and Universal File Format 58 (pyuff)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gear_dynamics.recordings.optional import optional_module
from gear_dynamics.recordings.table import ArrayTable, RecordingError, find_column


class TdmsTable(ArrayTable):
    """A TDMS file; a channel is named `group/channel`, or `channel` where that is unique."""

    def __init__(self, path: Path) -> None:
        nptdms = optional_module('nptdms', 'npTDMS', path.name)
        try:
            file = nptdms.TdmsFile.open(path)
        except Exception as error:
            reason = ' '.join(str(error).split())[:200]
            raise RecordingError(f'{path.name} cannot be read: {reason}') from None
        self._channels = {
            f'{group.name}/{channel.name}': channel
            for group in file.groups()
            for channel in group.channels()
            if len(channel)
        }
        super().__init__(path.name, self._channels)

    def rate(self, column: str) -> float | None:
        """Return the rate of the channel's waveform [Hz]."""
        increment = self._channels[column].properties.get('wf_increment')
        return 1 / float(increment) if increment else super().rate(column)

    def unit(self, column: str) -> str | None:
        """Return the unit of the channel's properties."""
        return self._channels[column].properties.get('unit_string') or None

    def start_ns(self) -> int | None:
        """Return the start of the first waveform [ns]."""
        for channel in self._channels.values():
            start = channel.properties.get('wf_start_time')
            if isinstance(start, np.datetime64):
                return int(start.astype('datetime64[ns]').astype(np.int64))
        return None

    def resolve(self, column: str | int | None, topic: str | None = None) -> str:
        """Return the channel that a source means; the group's name may be left out."""
        if isinstance(column, str) and column not in self.columns:
            found = [each for each in self.columns if each.partition('/')[2] == column]
            if len(found) == 1:
                return found[0]
        return find_column(self.name, self.columns, column)


class UffTable(ArrayTable):
    """A file of sets of type 58 with even steps; a set is named by its first line, or number."""

    def __init__(self, path: Path) -> None:
        pyuff = optional_module('pyuff', 'pyuff', path.name)
        try:
            found = pyuff.UFF(str(path)).read_sets()
        except Exception as error:
            reason = ' '.join(str(error).split())[:200]
            raise RecordingError(f'{path.name} cannot be read: {reason}') from None
        sets = [found] if isinstance(found, dict) else list(found)
        arrays: dict[str, np.ndarray] = {}
        self._sets = {}
        for index, each in enumerate(s for s in sets if s.get('type') == 58):
            name = str(each.get('id1', '')).strip()
            if name in ('', 'NONE') or name in arrays:
                name = str(index + 1)
            arrays[name] = np.real(np.asarray(each['data'])).ravel()
            self._sets[name] = each
        super().__init__(path.name, arrays)

    def rate(self, column: str) -> float | None:
        """Return 1 / the step of the abscissa [Hz]."""
        step = float(self._sets[column].get('abscissa_inc') or 0)
        if step > 0:
            return 1 / step
        x = np.asarray(self._sets[column].get('x', ()))
        return (len(x) - 1) / float(x[-1] - x[0]) if len(x) > 1 and x[-1] > x[0] else None

    def unit(self, column: str) -> str | None:
        """Return the unit of the ordinate."""
        text = str(self._sets[column].get('ordinate_axis_units_lab', '')).strip()
        return None if text in ('', 'NONE') else text
