"""Reads the mappings of a machine file, key by key, with errors of one line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any


class Keys:
    """A mapping whose keys are taken one after the other; what is left over is refused.

    Parameters
    ----------
    content : Any
    where : str
        Where it stands, for messages.
    known : iterable of str
        All keys that are allowed.
    """

    def __init__(self, content: Any, where: str, known: Iterable[str] | None) -> None:
        if not isinstance(content, Mapping):
            raise ValueError(f'{where} is {_short(content)}: it must be a mapping')
        self._content = content
        self.where = where
        if known is not None:
            self._refuse_unknown(tuple(known))

    def _refuse_unknown(self, known: tuple[str, ...]) -> None:
        for key in self._content:
            if key not in known:
                near = difflib.get_close_matches(str(key), known, 1, 0.5)
                hint = f'did you mean {near[0]!r}?' if near else f'known are {", ".join(known)}'
                raise ValueError(f'{self.where} has no key {key!r}: {hint}')

    def __contains__(self, key: str) -> bool:
        return self._content.get(key) is not None

    def items(self) -> Iterator[tuple[str, Any]]:
        """Yield names and what stands under them."""
        for name, value in self._content.items():
            if not isinstance(name, str):
                raise ValueError(f'{self.where} has the key {name!r}: a name must be text')
            yield name, value

    def get(self, key: str) -> Any:
        """Return what stands under a key, None if nothing does."""
        return self._content.get(key)

    def require(self, key: str) -> Any:
        """Return what stands under a key that must be there."""
        if key not in self:
            raise ValueError(f'{self.where} has no {key}: it is needed')
        return self._content[key]

    def text(self, key: str, default: str | None = None) -> str | None:
        """Return a text, or the default where there is none."""
        value = self._content.get(key)
        if value is None:
            return default
        if isinstance(value, Mapping | list | bool):
            raise ValueError(f'{self.where}: {key} is {_short(value)}: it must be a text')
        return str(value)

    def number(
        self, key: str, default: float | None = None, *, least: float = 0.0, above: bool = True
    ) -> float | None:
        """Return a number above `least` (or from it on), or the default where there is none."""
        value = self._content.get(key)
        if value is None:
            return default
        return number(value, f'{self.where}: {key}', least, above)

    def count(self, key: str) -> int:
        """Return a whole number that must be there."""
        value = number(self.require(key), f'{self.where}: {key}', -math.inf, True)
        if not value.is_integer():
            raise ValueError(f'{self.where}: {key} is {value:g}: it must be a whole number')
        return int(value)

    def choice(self, key: str, choices: tuple[Any, ...], default: Any) -> Any:
        """Return one of the choices."""
        value = self._content.get(key, default)
        if value not in choices:
            allowed = ' or '.join(str(each) for each in choices)
            raise ValueError(f'{self.where}: {key} is {_short(value)}: it must be {allowed}')
        return value


def number(value: Any, where: str, least: float = 0.0, above: bool = True) -> float:
    """Return a number; `1e-3`, which YAML reads as a text, is one as well.

    Raises
    ------
    ValueError
        If it is none, or lies below what is allowed.
    """
    bound = 'above' if above else 'at least'
    wanted = 'a finite number' + ('' if least == -math.inf else f' {bound} {least:g}')
    try:
        if isinstance(value, bool | list | Mapping):
            raise ValueError
        result = float(value)
        if not math.isfinite(result) or result < least or (above and result == least):
            raise ValueError
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f'{where} is {_short(value)}: it must be {wanted}') from None
    return result


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + '...'
