"""Pictures and tables show every mode and every transition of a machine, whatever its names are."""

from __future__ import annotations

import html
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given

from safeloc.codegen.diagram import edges, to_dot, to_mermaid, to_svg, to_table_text
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.transition_rows import Row, transition_rows
from safeloc.language.units import MM
from safeloc.models import delocalized, odometry
from tests.examples import EXAMPLES
from tests.random_machines import machines

MACHINES = [
    *(machine for example in EXAMPLES for machine in example.machines),
    odometry.machine(),
    delocalized.machine(),
]
every_machine = pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
SVG = "{http://www.w3.org/2000/svg}"
NASTY = 'a<b> & "c": {d}; #e \\f'
NAME = 'a<b> & "c": {d}; #e'  # a machine's name holds no backslash


def awkward() -> Machine:
    """A machine whose names hold what Mermaid, DOT and XML each take for syntax."""
    first, second = table = modes("ONE", "TWO")
    go, way = boolean("go"), number("way", MM, 0, 10)
    return Machine(
        name=NAME,
        modes=table,
        inputs=[go, way],
        state={},
        outputs={},
        transitions=[
            Transition(NASTY, first, second, go & (way < 3)),
            Transition("back", second, first, ~go, rank=1),
        ],
    )


def pairs(machine: Machine) -> set[tuple[str, str, str]]:
    """(source, transition, target), one for each source."""
    return {(mode.label, t.name, t.target.label) for t in machine.transitions for mode in t.sources}


def mermaid_arrows(text: str) -> set[tuple[str, str, str]]:
    """Return the labels of a Mermaid diagram, without escapes."""
    found = re.findall(r"^    (\w+) --> (\w+): (.*)$", text, re.MULTILINE)
    plain = [(a, [unescaped(part) for part in label.split("<br/>")], b) for a, b, label in found]
    return {(a, name, b) for a, names, b in plain for name in names}


def unescaped(text: str) -> str:
    """Mermaid's `#34;` back to the letter."""
    return re.sub(r"#(\d+);", lambda found: chr(int(found[1])), text)


QUOTED = r'"((?:[^"\\]|\\.)*)"'


def dot_arrows(text: str) -> set[tuple[str, str, str]]:
    """Return the labels of a DOT graph, without escapes."""
    found = re.findall(rf"^  {QUOTED} -> {QUOTED} \[label={QUOTED}\];$", text, re.MULTILINE)
    return {(a, undone(name), b) for a, b, label in found for name in re.split(r"(?<!\\)\\n", label)}


def undone(text: str) -> str:
    """DOT's backslashes taken away."""
    return re.sub(r"\\(.)", r"\1", text)


def svg_texts(machine: Machine, kind: str) -> list[str]:
    """The texts of one class in the picture."""
    root = ElementTree.fromstring(to_svg(machine))
    return [one.text or "" for one in root.iter(f"{SVG}text") if kind in (one.get("class") or "").split()]


@every_machine
def test_mermaid_shows_everything(machine: Machine) -> None:
    """Every mode and every transition, from each of its sources, and the first mode."""
    text = to_mermaid(machine)
    assert mermaid_arrows(text) == pairs(machine)
    assert set(re.findall(r'state "(.*)" as', text)) == {mode.label for mode in machine.modes}
    assert f"[*] --> {machine.modes[0].label}\n" in text


@every_machine
def test_dot_shows_everything(machine: Machine) -> None:
    """Every transition from each of its sources, and the first mode."""
    text = to_dot(machine)
    assert dot_arrows(text) == pairs(machine)
    assert f'  start -> "{machine.modes[0].label}";\n' in text


@every_machine
def test_svg_shows_everything(machine: Machine) -> None:
    """One box a mode, one arc a pair of modes, and every transition in the legend under the number at its arc."""
    root = ElementTree.fromstring(to_svg(machine))
    assert svg_texts(machine, "name") == [mode.label for mode in machine.modes]
    assert len([one for one in root.iter(f"{SVG}rect") if "first" in (one.get("class") or "")]) == 1
    paths = [one for one in root.iter(f"{SVG}path") if one.get("class") == "edge"]
    assert len(paths) == len(edges(machine))
    legend = [text for text in svg_texts(machine, "label") if "  " in text]
    assert legend == [f"{number}  {t.name}" for number, t in enumerate(machine.transitions, 1)]
    numbers = {int(number) for text in svg_texts(machine, "halo") for number in text.split(", ")}
    assert numbers == set(range(1, len(machine.transitions) + 1))


@every_machine
def test_svg_texts_stay_inside(machine: Machine) -> None:
    """No text begins outside the picture."""
    root = ElementTree.fromstring(to_svg(machine))
    _, _, width, height = map(float, (root.get("viewBox") or "").split())
    for one in root.iter(f"{SVG}text"):
        assert 0 <= float(one.get("x") or -1) < width
        assert 0 <= float(one.get("y") or -1) < height


def corners(path: ElementTree.Element) -> list[tuple[float, float]]:
    """Return the points of a path: ends and control points."""
    figures = list(map(float, re.findall(r"-?[\d.]+", path.get("d") or "")))
    return list(zip(figures[::2], figures[1::2], strict=True))


