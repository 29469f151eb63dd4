"""How bad something is."""

import enum


class Level(enum.IntEnum):
    """How bad a value is; the numbers are those of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
