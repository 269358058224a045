"""Simulation of backscatter from a cable that trains, roads and wind shake, with explicit seeds."""
