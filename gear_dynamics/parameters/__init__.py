"""Parameter lists, parameter files and the settings of each node."""
