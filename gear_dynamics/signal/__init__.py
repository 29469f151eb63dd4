"""Signal processing: plain functions over arrays."""
