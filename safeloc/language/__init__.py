"""Declarations and their meaning: terms, machines, properties, the interpreter. Standard library only."""
