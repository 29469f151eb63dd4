"""Figures of the studies, drawn from the data that they write."""
