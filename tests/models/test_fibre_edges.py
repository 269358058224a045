"""Where an edge of a section can have been passed: in the whole cycle in which it is seen, and since the last amplitude."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.nodes import Value
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre.code import Symbol
from safeloc.models.fibre.simulate import Drive, Section, on_board, simulate, steady
from safeloc.runtime.streams.steps import Cell

NEAR_LENGTHS = FibreConfig(long_mm=280_000)
SECTION = Section(1_000_000, 1_400_000, Symbol(rises=True, long=True))
RAISED_CDB, FAST_MM = 1_200, 50_000
SILENT = 4
NOTHING: dict[str, Cell] = {
    "reference_accepted": False, "reference_count": 0, "reference_position_mm": 0,
    "word_found": False, "word_count": 0, "word_position_mm": 0,
    **{f"{side}_{of}": False for side in ("ahead", "behind") for of in ("known", "rises", "long")},
    **{f"{side}_{of}_mm": 0 for side in ("ahead", "behind") for of in ("near", "far")},
}  # fmt: skip


def outputs(config: FibreConfig, steps: Sequence[dict[str, Cell]]) -> list[dict[str, Value]]:
    """What the machine on board tells after each step."""
    code, told = on_board(config.model_dump_json()), list[dict[str, Value]]()
    state, inputs = code.first(), {var.name for var in code.system.inputs}
    for step in steps:
        heard = {name: cell for name, cell in step.items() if name in inputs or name.endswith(("_cdb", "_mm"))}
        heard.pop("truth_mm", None)
        state, _ = code.step(state, code.read(heard))
        told.append(dict(code.named_outputs(state)))
    return told


def test_a_short_section_left_fast_is_no_long_one() -> None:
    """Entered at walking pace, left at 100 m/s within the cycle: what was run beyond its end is not taken for its length."""
    amplitudes = [0, RAISED_CDB, *[RAISED_CDB] * 4, 0]
    runs = [0, 1, *[55_000] * 5]
    steps = [NOTHING | {"amplitude_cdb": cdb, "run_mm": run} for cdb, run in zip(amplitudes, runs, strict=True)]
    told = outputs(NEAR_LENGTHS.model_copy(update={"max_speed_mm_s": 110_000}), steps)
    assert told[1]["position_signal"]
    assert told[-1]["word_length"] == 0


def test_an_edge_unheard_gets_the_error_of_the_run_since_the_last_amplitude() -> None:
    """The amplitude fails as a section begins, for four cycles: the interval holds the truth when the section is noticed."""
    config, drive = FibreConfig(), Drive(steady(30_000, 90), flight_off_mm=None)
    steps = simulate(config, seed=1, drive=drive, sections=[SECTION])
    seen = next(number for number, one in enumerate(outputs(config, steps)) if one["position_signal"])
    asked = {name: cell for name, cell in steps[seen].items() if name.startswith(("ahead", "behind"))}
    for step in steps[seen : seen + SILENT]:
        del step["amplitude_cdb"]
    told = outputs(config, [*steps[:seen], *(step | asked for step in steps[seen : seen + SILENT + 1])])[-1]
    assert told["position_signal"]
    assert told["valid"]
    off = int(steps[seen + SILENT]["truth_mm"]) - int(told["position_mm"])
    assert -told["margin_below_mm"] <= off <= told["margin_above_mm"]


def test_an_amplitude_changed_from_the_start_is_no_signal() -> None:
    """A train that stands in a section when its fibre is first heard has not entered it in that cycle."""
    told = outputs(FibreConfig(), [NOTHING | {"amplitude_cdb": RAISED_CDB, "run_mm": FAST_MM}] * 3)
    assert not any(one["position_signal"] or one["count_known"] for one in told)
    assert told[-1]["in_section"]


def test_an_amplitude_not_told_for_too_long_is_no_edge() -> None:
    """Where more was run unheard than is tolerable, the change that is found then has no place: nothing is located."""
    config = FibreConfig()
    steps = simulate(config, seed=1, drive=Drive(steady(30_000, 90)), sections=[SECTION])
    seen = next(number for number, one in enumerate(outputs(config, steps)) if one["position_signal"])
    for step in steps[seen - 25 : seen]:
        del step["amplitude_cdb"]
    told = outputs(config, steps)[seen]
    assert (told["valid"], told["position_signal"]) == (False, False)
