"""Configuration of a counted entry, besides the defaults, in which its claims are proved: the counter is not at zero."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.counted_entry.configuration import CountedEntryConfig

NEVER = {
    "properties/counted_entry.py: into.num(own.record_age).eq(0) from [*_counted(whole), *_disturbed(whole), *_heard(whole), *_kep ...": "the wire is 0, as it should be; the claim is there for another one",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {"the counter is 12.5 km down the line": CountedEntryConfig(counter_mm=-12_500_000)}, NEVER
)
