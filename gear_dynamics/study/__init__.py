"""Experiments on the model, with their data and figures."""
