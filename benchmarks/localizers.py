"""Localizers with one to five sources, for tables of growth."""

from __future__ import annotations

from safeloc.models.localizer import LocalizerConfig, SourceName

SOURCES: tuple[SourceName, ...] = ("odometry", "balise", "reflector", "satellite", "fibre")


def with_sources(number: int) -> LocalizerConfig:
    """The localizer with the first so many of them."""
    return LocalizerConfig(sources=SOURCES[:number])
