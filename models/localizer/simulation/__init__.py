"""Journeys of a vehicle with all its ways of locating, what goes wrong on them, and the recordings that ship."""
