"""MCAP logs and message bytes: write, read, recover."""
