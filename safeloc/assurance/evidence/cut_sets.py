"""Minimal cut sets of order 1 and 2: the smallest sets of clauses whose breach leads to the top event."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from safeloc.assurance.evidence.effects import Effect
from safeloc.proof.cores.clauses import ClauseId


@dataclass(frozen=True)
class CutSets:
    """The cut sets of a top event that were shown by runs, and undecided sets, which may be cut sets as well."""

    top: str
    found: tuple[tuple[ClauseId, ...], ...]
    undecided: tuple[tuple[ClauseId, ...], ...]


def cut_sets(top: str, effects: Iterable[Effect]) -> CutSets:
    """Return the minimal cut sets among the effects. Pairs consist of clauses that alone do no harm, so they are minimal."""
    every = list(effects)
    return CutSets(
        top,
        tuple(one.broken for one in every if one.end in ("wrong", "withdrawn", "hazard")),
        tuple(one.broken for one in every if one.end == "undecided"),
    )


def to_open_psa(name: str, sets: CutSets, ids: Mapping[ClauseId, str]) -> str:
    """Return the cut sets as a fault tree in the Open-PSA model exchange format: a basic event is the breach of a clause.

    Undecided sets are comments, since they are no events.
    """
    root = ElementTree.Element("opsa-mef")
    for one in sets.undecided:
        root.append(ElementTree.Comment(f" not decided: {' and '.join(ids[clause] for clause in one)} "))
    tree = ElementTree.SubElement(root, "define-fault-tree", name=_name(name))
    gate = ElementTree.SubElement(tree, "define-gate", name=_name(sets.top))
    ElementTree.SubElement(gate, "label").text = sets.top
    if sets.found:
        _formula(gate, sets.found, ids)
    else:
        ElementTree.SubElement(gate, "constant", value="false")
    data = ElementTree.SubElement(root, "model-data")
    for clause in dict.fromkeys(clause for one in sets.found for clause in one):
        event = ElementTree.SubElement(data, "define-basic-event", name=_name(ids[clause]))
        ElementTree.SubElement(event, "label").text = f"broken: {clause}"
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _formula(gate: ElementTree.Element, sets: Sequence[tuple[ClauseId, ...]], ids: Mapping[ClauseId, str]) -> None:
    """Add the sets to the gate. A single set is added directly: `or` needs two inputs."""
    parent = gate if len(sets) == 1 else ElementTree.SubElement(gate, "or")
    for one in sets:
        holder = parent if len(one) == 1 else ElementTree.SubElement(parent, "and")
        for clause in one:
            ElementTree.SubElement(holder, "basic-event", name=_name(ids[clause]))


def _name(text: str) -> str:
    return "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in text)
