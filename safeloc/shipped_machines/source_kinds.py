"""The words of a requested name with a user's own sources, such as `localizer+beacons.py:source`."""

from __future__ import annotations

WITH_SOURCES = "localizer"
"""The machine that takes sources of a user's own."""
SEPARATOR = "+"
"""Separator between the kind of target and the sources."""
KINDS = ("contract", "alone", WITH_SOURCES)
"""Kinds of target:

    contract   the source's machine alone: it satisfies what the localizer assumes of it, whatever other sources there are
    alone      the localizer with these sources and no other
    localizer  the localizer with these sources and its own
"""
