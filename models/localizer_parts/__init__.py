"""Pieces of the localizer: its configuration, and its sources with what each states."""
