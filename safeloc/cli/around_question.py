"""The question of a proof around a stream: figures of its options, claims, and the laws that are left out."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from safeloc.errors import InputError
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.language.verdict import Proved
from safeloc.proof.around.claims import Asked, written_claim
from safeloc.proof.around.question import General
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.calls import chosen_properties, prove_target
from safeloc.target import Target


def figures(option: str, given: Sequence[str]) -> dict[str, int]:
    """Return the figures of NAME=FIGURE, separated by commas or in options of their own."""
    found: dict[str, int] = {}
    for part in (one.strip() for text in given for one in text.split(",")):
        name, sign, figure = part.partition("=")
        name = name.strip()
        if not sign or not name or not re.fullmatch(r"[0-9]+", figure.strip()):
            raise InputError(
                f"{option} {part!r}: expected NAME=NUMBER, a whole number from 0 on in the unit of the input."
            )
        if name in found:
            raise InputError(f"{option}: {name} is given twice.")
        found[name] = int(figure)
    return found


def asked(
    loaded: Target, claims: Sequence[str], cycles: tuple[int | None, int | None], only: list[str] | None, length: int
) -> list[Asked]:
    """Return the claims and properties to ask. cycles: the first and the last one in which a claim is judged."""
    first, last = cycles
    if (first is not None or last is not None) and not claims:
        raise InputError("--from and --until say in which cycles a --claim is judged; give a claim, or leave them out.")
    if not 1 <= (first or 1) <= (last or length) <= length:
        raise InputError(f"--from {first or 1} --until {last or length}: the stream has the cycles 1 to {length}.")
    own = [written_claim(loaded.system, text, first or 1, last) for text in claims]
    if own and only is None:
        return own
    chosen = chosen_properties(loaded, only)
    runs = [prop.name for prop in chosen if prop.kind == "reachable"]
    if only is not None and runs:
        raise InputError(f"--property {runs[0]!r} asks for some run, and a tube is asked what all its streams keep.")
    declared = [Asked(prop) for prop in chosen if prop.kind != "reachable"]
    if not own and not declared:
        raise InputError(f'{loaded.name} declares no property; write a claim, such as --claim "valid".')
    return [*own, *declared]


def laws(loaded: Target, names: Sequence[str]) -> list[ClauseId]:
    """Return the clauses of these names, with or without their machine."""
    known = {str(one): one for one in assumed_clauses(loaded.system)}
    by_name: dict[str, list[ClauseId]] = {}
    for one in known.values():
        by_name.setdefault(one.name, []).append(one)
    found = []
    for name in names:
        some = [known[name]] if name in known else by_name.get(name, [])
        if not some:
            every = list(by_name)
            raise InputError(
                f"--without: {loaded.name} assumes no law {name!r}; it assumes {'; '.join(every)}.{hint(name, every)}"
            )
        if len(some) > 1:
            raise InputError(
                f"--without: several machines have a law {name!r}; give one of {', '.join(map(str, some))}."
            )
        found += some
    return found


def general(loaded: Target, limits: Limits, store: Store) -> General:
    """Return a function that proves declared properties of all lawful streams, and returns what it could prove."""

    def proved(properties: Sequence[Property]) -> Mapping[Property, Mapping[str, str]]:
        names = [prop.name for prop in properties]
        found = prove_target(loaded, only=names, with_assumption=False, limits=limits, jobs=1, store=store)
        of_name = {one.id.split("/", 2)[2]: one.result for one in found if one.kind == "property"}
        return {prop: one.certificates for prop in properties if isinstance(one := of_name.get(prop.name), Proved)}

    return proved
