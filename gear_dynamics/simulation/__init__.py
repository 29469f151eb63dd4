"""Running gear pairs: samples, events, commands."""
