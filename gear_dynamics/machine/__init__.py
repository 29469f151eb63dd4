"""What a machine is: shafts, wheels, meshes, channels; no physics."""
