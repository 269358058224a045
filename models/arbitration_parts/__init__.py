"""Pieces of the arbitration machine: what the sources state, and what it means in a cycle."""
