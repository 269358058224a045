"""Simulation of trains, their sensors and faults, from the true motion and a seed."""
