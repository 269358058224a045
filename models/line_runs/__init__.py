"""Runs of a vehicle along a route of a line, as step streams of the machines that locate on it."""
