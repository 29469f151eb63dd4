"""Compiling is said if it takes long: a program must not seem to hang when it is first started."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

LONG = 2.0
"""Time after which it is said what is going on [s]; with a warm cache it does not come to it."""


@contextlib.contextmanager
def announced(what: str, say: Callable[[str], object]) -> Iterator[None]:
    """Say that `what` is compiled if that takes long.

    Parameters
    ----------
    what : str
    say : callable
        Is given the line, in another thread.
    """
    line = f'compiling {what} for this machine; only a first start takes this long'
    notice = threading.Timer(LONG, say, [line])
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
