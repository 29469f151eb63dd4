"""The studies, one a module: its run, its options (`STUDY`) and its figure (`draw`)."""
