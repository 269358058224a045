"""Simulated balise groups: passages of the antenna, announcements of the map, and runs of many vehicles at once."""
