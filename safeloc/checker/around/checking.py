"""Check of a folder that `safeloc prove --around --out` wrote: each claim again, from the hand-over sets alone."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from safeloc.checker.answer import CONFIRMED, NO_PROOF, OPEN, WRONG, Answer
from safeloc.checker.around.question import CERTIFICATE, Claim, Question, read_question
from safeloc.checker.around.streams import first_broken, first_outside, ran
from safeloc.checker.around.tube import Tube
from safeloc.checker.around.windows import LATE, Piece, Setting, Stretch, first_values, not_shown, show
from safeloc.checker.dag import Dag
from safeloc.checker.folder import Checked, Checking, asked, check_target, processes, take_usable
from safeloc.checker.rules import Theory
from safeloc.checker.solve import Opinion
from safeloc.checker.terms import Translation
from safeloc.errors import InputError, SafelocError
from safeloc.language.expr import TRUE, Var, all_of
from safeloc.language.interpret import holds
from safeloc.language.spec import Property, observe, watch
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables
from safeloc.runtime.streams.steps import read_steps

Progress = Callable[[int, int], None]
_TEXTS = "certificates"


def is_around(folder: Path) -> bool:
    """Return whether a folder holds the certificate of a proof around a stream."""
    return (folder / CERTIFICATE).exists()


def check_around(
    folder: Path, *, jobs: int = 2, seconds: float = 60.0, progress: Progress = lambda _, __: None
) -> Checking:
    """Check all claims of the folder; `seconds` is the limit of a solver for each goal. InputError if it cannot be read."""
    return _Check(read_question(folder), jobs, seconds, progress).all()


@dataclass(eq=False)
class _Check:
    of: Question
    jobs: int
    seconds: float
    progress: Progress

    def __post_init__(self) -> None:
        self.found = Checking()
        self.texts = _texts(self.of.folder)

    def all(self) -> Checking:
        """Check every claim."""
        rows = self.of.data["claims"]
        failed: dict[int, list[str]] = {}
        for number in sorted({row["passage"] for row in rows if row["passage"] is not None}):
            try:
                failed[number] = self._passage(number, [row for row in rows if row["passage"] == number])
            except (SafelocError, KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
                failed[number] = [f"its certificate cannot be used: {type(error).__name__}: {error}"]
        for row in rows:
            try:
                answer, why = self._answer(row, failed)
            except (SafelocError, KeyError, TypeError, ValueError, OSError) as error:
                answer, why = WRONG, str(error)
            self.found.rows.append(Checked(str(row["id"]), str(row["verdict"]), answer, why))
        return self.found

    # -------------------------------------------------------------- one claim

    def _answer(self, row: Mapping[str, Any], failed: Mapping[int, Sequence[str]]) -> Answer:
        claim = self.of.claim(row)
        name = f"{self.of.target.name}/around {self.of.data['stream']['name']}/{claim.prop.name}"
        if row["id"] != name:
            return WRONG, f"it is the claim {name}"
        if row["verdict"] == "violated":
            return self._broken(row, claim)
        if row["verdict"] != "proved":
            return NO_PROOF, f"{row['verdict']}: no proof is claimed"
        if row["passage"] is None:
            return self._in_general(row, claim)
        if failed[row["passage"]]:
            why = "; ".join(failed[row["passage"]][:3])
            return (OPEN if all(one.endswith(LATE) for one in failed[row["passage"]]) else WRONG), why
        return self._speaks(claim)

    def _speaks(self, claim: Claim) -> Answer:
        """Check that there is a lawful stream in the tube, and that the claim says something of the stream given."""
        if not claim.prop.unconditional and (why := self._no_witness(claim)):
            return WRONG, why
        if not (claim.there is None or claim.there is TRUE or self._is_there(claim)):
            return (
                WRONG,
                "in no cycle of the stream given all values are there that the claim reads, so it says nothing",
            )
        return CONFIRMED, ""

    def _no_witness(self, claim: Claim) -> str:
        """Return why no stream is shown that lies in the tube and obeys the laws; "" if one is."""
        file = self.of.data["witness"]
        if file is None:
            return "it is not shown that a stream of the tube obeys the laws"
        system = self.of.way([claim], lawful=True)
        try:
            witness = ran(system, read_steps(self._beside(file)))
        except SafelocError as error:
            return f"the stream that is to obey the laws: {error}"
        if len(witness.rows) != self.of.length:
            return f"the stream that is to obey the laws has {len(witness.rows)} of {self.of.length} cycles"
        outside = first_outside(self.of, witness, system)
        return "" if outside is None else f"the stream that is to obey the laws leaves the tube in cycle {outside}"

    def _is_there(self, claim: Claim) -> bool:
        """Return whether in some cycle of the stream given all values are there; one that reads the truth is not judged."""
        board = self.of.way([claim], lawful=False)
        if not _reads_only(claim.there, board):
            return True
        states, rows = self.of.given.board, self.of.given.rows
        return any(holds(claim.there, {**rows[n - 1], **states[n]}) for n in claim.cycles(self.of.length) if n > 0)

    def _in_general(self, row: Mapping[str, Any], claim: Claim) -> Answer:
        """Check the proof for all lawful streams."""
        if row["written"] or self.of.data["without"]:
            return WRONG, "a proof for all lawful streams is of a declared property, with all laws"
        found = Checking(wrong=self.found.wrong, opinions=self._opinions(self.texts))
        result = {
            "id": f"{self.of.target.name}/property/{claim.prop.name}",
            "kind": "property",
            "verdict": "proved",
            "method": "",
            "certificates": row["certificates"],
        }
        check_target(self.of.target, [result], self.texts, lambda _: None, found)
        [checked] = found.rows
        return (checked.answer, checked.why) if checked.answer != CONFIRMED else self._speaks(claim)

    def _broken(self, row: Mapping[str, Any], claim: Claim) -> Answer:
        """Check that a stream of the tube breaks the claim in its last cycle, and not before."""
        stream = read_steps(self._beside(row["run"]))
        names = {name for record in stream.steps for name in record}
        lawful = not claim.prop.unconditional or any(var.name in names for var in self.of.system.ghosts)
        system = self.of.way([claim], lawful=lawful)
        goal = observe(system, _plain(claim))
        found = ran(system, stream, claim, goal)
        if (outside := first_outside(self.of, found, system)) is not None:
            return WRONG, f"its run leaves the tube in cycle {outside}"
        if first_broken(claim, goal, found) != len(found.rows):
            return WRONG, "its run does not break the claim in its last cycle"
        return CONFIRMED, ""

    def _beside(self, file: object) -> Path:
        path = self.of.folder / str(file)
        if path.parent != self.of.folder:
            raise InputError(f"{path}: the streams of a certificate stand beside it")
        return path

    # -------------------------------------------------------------- one passage

    def _passage(self, number: int, rows: Sequence[Mapping[str, Any]]) -> list[str]:
        """Return what is not confirmed of a passage: nothing if all its claims hold in every cycle in which they are judged."""
        data = self.of.data["passages"][number]
        claims = [self.of.claim(row) for row in data["together"]]
        places = [_place(data["together"], row) for row in rows]
        setting = self._setting(data, claims)
        tasks = list(enumerate(_stretches(data, claims, places, self.of.length), 1))
        done = 0
        _INHERITED.append(setting)
        with multiprocessing.get_context("fork").Pool(processes(self.jobs, len(tasks))) as pool:
            for told in pool.imap_unordered(partial(_shown, self.seconds), tasks):
                done += 1
                self.progress(done, len(tasks))
                self.found.opinions |= {f"passage {number}: {what}": opinion for what, opinion in told}
        _INHERITED.pop()
        mine = f"passage {number}: "
        of_it = {what.removeprefix(mine): one for what, one in self.found.opinions.items() if what.startswith(mine)}
        return sorted(why for what, one in of_it.items() if (why := not_shown(what, one)))

    def _setting(self, data: Mapping[str, Any], claims: Sequence[Claim]) -> Setting:
        system = self.of.way(claims, lawful=bool(data["lawful"]))
        goals = [observe(system, _plain(one)) for one in claims]
        watched = watch(system, goals).system
        theory = self._theory(system, data["facts"]) if data["lawful"] else None
        write = Translation(Dag()) if theory is None else theory.write
        facts = [] if theory is None else sorted(theory.together.known(lawful=True))
        known = {var.name for var in (*system.inputs, *system.state)}
        widths = {name: width for name, width in self.of.widths.items() if name in known}
        tube = Tube(system, self.of.given, widths, self.of.channels, write)
        restarts: dict[int, dict[Var, int | bool]] = {}
        for one, goal in zip(claims, goals, strict=True):
            if one.first > 1:
                restarts.setdefault(one.first - 1, {}).update(first_values(goal))
        return Setting(watched, goals, tube, write, facts, restarts)

    def _theory(self, system: TransitionSystem, files: Sequence[str]) -> Theory:
        """Return what certificates establish of every state of a system."""
        theory = Theory(system, lambda _, __: ())
        texts = {name: self.texts[name] for name in files}
        found = Checking(wrong=self.found.wrong, opinions=self._opinions(texts))
        take_usable(list(texts), texts, theory, found)
        return theory

    def _opinions(self, texts: Mapping[str, str]) -> dict[str, Any]:
        return dict(asked(self.seconds, list(texts.items())))


_INHERITED: list[Setting] = []
"""The setting that a forked process inherits from its parent."""


def _shown(seconds: float, task: tuple[int, Stretch]) -> list[tuple[str, Opinion]]:
    number, stretch = task
    return [(f"{what}.{number}", opinion) for what, opinion in show(_INHERITED[-1], stretch, seconds)]


def _stretches(
    data: Mapping[str, Any], claims: Sequence[Claim], places: Sequence[int], length: int
) -> Iterator[Stretch]:
    """Yield what has to be shown so that the claims at these places hold in every cycle in which they are judged."""
    handed = [(int(one["cycle"]), tuple(map(_piece, one["pieces"]))) for one in data["handed"]]
    judged = {place: claims[place].cycles(length) for place in places}
    last = max(cycles[-1] for cycles in judged.values())
    sets: list[tuple[int, tuple[Piece, ...] | None]] = [(0, None), *(one for one in handed if one[0] < last)]
    ends = [*(cycle for cycle, _ in sets[1:]), last]
    if any(end <= begin for (begin, _), end in zip(sets, ends, strict=True)) and last > 0:
        raise InputError("the hand-overs are not in order")
    back = [one for place in places for one in _backs(data, claims, place, sets)]
    yield Stretch(0, None, 0, tuple((place, cycles[:1]) for place, cycles in judged.items() if cycles[0] == 0))
    for number, (begin, pieces) in enumerate(sets if last > 0 else []):
        end, after = ends[number], sets[number + 1][1] if number + 1 < len(sets) else None
        asked_of = list[tuple[int, range]]()
        for place, cycles in judged.items():
            here = range(max(begin + 1, cycles[0]), min(end, cycles[-1]) + 1)
            shown = [one for one in back if one[0] == place]
            asked_of += [(place, range(n, n + 1)) for n in here if not any(n in cycles for _, _, cycles in shown)]
        for piece in (None,) if pieces is None else pieces:
            yield Stretch(begin, piece, end, tuple(asked_of), after)
    for place, start, cycles in back:
        begin, pieces = sets[start]
        for piece in (None,) if pieces is None else pieces:
            yield Stretch(begin, piece, cycles[-1], ((place, cycles),))


def _backs(
    data: Mapping[str, Any], claims: Sequence[Claim], place: int, sets: Sequence[tuple[int, object]]
) -> Iterator[tuple[int, int, range]]:
    """Yield the cycles of a claim that are shown from an earlier hand-over, with its number."""
    claim = claims[place]
    for one in data["back"]:
        if one["claim"] == claim.prop.name:
            start, first, last = int(one["from"]), int(one["first"]), int(one["last"])
            if not 0 <= start < len(sets) or not sets[start][0] < first <= last:
                raise InputError("a claim is to be shown from a later hand-over, or from none")
            judged = claim.cycles(last)
            yield place, start, range(max(first, judged[0]), min(last, judged[-1]) + 1)


def _piece(data: Mapping[str, Any]) -> Piece:
    fixed, ranges = dict(data["fixed"]), {name: (low, high) for name, (low, high) in data["ranges"].items()}
    if not all(isinstance(end, int) and not isinstance(end, bool) for ends in ranges.values() for end in ends):
        raise InputError("the ends of a range are whole numbers")
    if not all(isinstance(value, int) for value in fixed.values()):
        raise InputError("constants are whole numbers or truth values")
    return Piece(fixed, ranges)


def _place(together: Sequence[Mapping[str, Any]], row: Mapping[str, Any]) -> int:
    """Return the place of a claim among those that were run together."""
    keys = ("written", "claim", "first", "last")
    places = [n for n, one in enumerate(together) if all(one[key] == row[key] for key in keys)]
    if len(places) != 1:
        raise InputError(f"{row['claim']}: its passage is about other claims")
    return places[0]


def _plain(claim: Claim) -> Property:
    """Return a property without its assumption, which the system that is run has."""
    return replace(claim.prop, unconditional=False, further_assumption=TRUE)


def _reads_only(term: Any, system: TransitionSystem) -> bool:
    known = {*system.state, *system.inputs}
    return all(var in known for var in variables([all_of([term])]))


def _texts(folder: Path) -> dict[str, str]:
    place = folder / _TEXTS
    return (
        {path.name: path.read_text(encoding="utf-8") for path in sorted(place.glob("*.smt2"))} if place.is_dir() else {}
    )
