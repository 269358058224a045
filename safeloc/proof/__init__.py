"""Verification of a declaration: provers, random runs, property tests, replays, and the cache of earlier results."""
