"""Tests of safeloc.templates."""
