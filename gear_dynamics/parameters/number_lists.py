"""Rows of numbers in one text: ROS knows no list of lists."""

from __future__ import annotations

import math

from gear_dynamics.parameters.parameter import ParameterError


def number_rows(name: str, text: str, width: int) -> list[tuple[float, ...]]:
    """Return the rows of a text such as '0.3 0, 0.1 1.57'.

    Parameters
    ----------
    name : str
        The parameter's, for the message.
    text : str
        Rows are parted by commas, numbers by blanks; an empty text has no rows.
    width : int
        Numbers in a row.

    Raises
    ------
    ParameterError
        If a row has another number of numbers, or one that is not finite.
    """
    rows = []
    for part in text.split(',') if text.strip() else []:
        try:
            row = tuple(float(word) for word in part.split())
        except ValueError:
            row = ()
        if len(row) != width or not all(math.isfinite(number) for number in row):
            raise ParameterError(
                f'{name} has {part.strip()!r}: each part between commas must be {width} numbers'
            )
        rows.append(row)
    return rows
