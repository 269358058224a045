"""Names that rules of certificates had in earlier versions: a certificate with one of them establishes nothing."""

from __future__ import annotations

_FORMER = {"heard": "wires", "owed": "contract"}


def without_rule(name: str) -> str:
    """Return the reason why a certificate with a rule of this name is of no use by itself; it tells the new name of an old rule."""
    now = _FORMER.get(name)
    return f"rule {name!r} is now {now!r}" if now else "no rule of this name, or the other half is missing"
