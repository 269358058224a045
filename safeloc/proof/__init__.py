"""Verification of a declaration: provers, random runs, the proof checker, and the cache of earlier results."""
