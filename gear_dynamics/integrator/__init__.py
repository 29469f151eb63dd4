"""Event-exact Taylor integration of the gear pair, in compiled kernels."""
