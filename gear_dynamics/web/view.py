"""What one page looks at, as it asks for it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from gear_dynamics.web.messages import MessageRefusedError, number_of, text_of
from gear_dynamics.web.windows import TRIGGERS

MOST_CHANNELS = 6
"""Channels that the oscilloscope draws at once."""


@dataclasses.dataclass(frozen=True)
class View:
    """What a page shows.

    Attributes
    ----------
    rig : str
        Name of the rig; empty for the first.
    channels : tuple of str
        Channels of the oscilloscope.
    window : float
        Length of the oscilloscope's window [s].
    trigger : str
        One of windows.TRIGGERS.
    pixels : int
        Width of the oscilloscope.
    """

    rig: str = ''
    channels: tuple[str, ...] = ('pinion_ay', 'gear_ay')
    window: float = 0.06
    trigger: str = 'pinion'
    pixels: int = 800

    @classmethod
    def from_message(cls, content: Mapping[str, Any]) -> View:
        """Read a view.

        Raises
        ------
        MessageRefusedError
            If a value is missing or not allowed.
        """
        channels = content.get('channels')
        if not isinstance(channels, list) or len(channels) > MOST_CHANNELS:
            raise MessageRefusedError(f'channels must be a list of at most {MOST_CHANNELS}')
        if not all(isinstance(name, str) and len(name) <= 200 for name in channels):
            raise MessageRefusedError('channels must be names')
        trigger = text_of(content, 'trigger')
        if trigger not in TRIGGERS:
            raise MessageRefusedError(
                f'trigger is {trigger!r}: it must be one of {", ".join(TRIGGERS)}'
            )
        return cls(
            rig=text_of(content, 'rig'),
            channels=tuple(channels),
            window=number_of(content, 'window', 1e-4, 4.0),
            trigger=trigger,
            pixels=int(number_of(content, 'pixels', 16, 4096)),
        )
