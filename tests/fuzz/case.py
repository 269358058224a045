"""What is compared: a machine or composition in both forms, with all its states."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.proof.provers.limits import Limits
from tests.fuzz.build import Built
from tests.fuzz.explore import Space, search
from tests.fuzz.judge import Claim
from tests.fuzz.tally import Expect, Tally
from tests.fuzz.terms import reads
from tests.fuzz.world import Game, Whole

LIMITS = Limits(depth=12, induction=3, seconds=1.0)


@dataclass(frozen=True)
class Case:
    """A machine or composition in both forms, with all its states."""

    game: Game
    built: Built
    space: Space
    expect: Expect
    tally: Tally
    limits: Limits = LIMITS

    def board(self) -> Space:
        """All states on board, where they start otherwise than with the environment; else all states."""
        worlds = self.game.worlds if isinstance(self.game, Whole) else (self.game,)
        mixed = any(reads(term) & world.ghost_names for world in worlds for term in world.initially)
        return search(self.game.board()) if mixed else self.space

    def spoken_of(self, one: Claim) -> Space:
        """All states that a claim speaks of."""
        return self.untied() if one.unconditional else self.space

    def untied(self) -> Space:
        """All states for all inputs; the same ones where nothing ties the machine to its environment at the start."""
        loose = self.game.untied()
        return self.space if list(loose.firsts()) == list(self.game.firsts()) else search(loose)
