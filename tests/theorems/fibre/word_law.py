"""The law of the fibre machine's world about code words, asked of every way to read a word, through the host that looks it up."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from safeloc.codegen.compiled import Compiled
from safeloc.language.expr import BoolVar, NumVar
from safeloc.language.interpret import holds
from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.fibre import FibreConfig, parts
from safeloc.models.fibre.code import PositionCode, Word
from safeloc.models.fibre.scenes.map_host import MapHost
from safeloc.models.fibre.scenes.scene import Section
from safeloc.models.fibre.simulate import RAISED_CDB, SPACING_MM, on_board
from safeloc.models.fibre.variables import SYMBOLS
from safeloc.models.fibre.world import world
from safeloc.runtime.streams.steps import Cell
from tests.theorems.fibre.word_readings import NO_SECTION, Reading

LAW = "a code word that is found lies at its place"
RUN_MM = 25_000
"""Run of a cycle: each length is a multiple of it."""


class CodedLine:
    """A line with the sections of a code, a host that has it on its map, and the machine that is configured for it."""

    def __init__(self, code: PositionCode) -> None:
        self.config = config = FibreConfig(window=code.window, reach=code.reach)
        self.sections = [
            Section(low, low + (config.long_mm if symbol.long else config.short_mm), symbol)
            for low, symbol in zip(count(SPACING_MM, SPACING_MM), code.symbols, strict=False)
        ]
        self.host = MapHost(config, self.sections, 0)
        self._own = parts(config)
        self._term = world(self._own).terms[LAW]

    def truth(self, one: Reading) -> tuple[int, int]:
        """Return the edge that was passed last, mm, and how many sections lie below it."""
        assert one.number != NO_SECTION
        section = self.sections[one.number - 1]
        return (section.high_mm, one.number) if one.step > 0 else (section.low_mm, one.number - 1)

    def keeps(self, one: Reading) -> bool:
        """Whether the term of the law holds in the cycle in which the host answers to this word."""
        told = self.host.answer({"count": 0, "word": _as_number(one.word), "word_length": len(one.word)})
        edge_mm, below = self.truth(one)
        values: dict[NumVar | BoolVar, int | bool] = {
            self._own.word_found: bool(told["word_found"]),
            self._own.word_position: int(told["word_position_mm"]),
            self._own.word_count: int(told["word_count"]),
            self._own.ghosts.edge: edge_mm * NM_PER_MM,
            self._own.ghosts.count: below,
        }
        return holds(self._term, values)

    def after(self, one: Reading) -> dict[str, Value]:
        """Return what the machine tells in the cycle after it has read the word, in which the host answers."""
        machine = on_board(self.config.model_dump_json())
        state = machine.first()
        for amplitude_cdb, run_mm in self._cycles(one):
            told: dict[str, Cell] = self.host.answer(machine.named_outputs(state))
            state = _stepped(machine, state, told | {"amplitude_cdb": amplitude_cdb, "run_mm": run_mm})
        return machine.named_outputs(state)

    def _cycles(self, one: Reading) -> Iterator[tuple[int, int]]:
        """Yield amplitude and run of every cycle: each section after a cycle beside it, and one beside the last."""
        run_mm = one.step * RUN_MM
        yield 0, 0
        for symbol in one.word:
            amplitude_cdb = RAISED_CDB if symbol.rises else -RAISED_CDB
            length_mm = self.config.long_mm if symbol.long else self.config.short_mm
            yield 0, run_mm
            yield from [(amplitude_cdb, run_mm)] * (length_mm // RUN_MM)
            yield 0, run_mm
        yield 0, run_mm


def _stepped(machine: Compiled, state: tuple[Value, ...], inputs: dict[str, Cell]) -> tuple[Value, ...]:
    unreferred: dict[str, Cell] = {"reference_accepted": False, "reference_count": 0, "reference_position_mm": 0}
    return machine.step(state, machine.read(inputs | unreferred))[0]


def _as_number(word: Word) -> int:
    """Return the word as the machine tells it: the newest symbol is the last digit."""
    number = 0
    for symbol in word:
        number = SYMBOLS * number + symbol.number
    return number
