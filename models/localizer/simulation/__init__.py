"""Journeys of a vehicle with all its ways of locating, the faults on them, and the shipped recordings."""
