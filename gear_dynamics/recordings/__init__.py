"""Recordings of real machines: readers of common file formats, and their analysis."""
