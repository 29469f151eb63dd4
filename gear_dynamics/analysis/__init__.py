"""Signal analysis of the samples: plain functions over arrays."""
