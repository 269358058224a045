"""Trains, sensors and their faults, simulated from truth and a seed."""
