"""The window of `safeloc step` in a terminal, with Textual (extra `step`): inputs, values, and what refuses each transition.

It does what the commands of the line do; a line at the bottom takes them, and keys write the usual ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.widgets import DataTable, Footer, Input, Static

from safeloc.cli.step_lines import (
    assignments,
    broken_lines,
    end_told,
    number_of_steps,
    quoted,
    refuse_unknown,
    row_lines,
    words,
)
from safeloc.errors import InputError
from safeloc.explain.stepping import ABSENT, Stepper
from safeloc.language.expr import NumVar, Var
from safeloc.language.units import Enumeration

_HELP = "set NAME=VALUE ...   hold NAME=VALUE ...   release NAME ...   step N   back N   watch NAME ...   filter WORD   broken   save FILE   quit"
_SHORT_HELP = "set NAME=VALUE  step N  back N  watch NAME  filter WORD  save FILE  help"
_STYLES = {"fires": "bold green", "enabled": "green", "refused": "dim"}


_AROUND = 6
"""Columns beside name and value: a space on either side of each, and the scroll bar."""
_LEAST = 12
"""Least letters of a name."""
_BY_LETTER = {"take", "undo", "watch", "ask", "quit"}
"""What keys do that type a letter in the line."""


class StepWindow(App[None]):
    """A machine that is run by hand."""

    ENABLE_COMMAND_PALETTE = False
    CSS = """
    #head { padding: 0 1; background: $panel; }
    #tables { height: 1fr; }
    #inputs { width: 33%; border: round $primary; }
    #values { width: 35%; border: round $primary; }
    #transitions { width: 32%; border: round $primary; padding: 0 1; }
    #told { padding: 0 1; max-height: 8; }
    .-narrow #tables { layout: grid; grid-size: 2 2; grid-rows: 3fr 2fr; }
    .-narrow #inputs, .-narrow #values, .-narrow #transitions { width: 100%; height: 100%; }
    .-narrow #transitions { column-span: 2; }
    .-narrow DataTable, .-narrow #transitions { scrollbar-size-vertical: 1; }
    .-short #line { border: none; height: 1; padding: 0 1; background: $panel; }
    .-short #told { max-height: 3; }
    """
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012  # Textual declares it without ClassVar
    VERTICAL_BREAKPOINTS = [(0, "-short"), (30, "-tall")]  # noqa: RUF012  # as above
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "take", "step", priority=True),
        Binding("b", "undo", "undo", priority=True),
        Binding("w", "watch", "watch", priority=True),
        Binding("slash", "ask('filter ')", "filter", priority=True),
        Binding("s", "ask('save ')", "save", priority=True),
        Binding("colon", "ask('')", "command", priority=True),
        Binding("escape", "leave", "tables", show=False),
        Binding("q", "quit", "quit", priority=True),
    ]

    def __init__(self, stepper: Stepper) -> None:
        super().__init__()
        self.stepper = stepper
        self.watched: list[str] = []
        self._word = ""
        self._before: Mapping[str, str] = {}
        self._commands: Mapping[str, Callable[[str], None]] = {
            "set": self._set,
            "hold": self._hold,
            "release": self._release,
            "step": self._step,
            "back": self._back,
            "watch": self._watch,
            "filter": self._filter,
            "broken": self._broken,
            "save": self._save,
            "help": lambda _: self._tell(_HELP),
            "quit": lambda _: self.exit(),
        }

    def compose(self) -> ComposeResult:
        """Lay out the window."""
        yield Static(id="head")
        with Horizontal(id="tables"):
            yield _table("inputs", "inputs of the next step", ("input", "value", "from", "may be"))
            yield _table("values", "state and outputs", ("name", "value", "before"))
            with VerticalScroll(id="transitions") as scroll:
                scroll.border_title = "transitions of this mode"
                yield Static(id="rows")
        yield Static(id="told")
        yield Input(id="line", placeholder=_SHORT_HELP, select_on_focus=False)
        yield Footer()

    def on_mount(self) -> None:
        """Show the first state."""
        self._show()
        self.query_one("#inputs", DataTable).focus()

    def on_resize(self) -> None:
        """Cut names to the room that they have now."""
        self.call_after_refresh(self._show)

    # -------------------------------------------------------------- keys and the line

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:  # noqa: ARG002  (Textual calls it with both)
        """Say whether a key acts: in the line it types its letter, and the footer shows that key as resting.

        Keys have priority, so that of several that come at once (a quick hand, a slow connection) those after `s` are already for the line.
        """
        return None if action in _BY_LETTER and isinstance(self.focused, Input) else True

    def action_take(self) -> None:
        """Take one step."""
        self._run("step")

    def action_undo(self) -> None:
        """Take one step back."""
        self._run("back")

    def action_watch(self) -> None:
        """Watch the chosen value, or watch it no more."""
        name = self._chosen("values")
        left = [one for one in self.watched if one != name]
        names = left if name in self.watched else [*left, name]
        self._run(f"watch {' '.join(map(quoted, names))}")

    def action_ask(self, beginning: str) -> None:
        """Begin a command in the line."""
        line = self.query_one("#line", Input)
        line.value = beginning
        self.set_focus(line)  # at once; `line.focus()` waits, and keys that came meanwhile would be for the tables
        line.action_end()

    def action_leave(self) -> None:
        """Leave the line."""
        self.query_one("#line", Input).value = ""
        self.query_one("#inputs", DataTable).focus()

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Say the whole name of the chosen row below its table, where it may be cut."""
        event.data_table.border_subtitle = Content(str(event.row_key.value or ""))

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        """Change the chosen input: a truth value at once, another one in the line."""
        if event.data_table.id != "inputs":
            self.action_watch()
            return
        name = str(event.row_key.value)
        var = self.stepper.system.variable(name)
        if isinstance(var, NumVar):
            self.action_ask(f"set {quoted(name)}=")
        else:
            self._run(f"set {quoted(name)}={'false' if self.stepper.inputs[name] == 'true' else 'true'}")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Run the command of the line; a refused one stays in it."""
        if self._run(event.value):
            self.action_leave()

    def _run(self, line: str) -> bool:
        """Run a command; return whether it was done. What was wrong is told."""
        word, _, text = line.strip().partition(" ")
        self._tell("")
        try:
            if word not in self._commands:
                raise InputError(f"{word!r} is no command: {_HELP}" if word else "type a command, or press escape.")
            self._commands[word](text.strip())
        except InputError as error:
            self._tell(str(error), style="bold red")
            return False
        self._show()
        return True

    # -------------------------------------------------------------- commands

    def _set(self, text: str) -> None:
        for name, value in assignments(text):
            self.stepper.give(name, value)

    def _hold(self, text: str) -> None:
        for name, value in assignments(text):
            self.stepper.hold(name, value)
        self._tell(f"held: {', '.join(f'{name}={value}' for name, value in self.stepper.held.items()) or 'none'}")

    def _release(self, text: str) -> None:
        for name in words(text):
            self.stepper.release(name)

    def _step(self, text: str) -> None:
        wanted, recorded = number_of_steps(text, "step"), len(self.stepper.recorded)
        broken = list[str]()
        for taken in range(wanted):
            if wanted > 1 and recorded and recorded == self.stepper.number:
                self._tell("\n".join([*broken, end_told(recorded, taken, wanted)]), style="bold red" if broken else "")
                return
            self._before = self.stepper.watchable
            made = self.stepper.take()
            broken += [f"step {self.stepper.number}: {line}" for line in broken_lines(self.stepper.broken_now())]
            step = f"step {self.stepper.number}: {', '.join(made.fired.values())}"
            self._tell("\n".join([step, *broken]), style="bold red" if broken else "")

    def _back(self, text: str) -> None:
        self.stepper.back(number_of_steps(text, "back"))
        self._before = {}

    def _watch(self, text: str) -> None:
        refuse_unknown(words(text), self.stepper.watchable)
        self.watched = words(text)

    def _filter(self, text: str) -> None:
        self._word = text

    def _broken(self, _: str) -> None:
        broken = [f"broken at step {at}: {name}" for name, at in self.stepper.broken().items()]
        silent = [f"claims nothing since step {at}: {name}" for name, at in self.stepper.without_assumption().items()]
        self._tell("\n".join([*(broken or ["no property is broken so far"]), *silent]))

    def _save(self, text: str) -> None:
        if not text:
            raise InputError("save needs the name of a file.")
        try:
            self.stepper.save(Path(text))
        except OSError as error:
            raise InputError(f"{text}: cannot be written: {error.strerror}.") from error
        self._tell(f"{self.stepper.number} steps: {text}")

    # -------------------------------------------------------------- showing

    def _tell(self, text: str, *, style: str = "") -> None:
        self.query_one("#told", Static).update(Text(text, style))

    def _show(self) -> None:
        self.query_one("#head", Static).update(self._head())
        _fill(self.query_one("#inputs", DataTable), self._input_rows())
        _fill(self.query_one("#values", DataTable), self._value_rows())
        rows = [row for row in self.stepper.rows() if row.fires or self._word in row.machine + row.name]
        lines = [
            line for row in sorted(rows, key=lambda row: (not row.fires, not row.enabled)) for line in row_lines(row)
        ]
        styled = [Text(line, _STYLES.get(line.split(" ", 1)[0], "")) for line in lines]
        self.query_one("#rows", Static).update(Text("\n").join(styled))

    def _head(self) -> Text:
        recorded = len(self.stepper.recorded)
        of = f" of {recorded} recorded" if recorded else ""
        word = f"   filter: {self._word}" if self._word else ""
        text = Text(f"{self.stepper.target.name}   step {self.stepper.number}{of}{word}", "bold")
        for law in self.stepper.broken_laws():
            text.append(f"\nthe next step breaks the law {law}: no proof speaks of what follows", "bold red")
        return text

    def _input_rows(self) -> Iterable[tuple[str, ...]]:
        values, given, held = self.stepper.inputs, self.stepper.given, self.stepper.held
        rest = "recorded" if self.stepper.number < len(self.stepper.recorded) else "rest"
        for var in self.stepper.input_variables:
            if self._word in var.name:
                yield (
                    var.name,
                    values.get(var.name, ABSENT[0]),
                    "set" if var.name in given else "held" if var.name in held else rest,
                    _range(var),
                )

    def _value_rows(self) -> Iterable[tuple[str, ...]]:
        known = self.stepper.watchable
        others = [name for name in known if name not in self.watched and self._word in name]
        for name in sorted([*self.watched, *others], key=self._rank):
            before = self._before.get(name, "")
            mark = "★ " if name in self.watched else ""
            yield name, f"{mark}{known[name]}", before if before != known[name] else ""

    def _rank(self, name: str) -> int:
        """Return the place of a value: what is watched first, then modes, then all else as declared."""
        return 0 if name in self.watched else 1 if name.split(".")[-1] == "mode" else 2

    def _chosen(self, table: str) -> str:
        shown: DataTable[Any] = self.query_one(f"#{table}", DataTable)
        return str(shown.coordinate_to_cell_key(shown.cursor_coordinate).row_key.value)


def _table(name: str, title: str, columns: tuple[str, ...]) -> DataTable[Text]:
    table: DataTable[Text] = DataTable(id=name, cursor_type="row")
    table.border_title = title
    table.add_columns(*columns)
    return table


def _fill(table: DataTable[Any], rows: Iterable[tuple[str, ...]]) -> None:
    """Show other rows, and stay at the same one; the first cell is the row's key, cut to what leaves room for the second."""
    row, scroll = table.cursor_row, table.scroll_y
    heads = [column.label for column in table.ordered_columns]
    table.clear(columns=True)  # a column that stays never becomes narrower
    table.add_columns(*heads)
    cells = list(rows)
    room = table.size.width - max((len(one[1]) for one in cells), default=0) - _AROUND
    for name, *others in cells:
        table.add_row(Text(_cut(name, room)), *map(Text, others), key=name)
    table.move_cursor(row=row, scroll=False)
    table.scroll_to(y=scroll, animate=False)


def _cut(name: str, room: int) -> str:
    """Return a name that leaves room for the value beside it: its beginning and its end, which tell most names apart."""
    if len(name) <= max(room, _LEAST):
        return name
    kept = max(room, _LEAST) - 1
    return f"{name[: kept // 3]}\N{HORIZONTAL ELLIPSIS}{name[kept // 3 - kept :]}"


def _range(var: Var) -> str:
    if not isinstance(var, NumVar):
        return "true, false"
    if isinstance(var.unit, Enumeration):
        return ", ".join(var.unit.members)
    return f"{var.low}..{var.high} {var.unit.name}"
