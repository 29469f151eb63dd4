"""Algorithms on motions: stroboscopic map, exponents, regime."""
