"""Exit codes of the nodes and of what starts them."""

USAGE_ERROR = 2
"""An argument, a parameter or a file given at the start is wrong."""
