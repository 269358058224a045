"""Names of lemmas in a composition."""

from __future__ import annotations


def lemma_name(machine: str, name: str) -> str:
    """Return the name of a machine's lemma in a composition."""
    return f"{machine}: {name}"


def contract_text(machine: str) -> str:
    """Return the name of the lemma that a machine's discharged assumption becomes in a composition."""
    return f"contract of {machine} holds"


def inputs_text(machine: str) -> str:
    """Return the name of the fact that the wired inputs of a machine of a composition are in range."""
    return f"wired inputs of {machine} are in range"
