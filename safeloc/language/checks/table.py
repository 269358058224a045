"""All rules for declarations, in one list."""

from __future__ import annotations

from typing import Any

from safeloc.language.checks.composition import JOINING
from safeloc.language.checks.machine import MACHINE, SHAPE
from safeloc.language.checks.properties import PROPERTY, READING, WATCHING
from safeloc.language.checks.rule import Rule
from safeloc.language.checks.system import SYSTEM

RULES: tuple[Rule[Any], ...] = (*SHAPE, *MACHINE, *JOINING, *SYSTEM, *PROPERTY, *READING, *WATCHING)
