"""Messages between server and page: checked JSON in, JSON and binary frames out."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

LARGEST = 16_384
"""Bytes of a message from the page; a larger one is refused."""


class MessageRefusedError(ValueError):
    """A message from the page cannot be used; the text says why in one line."""


def read_message(text: str) -> dict[str, Any]:
    """Return the mapping that a message from the page holds.

    Raises
    ------
    MessageRefusedError
        If it is not JSON, no mapping, too large, or holds a number that is not finite.
    """
    if len(text) > LARGEST:
        raise MessageRefusedError(f'the message has {len(text)} characters: at most {LARGEST}')
    try:
        content = json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        reason = 'nested too deeply' if isinstance(error, RecursionError) else str(error)[:80]
        raise MessageRefusedError(f'the message is not JSON: {reason}') from None
    if not isinstance(content, dict):
        raise MessageRefusedError('the message is no mapping')
    return content


def number_of(content: Mapping[str, Any], name: str, low: float, high: float) -> float:
    """Return a number of a message.

    Raises
    ------
    MessageRefusedError
        If it is missing, no number, or outside [low, high].
    """
    value = content.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MessageRefusedError(f'{name} is {_short(value)}: it must be a number')
    if not low <= value <= high:  # compares integers of any size exactly
        raise MessageRefusedError(f'{name} is {_short(value)}: it must be from {low:g} to {high:g}')
    return float(value)


def text_of(content: Mapping[str, Any], name: str, longest: int = 200) -> str:
    """Return a text of a message.

    Raises
    ------
    MessageRefusedError
        If it is missing, no text, or longer than `longest`.
    """
    value = content.get(name)
    if not isinstance(value, str) or len(value) > longest:
        raise MessageRefusedError(
            f'{name} is {_short(value)}: it must be a text of at most {longest} characters'
        )
    return value


def binary_frame(header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """Return a frame: the length of a JSON header, the header, and float32 arrays one by one.

    The header's `arrays` gives the name and length of each in the order in which they follow. The
    header is padded so that the arrays begin at a multiple of 4 bytes.
    """
    lengths = {name: len(array) for name, array in arrays.items()}
    text = json.dumps({**header, 'arrays': lengths}, allow_nan=False).encode()
    text += b' ' * (-len(text) % 4)
    parts = [np.ascontiguousarray(array, '<f4').tobytes() for array in arrays.values()]
    return b''.join([struct.pack('<I', len(text)), text, *parts])


def json_text(content: Mapping[str, Any]) -> str:
    """Return a mapping as JSON; numbers that are not finite become null."""
    return json.dumps(_finite(content), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _refuse_constant(name: str) -> float:
    raise ValueError(f'{name} is no number of JSON')


def _short(value: Any) -> str:
    try:
        text = repr(value)
    except ValueError:  # an integer of more digits than Python converts
        text = 'a very long number'
    return text if len(text) <= 60 else f'{text[:57]}...'
