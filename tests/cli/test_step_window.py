"""The window of `safeloc step`, driven by keys: what is shown is what the stepper has, and what is wrong is told."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from textual import events
from textual.pilot import Pilot
from textual.widgets import DataTable, Input, Static

from safeloc.catalogue import load_target
from safeloc.cli import step as command
from safeloc.cli.step_window import StepWindow, _cut
from safeloc.explain.stepping import Stepper
from safeloc.language.expr import boolean, choice, enumeration, members, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.system import lower
from safeloc.language.units import COUNT, MM
from safeloc.language.world import World
from safeloc.runtime.streams.steps import read_steps
from safeloc.target import Target
from tests.explain import pump

Deed = Callable[[Pilot[None]], Awaitable[None]]


def lamp() -> Target:
    """A lamp with inputs of every kind, one with a name that could be taken for markup."""
    off, on = modes("OFF", "ON")
    colours = members("colour", "RED", "GREEN")
    go, uses = boolean("go"), number("uses [red]", COUNT, 0, 9)
    heard, colour = optional("heard", MM, -5, 5), choice("colour", enumeration(colours))
    machine = Machine(
        name="lamp",
        modes=(off, on),
        inputs=[go, heard, colour],
        state={uses: 0},
        outputs={"uses_left": 9 - uses},
        transitions=[
            Transition("on", off, on, go & (uses < 9), {uses: uses + 1}),
            Transition("off", on, off, ~go & colour.eq(colours[1])),
        ],
        world=World(clauses={"nobody switches": ~go}),
    )
    return Target("lamp", (machine,), lower(machine), (never("worn", uses > 0),))


@dataclass
class Seen:
    """What the window shows: its texts and what is in the line, by id; its tables, row by row."""

    stepper: Stepper
    watched: list[str]
    texts: dict[str, str]
    tables: dict[str, list[list[str]]]


def driven(stepper: Stepper, *deeds: Deed) -> Seen:
    """The window after these deeds."""

    async def drive() -> Seen:
        window = StepWindow(stepper)
        async with window.run_test(size=(160, 40)) as pilot:
            for deed in deeds:
                await deed(pilot)
                await pilot.pause()
            texts = {f"#{one.id}": str(one.content) for one in window.query(Static) if one.id}
            texts["#line"] = window.query_one("#line", Input).value
            tables = {str(one.id): _cells(one) for one in window.query(DataTable)}
            return Seen(stepper, window.watched, texts, tables)

    return asyncio.run(drive())


def _cells(shown: DataTable[Any]) -> list[list[str]]:
    return [[str(cell) for cell in shown.get_row_at(row)] for row in range(shown.row_count)]


def keys(*names: str) -> Deed:
    """Press these keys."""
    return lambda pilot: pilot.press(*names)


def line(text: str) -> Deed:
    """Type a command into the line, and press enter."""

    async def deed(pilot: Pilot[None]) -> None:
        await pilot.press("colon")
        pilot.app.query_one("#line", Input).value = text
        await pilot.press("enter")

    return deed


def told(window: Seen, place: str = "#told") -> str:
    """The text of a place."""
    return window.texts[place]


def table(window: Seen, name: str) -> list[list[str]]:
    """The cells of a table, row by row."""
    return window.tables[name]


def test_the_first_state_is_shown() -> None:
    """Inputs with what they may be, modes before other values, and why no transition fires."""
    window = driven(Stepper(lamp()))
    assert table(window, "inputs") == [
        ["go", "false", "rest", "true, false"],
        ["heard", "absent", "rest", "-5..5 mm"],
        ["colour", "RED", "rest", "RED, GREEN"],
    ]
    assert table(window, "values") == [["mode", "OFF", ""], ["uses [red]", "0", ""], ["uses_left", "9", ""]]
    assert told(window, "#head") == "lamp   step 0"
    assert [one.strip() for one in told(window, "#rows").splitlines()] == [
        "refused  lamp: on -> ON", "false go and (uses [red] < 9 count)", "false go",
    ]  # fmt: skip


def test_a_step_by_keys() -> None:
    """Enter on a truth value changes it; the law that this breaks is told before the step; what changed has its former value."""
    before = driven(Stepper(lamp()), keys("enter"))
    assert table(before, "inputs")[0] == ["go", "true", "set", "true, false"]
    assert "the next step breaks the law lamp: nobody switches" in told(before, "#head")
    assert told(before, "#rows") == "fires    lamp: on -> ON"
    after = driven(Stepper(lamp()), keys("enter", "n"))
    assert told(after) == "step 1: on"
    assert table(after, "values") == [["mode", "ON", "OFF"], ["uses [red]", "1", "0"], ["uses_left", "8", "9"]]
    back = driven(Stepper(lamp()), keys("enter", "n", "b"))
    assert table(back, "values")[0] == ["mode", "OFF", ""]
    assert back.stepper.number == 0


def test_a_number_is_typed() -> None:
    """Enter on another input begins its command in the line; escape leaves it; a refused value stays, with the reason."""
    asked = driven(Stepper(lamp()), keys("down", "enter"))
    assert asked.texts["#line"] == "set heard="
    given = driven(Stepper(lamp()), keys("down", "enter", "4", "enter"))
    assert table(given, "inputs")[1][:3] == ["heard", "4", "set"]
    assert given.texts["#line"] == ""
    wrong = driven(Stepper(lamp()), keys("down", "enter", "9", "enter"))
    assert told(wrong) == "heard: 9 mm is outside -5..5."
    assert wrong.texts["#line"] == "set heard=9"
    left = driven(Stepper(lamp()), keys("down", "enter", "9", "escape", "n"))
    assert left.stepper.number == 1
    assert table(left, "inputs")[1][1] == "absent"


def test_values_are_watched_and_filtered() -> None:
    """What is watched stands first and stays; a filter leaves rows out."""
    window = driven(Stepper(lamp()), keys("tab", "down", "w"))
    assert [row[:2] for row in table(window, "values")] == [["uses [red]", "★ 0"], ["mode", "OFF"], ["uses_left", "9"]]
    again = driven(Stepper(lamp()), keys("tab", "down", "w", "up", "w"))
    assert again.watched == []
    filtered = driven(Stepper(lamp()), line("watch mode"), line("filter left"))
    assert [row[0] for row in table(filtered, "values")] == ["mode", "uses_left"]
    assert table(filtered, "inputs") == []
    assert told(filtered, "#head") == "lamp   step 0   filter: left"


def test_a_recording_is_gone_through_and_ends() -> None:
    """Several steps stop where it ends; one by one they go on at rest."""
    stepper = Stepper(lamp(), recorded=[{"go": True, "colour": 0}, {"go": False, "colour": 1}])
    window = driven(stepper, line("step 5"))
    assert (
        told(window)
        == "the recording ends at step 2: 2 of 5 steps taken; further steps take what you set, and all else is at rest"
    )
    assert told(window, "#head") == "lamp   step 2 of 2 recorded"
    assert [list(one.fired.values()) for one in stepper.trace.steps] == [["on"], ["off"]]
    assert table(window, "inputs")[0][2] == "rest"
    further = driven(window.stepper, keys("n"))
    assert further.stepper.number == 3


def test_a_run_is_saved(tmp_path: Path) -> None:
    """As the line saves it; an existing file is not written over."""
    path = tmp_path / "run.jsonl"
    window = driven(Stepper(lamp()), keys("enter", "n", "n"), line(f"save {path}"))
    assert told(window) == f"2 steps: {path}"
    assert run(lamp().system, read_steps(path).steps).steps == window.stepper.trace.steps
    twice = driven(window.stepper, line(f"save {path}"))
    assert told(twice).startswith(f"{path} exists; give another file")
    nowhere = driven(window.stepper, line(f"save {tmp_path}/none/run.jsonl"))
    assert told(nowhere) == f"{tmp_path}/none/run.jsonl: cannot be written: No such file or directory."


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fly", "'fly' is no command: "),
        ("", "type a command, or press escape."),
        ("step two", "step 'two': give a number of steps, 1 or more."),
        ("back", "there are 0 steps to take back, not 1."),
        ("set go", "'go': write NAME=VALUE, without blanks around the sign."),
        ("set gone=1", "lamp has no input 'gone'; it has go, heard, colour."),
        ("set go=absent", "lamp: input 'go' is never absent; give it a value."),
        ("watch 'uses", '"\'uses": a quote has no end.'),
        ("watch gone", "there is no variable or output 'gone'; `state` and `outputs` list them."),
        ("save", "save needs the name of a file."),
        ("save none.jsonl", "no step was taken; there is no run to save."),
    ],
)
def test_what_is_wrong_is_told(text: str, message: str) -> None:
    """And changes nothing."""
    window = driven(Stepper(lamp()), line(text))
    assert told(window).startswith(message)
    assert window.stepper.number == 0


def test_broken_properties_are_told() -> None:
    """On demand, since they are checked over the whole run."""
    window = driven(Stepper(lamp()), keys("n"), line("broken"))
    assert told(window) == "no property is broken so far"
    window = driven(Stepper(lamp()), keys("enter", "n"), line("broken"))
    assert told(window).splitlines() == ["no property is broken so far", "claims nothing since step 1: worn"]


@pytest.mark.parametrize(
    ("is_terminal", "term", "shown"), [(True, "xterm", True), (True, "dumb", False), (False, "xterm", False)]
)
def test_where_a_window_is_shown(monkeypatch: pytest.MonkeyPatch, is_terminal: bool, term: str, shown: bool) -> None:
    """On a terminal that can draw, with Textual; else commands are lines."""
    monkeypatch.setattr("sys.stdout.isatty", lambda: is_terminal, raising=False)
    monkeypatch.setenv("TERM", term)
    assert command._can_show() is shown  # pyright: ignore[reportPrivateUsage]
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    assert not command._can_show()  # pyright: ignore[reportPrivateUsage]


def test_a_violation_is_told_at_once() -> None:
    """Below the step that made it, and whatever further steps are taken by the same command."""
    stepper = Stepper(pump.target(pump.TOO_MANY), {"label": 1})
    window = driven(stepper, line("hold extra=absent"), line("set go=true"), line("step 7"))
    assert "step 5: VIOLATED too many strokes" in told(window).splitlines()
    assert "held" == {row[0]: row[2] for row in table(window, "inputs")}["extra"]
    window = driven(Stepper(pump.target(pump.TOO_MANY), {"label": 1}), line("hold extra=absent"), line("release extra"))
    assert "rest" == {row[0]: row[2] for row in table(window, "inputs")}["extra"]


def test_keys_that_come_at_once_are_typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What follows the key of a command in one burst is for the line, as over a slow connection: `n` of `run` is no step."""
    monkeypatch.chdir(tmp_path)

    async def burst(pilot: Pilot[None]) -> None:
        for key in ("n", "s", *"run"):
            pilot.app.post_message(events.Key(key, key))
        await pilot.pause()

    window = driven(Stepper(lamp()), burst)
    assert (1, "save run") == (window.stepper.number, told(window, "#line"))