def curve(path: ElementTree.Element) -> list[tuple[float, float]]:
    """Return places along an edge, a line or a cubic curve, from its beginning to its end."""
    points = corners(path)
    if len(points) == 2:
        return points
    weights = [((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3) for t in (n / 20 for n in range(21))]
    return [
        (
            sum(weight * x for weight, (x, _) in zip(row, points, strict=True)),
            sum(weight * y for weight, (_, y) in zip(row, points, strict=True)),
        )
        for row in weights
    ]


def many_modes() -> Machine:
    """Nine modes, with transitions from the first to the last and back."""
    table = modes(*(f"M{index}" for index in range(9)))
    go = boolean("go")
    rows = [Transition("down", table[0], table[8], go), Transition("up", table[8], table[0], go)]
    return Machine(name="many", modes=table, inputs=[go], state={}, outputs={}, transitions=rows)


@pytest.mark.parametrize("machine", [*MACHINES, many_modes()], ids=lambda machine: machine.name)
def test_svg_edges_stay_inside(machine: Machine) -> None:
    """No arc leaves the picture or runs through the legend, and each ends in the tip of its arrow."""
    root = ElementTree.fromstring(to_svg(machine))
    _, _, _, height = map(float, (root.get("viewBox") or "").split())
    legend = min(float(one.get("x") or 0) for one in root.iter(f"{SVG}text") if "legend" in (one.get("class") or ""))
    paths = list(root.iter(f"{SVG}path"))
    for edge, tip in zip(paths[::2], paths[1::2], strict=True):
        assert ["edge", "tip"] == [edge.get("class"), tip.get("class")]
        assert corners(edge)[-1] == corners(tip)[1]
        assert all(0 < x < legend and 0 < y < height for x, y in [*curve(edge), *corners(tip)])


@every_machine
def test_svg_has_no_ids(machine: Machine) -> None:
    """A page holds many pictures, and an id may stand only once in it."""
    root = ElementTree.fromstring(to_svg(machine))
    assert [one.tag for one in root.iter() if "id" in one.keys()] == []  # noqa: SIM118  (an Element is no dictionary)


@given(machines())
def test_random_machines(machine: Machine) -> None:
    """The same for any machine: three pictures and a table of one and the same transitions."""
    assert mermaid_arrows(to_mermaid(machine)) == dot_arrows(to_dot(machine)) == pairs(machine)
    assert svg_texts(machine, "name") == [mode.label for mode in machine.modes]
    assert [row.name for row in transition_rows(machine)] == [t.name for t in machine.transitions]


def test_labels_are_escaped() -> None:
    """Signs that a format takes for syntax arrive as they were written."""
    machine = awkward()
    assert mermaid_arrows(to_mermaid(machine)) == pairs(machine)
    assert dot_arrows(to_dot(machine)) == pairs(machine)
    assert to_dot(machine).startswith(f"digraph {dot_quoted(NAME)} {{")
    assert f"1  {NASTY}" in svg_texts(machine, "label")
    assert html.escape(NASTY) in to_svg(machine)
    assert ElementTree.fromstring(to_svg(machine)).get("aria-label") == f"state diagram of {NAME}"


def dot_quoted(text: str) -> str:
    """A text as DOT writes it."""
    backslash, quote = chr(92), chr(34)
    return quote + text.replace(backslash, backslash * 2).replace(quote, backslash + quote) + quote


@every_machine
def test_table(machine: Machine) -> None:
    """A row a transition, in order: sources, target, rank, requirements, and every variable that it sets."""
    for row, t in zip(transition_rows(machine), machine.transitions, strict=True):
        assert (row.name, row.target, row.rank, row.requirements) == (t.name, t.target.label, t.rank, t.requirements)
        assert row.source == ", ".join(mode.label for mode in t.sources)
        assert [one.partition(" := ")[0] for one in row.sets] == [var.name for var in t.set]
        assert all(one.partition(" := ")[2] for one in row.sets)
        assert 0 < len(row.guard) <= 160


@every_machine
def test_rows_say_where_they_are_declared(machine: Machine) -> None:
    """`file:line` of a row leads to a line of that file that lies within a Transition."""
    for row, t in zip(transition_rows(machine), machine.transitions, strict=True):
        file, _, line = row.declared.partition(":")
        path = Path(t.src.rpartition(":")[0])
        assert path.name == file
        above = path.read_text(encoding="utf-8").splitlines()[max(0, int(line) - 8) : int(line)]
        assert any("Transition(" in one for one in above), row.declared


def test_definitions_stand_in_the_table() -> None:
    """A named term is shown by its name in guards and updates, and without it in full."""
    (on,) = table = modes("ON")
    way, total = number("way", MM, 0, 10), number("total", MM, 0, 1000)

    def build(*, named: bool) -> Row:
        sum_ = total + way
        machine = Machine(
            name="summed",
            modes=table,
            inputs=[way],
            state={total: 0},
            outputs={},
            transitions=[Transition("add", on, on, sum_ <= 1000, {total: sum_})],
            definitions={"arrived": sum_} if named else {},
        )
        return transition_rows(machine)[0]

    named, plain = build(named=True), build(named=False)
    assert (named.guard, named.sets) == ("arrived ≤ 1000 mm", ("total := arrived",))
    assert (plain.guard, plain.sets) == ("(total + way) ≤ 1000 mm", ("total := total + way",))


def test_odometry_definitions_are_used() -> None:
    """The model's named terms appear in its table."""
    machine = odometry.machine()
    text = " ".join(" ".join((row.guard, *row.sets)) for row in transition_rows(machine))
    assert [name for name in machine.definitions if name in text]


def test_the_table_as_text() -> None:
    """A line for each transition of each machine, its cells between tabs."""
    made = delocalized.machine()
    lines = to_table_text([made, made]).splitlines()
    assert 2 * len(made.transitions) == len(lines)
    first = transition_rows(made)[0]
    assert [first.name, first.source, first.target, first.guard, " ".join(first.requirements), first.declared] == (
        lines[0].split("\t")
    )
