"""Margins of a design: how far each figure may move before a claim fails."""
