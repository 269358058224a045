"""Tests of the trackside process."""
