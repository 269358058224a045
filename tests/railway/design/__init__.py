"""Designs of lines."""
