"""Drawn runs of any machine: where a condition holds, inputs that keep the assumption, stretches, and whole runs."""
