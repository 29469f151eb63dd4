"""The mesh: stiffness, mesh intervals and tooth deviations."""
