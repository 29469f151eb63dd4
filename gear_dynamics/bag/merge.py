"""Messages of many segments in the order of their log times, in bounded memory."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter

from gear_dynamics.bag.channel import ReadMessage
from gear_dynamics.bag.source import McapSource, Segment

MOST_HELD = 1 << 27
"""Bytes of segments, overlapping in time, that are held at once to put them in order."""

_Held = tuple[int, int, ReadMessage, Iterator[ReadMessage], Segment]


def in_time_order(
    segments: Iterable[Segment],
    read: Callable[[Segment], list[ReadMessage]],
    on_disorder: Callable[[Segment], None],
) -> Iterator[tuple[McapSource, ReadMessage]]:
    """Iterate over the messages of segments by log time, equal times in the order given.

    Parameters
    ----------
    segments : iterable of Segment
        With the log times between which their messages are.
    read : callable
        Returns the messages of a segment.
    on_disorder : callable
        Called with a segment that would exceed `MOST_HELD`: its messages come late.
    """
    numbered = list(enumerate(segments))
    waiting = sorted(numbered, key=lambda item: item[1].start, reverse=True)
    heads: list[_Held] = []
    held = 0
    while waiting or heads:
        while waiting and (not heads or waiting[-1][1].start <= heads[0][0]):
            number, segment = waiting[-1]
            if heads and held + segment.size > MOST_HELD:
                on_disorder(segment)
                break
            waiting.pop()
            messages = iter(sorted(read(segment), key=attrgetter('log_time')))
            first = next(messages, None)
            if first is not None:
                held += segment.size
                heapq.heappush(heads, (first.log_time, number, first, messages, segment))
        if not heads:
            continue
        _, number, message, messages, segment = heads[0]
        yield segment.source, message
        following = next(messages, None)
        if following is None:
            heapq.heappop(heads)
            held -= segment.size
        else:
            heapq.heapreplace(heads, (following.log_time, number, following, messages, segment))
