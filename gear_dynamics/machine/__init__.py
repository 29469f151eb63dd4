"""What a machine is, simulated or real: shafts, wheels, meshes, bearings, channels; no physics."""
