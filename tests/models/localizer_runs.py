"""The localizer along its journeys: compiled once, and what it said on them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.nodes import Value
from safeloc.language.system import without_ghosts
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.localizer.simulation.simulate import Journey, simulate
from safeloc.reported import Reported

CONFIG = LocalizerConfig()
REPORTED = Reported(
    position="delocalized.position_mm", below="delocalized.margin_below_mm", above="delocalized.margin_above_mm",
    valid="delocalized.restrictive", valid_is=False,
)  # fmt: skip
"""Where the whole tells its interval, as the catalogue has it."""


@dataclass(frozen=True)
class Told:
    """What was told on a journey: which transitions fired how often, the outputs of every cycle, and the truth in mm."""

    fired: Mapping[str, int]
    outputs: tuple[Mapping[str, Value], ...]
    truth_mm: tuple[int, ...]

    @property
    def standings(self) -> Counter[str]:
        """How the intervals stand to the truth."""
        return Counter(REPORTED.standing(out, truth) for out, truth in zip(self.outputs, self.truth_mm, strict=True))


@cache
def code() -> Compiled:
    """The localizer without its environment."""
    return compile_system(without_ghosts(compose_machines(CONFIG).composition.system))


def run(journey: Journey, *, seed: int = 3) -> Told:
    """What it says on a journey."""
    board = code()
    names = {var.name for var in board.system.inputs}
    state, fired, outputs, truth = board.first(), Counter[str](), list[Mapping[str, Value]](), list[int]()
    for step in simulate(CONFIG, journey, seed=seed):
        state, numbers = board.step(state, board.read({name: cell for name, cell in step.items() if name in names}))
        fired.update(f"{key.removesuffix('.fired')}: {name}" for key, name in board.fired(numbers).items())
        outputs.append(board.named_outputs(state))
        truth.append(int(step["truth_mm"]))
    return Told(fired, tuple(outputs), tuple(truth))
