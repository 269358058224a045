"""Scenes beside a fibre, simulated from the ground up: strain, light, detector, machines, virtual sections."""
