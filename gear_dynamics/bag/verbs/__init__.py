"""The verbs of the `log` executable: `add_arguments(parser)` and `run(arguments)` each."""
