"""Guarding a receiver: position streams in, what map and motion allow of them out."""
