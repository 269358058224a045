"""Random edits of certificates: each is detected, or what is left is a certificate of the same claim.

That an edit is harmless is settled without the checker's own reader: z3 reads both texts. What the edited one presumes
has to follow from what the prover could presume, needed or not, and all that the old one showed has to follow from what it shows.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import product

import pytest
import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.language.system import environment
from safeloc.proof.provers.proved_base import base
from tests.checker.small_proofs import Evidence, refused

SAMPLE, ALL = 40, 1000
TOKEN = re.compile(r"\|[^|\n]*\||[A-Za-z0-9_<=>+*-]+|[()]")
SIGNS = ["<", "<=", ">=", "=", "+", "-", "*", "div", "and", "or", "not", "ite", "true", "false", "0", "1", "7"]
Edit = Callable[[random.Random, str], str]


def in_letters(draw: random.Random, text: str) -> str:
    """One letter left out, doubled or replaced."""
    place = draw.randrange(len(text))
    return text[:place] + draw.choice(["", text[place] * 2, draw.choice("()|;t0123456789 \nxy<=-")]) + text[place + 1 :]


def in_tokens(draw: random.Random, text: str) -> str:
    """One token replaced, by one of the text or a sign of the language."""
    tokens = list(TOKEN.finditer(text))
    chosen = draw.choice(tokens)
    other = draw.choice(SIGNS) if draw.random() < 0.4 else draw.choice(tokens).group()
    return text[: chosen.start()] + other + text[chosen.end() :]


def in_lines(draw: random.Random, text: str) -> str:
    """One line left out, doubled, or changed with another."""
    lines = text.split("\n")
    one, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    match draw.randrange(3):
        case 0:
            del lines[one]
        case 1:
            lines.insert(other, lines[one])
        case _:
            lines[one], lines[other] = lines[other], lines[one]
    return "\n".join(lines)


def in_claims(draw: random.Random, text: str) -> str:
    """A hypothesis or a goal left out, made into the other, or of another definition."""
    asserted = list(re.finditer(r"\(assert (\(not )?(\S+?)\)?\)\n", text))
    if not asserted:
        return in_witnesses(draw, text)
    chosen = draw.choice(asserted)
    match draw.randrange(3):
        case 0:
            new = ""
        case 1:
            new = f"(assert {'' if chosen[1] else '(not '}{chosen[2]}{'' if chosen[1] else ')'})\n"
        case _:
            other = draw.choice(asserted)[2]
            new = f"(assert {chosen[1] or ''}{other}{')' if chosen[1] else ''})\n"
    return text[: chosen.start()] + new + text[chosen.end() :]


def in_witnesses(draw: random.Random, text: str) -> str:
    """What stands in the place of an input, or which input it is for, changed for that of another."""
    told = list(re.finditer(r"\(define-fun \|witness (\S+ of .*)\| \(\) \S+ (\S+)\)\n", text))
    if not told:
        return in_tokens(draw, text)
    one, other, part = draw.choice(told), draw.choice(told), draw.choice((1, 2))
    return text[: one.start(part)] + other[part] + text[one.end(part) :]


EDITS: tuple[Edit, ...] = (in_letters, in_tokens, in_lines, in_claims)


class Read:
    """A text as z3 reads it, definitions written out: what is presumed in its parts, and what each group asserts."""

    def __init__(self, text: str) -> None:
        start, *groups = text.split("(push 1)\n")  # commands need no lines of their own
        presumed = list(z3.parse_smt2_string(start))
        self.presumed = {part.get_id(): part for part in parts(presumed)}
        self.denied = {
            tuple(part.get_id() for part in parts(own)): own
            for own in (list(z3.parse_smt2_string(f"{start}\n{body(one)}"))[len(presumed) :] for one in groups)
        }


def body(group: str) -> str:
    """A group up to its question."""
    return group[: group.index("(check-sat)")]


def parts(terms: list[z3.BoolRef]) -> Iterator[z3.BoolRef]:
    """The parts of a conjunction, without what is true anyway."""
    for one in terms:
        if z3.is_and(one):
            yield from parts(one.children())
        elif not z3.is_true(one):
            yield one


def harmless(old: str, new: str, whole: list[str]) -> bool:
    """Whether the new text presumes only what follows from what the whole ones presume, and shows all that the old one
    does.

    Of an induction's start over several states the goals of the earlier ones are shown by the starts before it.
    """
    before, after = Read(old), Read(new)  # both are kept, so that z3 gives no number twice
    given = {number: part for text in (old, *whole) for number, part in Read(text).presumed.items()}
    solver = z3.Solver()
    solver.add(*given.values())
    more = [part for number, part in after.presumed.items() if number not in given]
    lost = [own for numbers, own in before.denied.items() if numbers not in after.denied]
    shown = z3.Solver()  # a goal that follows from the others is shown with them
    shown.add(*(z3.Not(z3.And(*own)) for own in after.denied.values()))
    earlier = "rule: induction start" in old and set(after.denied) >= {list(before.denied)[-1]}
    return all(solver.check(z3.Not(part)) == z3.unsat for part in more) and (
        earlier or all(shown.check(*own) == z3.unsat for own in lost)
    )


def still_lawful(evidence: Evidence, text: str) -> bool:
    """Whether in every state with the proved facts some choice of the witness functions is lawful, as z3 reads them."""
    system = evidence.target.system
    facts, terms = base(system).everything, Terms({var: constant(var) for var in (*system.state, *system.inputs)})
    place = {var.name: terms(var) for var in system.inputs}
    told = [re.fullmatch(r"\(define-fun (\|witness (\S+) of (.*)\|) .*", line) for line in text.split("\n")]
    names = [(one[1], one[2], one[3]) for one in told if one]
    fresh = [f"|{place}: {of}|" for place, (_, _, of) in enumerate(names)]
    more = [f"(declare-const {one} {place[of].sort()})" for one, (_, _, of) in zip(fresh, names, strict=True)]
    more += [f"(assert (= {one} {name}))" for one, (name, _, _) in zip(fresh, names, strict=True)]
    read = z3.parse_smt2_string("\n".join([text, *more]))
    groups: dict[str, dict[str, list[tuple[z3.ExprRef, z3.ExprRef]]]] = {}
    for (_, number, of), said in zip(names, read, strict=True):
        groups.setdefault(number.split(".")[0], {}).setdefault(number, []).append((place[of], said.arg(1)))
    asked = terms.bool(environment(system))
    choices = product(*(group.values() for group in groups.values()))
    solver = z3.Solver()
    solver.add(*(terms.bool(fact) for fact in facts))
    solver.add(*(z3.Not(z3.substitute(asked, *(pair for own in one for pair in own))) for one in choices))
    return bool(solver.check() == z3.unsat)


def of_one_question(evidence: Evidence, file: str) -> list[str]:
    """The texts whose names are those of the file but for the digest."""
    stem = file.rpartition("-")[0]
    found = [text for name, text in evidence.texts.items() if name.rpartition("-")[0] == stem]
    assert found, file
    return found


def edited(proofs: dict[str, Evidence], whole_proofs: dict[str, Evidence], seed: int) -> str:
    """What became of one edit: detected, harmless, or neither."""
    draw = random.Random(seed)
    name = draw.choice(sorted(proofs))
    evidence = proofs[name]
    file = draw.choice(sorted(evidence.texts))
    old = evidence.texts[file]
    new = draw.choice(EDITS)(draw, old)
    if new == old:
        return "no edit"
    found = evidence.judged({file: new})
    if refused(found) or file in found.wrong or file in found.undecided:
        return "detected"
    if "rule: witnesses" in old:
        left = still_lawful(evidence, new)
    else:
        left = harmless(old, new, of_one_question(whole_proofs[name], file))
    return "harmless" if left else f"missed: seed {seed}, {file}"


@pytest.mark.thorough
def test_edits_of_witness_functions(proofs: dict[str, Evidence]) -> None:
    """Each is detected, or what is left is lawful all the same."""
    evidence = proofs["tracking"]
    file, found = evidence.file("by-what"), Counter[str]()
    for seed in range(SAMPLE):
        draw = random.Random(seed)
        new = draw.choice((in_tokens, in_lines, in_witnesses))(draw, evidence.texts[file])
        judged = evidence.judged({file: new})
        seen = "detected" if refused(judged) or file in judged.wrong else still_lawful(evidence, new)
        found["harmless" if seen is True else str(seen)] += 1
    assert {"detected", "harmless"} == set(found), found


def tally(proofs: dict[str, Evidence], whole_proofs: dict[str, Evidence], seeds: range) -> Counter[str]:
    """What became of so many edits."""
    return Counter(edited(proofs, whole_proofs, seed) for seed in seeds)


@pytest.mark.thorough
def test_some_edits(proofs: dict[str, Evidence], whole_proofs: dict[str, Evidence]) -> None:
    """A sample: none is missed, and both kinds occur."""
    found = tally(proofs, whole_proofs, range(SAMPLE))
    assert {"detected", "harmless"} <= set(found) <= {"detected", "harmless", "no edit"}, found


@pytest.mark.slow
def test_a_thousand_edits(proofs: dict[str, Evidence], whole_proofs: dict[str, Evidence]) -> None:
    """None of a thousand is missed."""
    found = tally(proofs, whole_proofs, range(SAMPLE, SAMPLE + ALL))
    print(dict(found))
    assert {"detected", "harmless"} <= set(found) <= {"detected", "harmless", "no edit"}, found
