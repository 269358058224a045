"""A day of a fleet through the real process, by the fleet's own clock: `python -m tests.soak --out FILE`."""
