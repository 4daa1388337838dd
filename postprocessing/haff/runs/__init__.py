"""Makes, runs and compares cases."""
