"""A host's map for the fibre machine: the next sections of the reported count, and the place of a word that was read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.nodes import Value
from safeloc.models.fibre.code import PositionCode, Symbol, Word
from safeloc.models.fibre.scenes.scene import Section
from safeloc.models.fibre.variables import SYMBOLS, FibreConfig
from safeloc.runtime.streams.steps import Cell

NOWHERE = Section(0, 0, Symbol(False, False))


class MapHost:
    """The sections in order, each at the place of an end when its amplitude changes: `shift_mm` beyond the section's edge."""

    def __init__(self, config: FibreConfig, sections: Sequence[Section], shift_mm: int) -> None:
        self._window = config.window
        self.sections = [
            Section(one.low_mm + shift_mm, one.high_mm + shift_mm, one.symbol, one.by_material) for one in sections
        ]
        symbols = tuple(one.symbol for one in sections)
        coded = len(symbols) >= config.window
        self._code = PositionCode(symbols, config.window, config.reach) if coded else None

    def below(self, place_mm: int) -> int:
        """Return how many sections lie wholly below a place."""
        return sum(one.high_mm < place_mm for one in self.sections)

    def answer(self, outputs: Mapping[str, Value]) -> dict[str, Cell]:
        """Return the inputs of the next step, from the machine's outputs of the last one."""
        count = int(outputs["count"])
        return self._record("ahead", count + 1, True) | self._record("behind", count, False) | self._word(outputs)

    def _record(self, name: str, number: int, forwards: bool) -> dict[str, Cell]:
        known = 1 <= number <= len(self.sections)
        one = self.sections[number - 1] if known else NOWHERE
        near, far = (one.low_mm, one.high_mm) if forwards else (one.high_mm, one.low_mm)
        return {
            f"{name}_known": known, f"{name}_near_mm": near, f"{name}_far_mm": far,
            f"{name}_rises": one.symbol.rises, f"{name}_long": one.symbol.long,
        }  # fmt: skip

    def _word(self, outputs: Mapping[str, Value]) -> dict[str, Cell]:
        found = self._found(outputs)
        if found is None:
            return {"word_found": False, "word_count": 0, "word_position_mm": 0}
        last, direction = found
        one = self.sections[last - 1]
        place, count = (one.high_mm, last) if direction > 0 else (one.low_mm, last - 1)
        return {"word_found": True, "word_count": count, "word_position_mm": place}

    def _found(self, outputs: Mapping[str, Value]) -> tuple[int, int] | None:
        """Return the section read last and the direction, if a whole word was read that the line has."""
        if self._code is None or int(outputs["word_length"]) != self._window:
            return None
        return self._code.decode(_spelt(int(outputs["word"]), self._window))


def _spelt(word: int, window: int) -> Word:
    """Return the symbols of a word, oldest first."""
    digits = [word // SYMBOLS**power % SYMBOLS for power in reversed(range(window))]
    return tuple(Symbol(digit >= SYMBOLS // 2, digit % 2 == 1) for digit in digits)
