"""Names of lemmas in a composition."""

from __future__ import annotations


def lemma_name(machine: str, name: str) -> str:
    """Return the name of a machine's lemma in a composition."""
    return f"{machine}: {name}"


def contract_text(machine: str) -> str:
    """Return the name of the lemma that a machine's discharged assumption becomes in a composition."""
    return f"what {machine} is owed is kept"