def test_a_filter_leaves_what_fires_and_no_column_wider_than_its_rows() -> None:
    """The next transition is in sight whatever is filtered; the value stands beside the longest name that is left."""

    async def look() -> tuple[list[str], list[tuple[int, int]]]:
        window = StepWindow(Stepper(load_target("odometry")))
        async with window.run_test(size=(80, 24)) as pilot:
            await pilot.press("slash", *"position", "enter")
            await pilot.pause()
            shown = window.query_one("#values", DataTable)
            widest = [max(len(cells[place]) for cells in _cells(shown)) for place in range(2)]
            columns = [
                (column.content_width, wide) for column, wide in zip(shown.ordered_columns, widest, strict=False)
            ]
            return str(window.query_one("#rows", Static).content).splitlines(), columns

    lines, columns = asyncio.run(look())
    assert lines[0].startswith("fires ")
    assert all(line.startswith("fires ") or not line.startswith("refused ") for line in lines)
    assert [(wide, wide) for _, wide in columns] == columns


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (120, 40)])
def test_values_are_in_sight_on_a_small_screen(columns: int, rows: int) -> None:
    """Of each shown row the value is not cut, however long its name; what fires is the first transition, and the line can be seen."""

    async def look() -> tuple[list[str], list[str], int]:
        window = StepWindow(Stepper(load_target("odometry")))
        async with window.run_test(size=(columns, rows)) as pilot:
            await pilot.pause()
            await pilot.pause()
            cut = [
                f"{one.id}: {cells[0]} {cells[1]}"
                for one in window.query(DataTable)
                for cells in _cells(one)
                if max(len(row[0]) for row in _cells(one)) + len(cells[1]) + 4 > one.size.width
            ]
            line = window.query_one("#line", Input).region
            return cut, str(window.query_one("#rows", Static).content).splitlines(), line.bottom

    cut, lines, bottom = asyncio.run(look())
    assert [] == cut
    assert lines[0].startswith("fires ")
    assert bottom <= rows


def test_a_cut_name_keeps_its_ends_and_stands_below_its_table() -> None:
    """The beginning names the machine, the end the unit; the whole name of the chosen row is told."""
    assert "odom\N{HORIZONTAL ELLIPSIS}above_mm" == _cut("odometry.margin_above_mm", 13)
    assert "odometry.margin_above_mm" == _cut("odometry.margin_above_mm", 24)

    async def chosen() -> str:
        window = StepWindow(Stepper(load_target("odometry")))
        async with window.run_test(size=(80, 24)) as pilot:
            await pilot.press("down")
            await pilot.pause()
            return str(window.query_one("#inputs", DataTable).border_subtitle)

    assert "front_radar_mm" == asyncio.run(chosen())
