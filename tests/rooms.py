"""Who imports whom, room by room, as it is read from the code's own imports.

A room is a folder of `safeloc/`, or `models/` or `properties/`. What stands in `railway/` is a room each, and so is a file
beside the folders, such as `errors`. The files `models/<machine>/target.py` are one room, `targets`: they tie a machine to its
properties. The doors of the package belong to no room.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import networkx as nx

ROOT = Path(__file__).parents[1]
DOORS = [ROOT / "safeloc" / name for name in ("__init__.py", "__main__.py", "moved.py", "railway/__init__.py")]
DIVIDED = "railway"
TARGETS = "targets"
LINKS = (ROOT / "safeloc" / "models", ROOT / "safeloc" / "properties")


def files() -> list[Path]:
    """Every Python file that belongs to a room."""
    below = [path for path in (ROOT / "safeloc").rglob("*.py") if not any(path.is_relative_to(link) for link in LINKS)]
    beside = [path for room in ("models", "properties") for path in (ROOT / room).rglob("*.py")]
    return sorted(path for path in [*below, *beside] if path not in DOORS)


def room_of(path: Path) -> str:
    """The room that a file belongs to, such as `language`, `railway.map` or `errors`."""
    first, *rest = path.relative_to(ROOT).with_suffix("").parts
    if first == "models" and rest[1:] == ["target"]:
        return TARGETS
    if first != "safeloc":
        return first
    return f"{DIVIDED}.{rest[1]}" if rest[0] == DIVIDED else rest[0]


def module_of(path: Path) -> str:
    """The name that a file is imported by."""
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    return name if name.startswith("safeloc") else f"safeloc.{name}"


@dataclass(frozen=True)
class Read:
    """What a file imports, with full names, and its functions: name, first line of the body, last line."""

    imports: tuple[str, ...]
    functions: tuple[tuple[str, int, int], ...]


@cache
def parsed(code: str) -> ast.Module:
    """The tree of a file's text, made once in a process for all tests that look at code; nobody changes it."""
    return ast.parse(code)


@cache
def read(code: str) -> Read:
    """Read a file's text, once in a process; ValueError for a relative import."""
    imports, functions = list[str](), list[tuple[str, int, int]]()
    for node in ast.walk(parsed(code)):
        if isinstance(node, ast.Import):
            imports += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.level or node.module is None:
                raise ValueError(f"relative import in line {node.lineno}; full names show which way it goes.")
            imports += (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions.append((node.name, node.body[0].lineno, node.end_lineno or 0))
    return Read(tuple(imports), tuple(functions))


def imported(code: str) -> tuple[str, ...]:
    """Modules and what is taken from them, with their full names; ValueError for a relative import."""
    return read(code).imports


@cache
def rooms() -> nx.DiGraph[str]:
    """All rooms; an edge from each to each that it imports, with the number of files that do."""
    homes = {module_of(path): room_of(path) for path in files()}
    graph: nx.DiGraph[str] = nx.DiGraph()
    for path in files():
        room = room_of(path)
        graph.add_node(room)
        for target in {home(name, homes) for name in imported(path.read_text(encoding="utf-8"))}:
            if target not in (None, room):
                times = graph.get_edge_data(room, target, {"times": 0})["times"]
                graph.add_edge(room, target, times=times + 1)
    return graph


def home(name: str, homes: dict[str, str]) -> str | None:
    """The room of the module that a full name leads to; None for what belongs to no room."""
    while name:
        if name in homes:
            return homes[name]
        name = name.rpartition(".")[0]
    return None


def upward(graph: nx.DiGraph[str]) -> list[tuple[str, str]]:
    """The imports that close a circle of rooms, rare ones rather than frequent ones."""
    rest, taken = graph.copy(), []
    while circles := [part for part in nx.strongly_connected_components(rest) if len(part) > 1]:
        within = [(rest.edges[a, b]["times"], a, b) for part in circles for a, b in rest.subgraph(part).edges]
        _, above, below = min(within)
        rest.remove_edge(above, below)
        taken.append((above, below))
    found = []
    for above, below in reversed(taken):  # what closes no circle once the others are gone goes back
        if nx.has_path(rest, below, above):
            found.append((above, below))
        else:
            rest.add_edge(above, below)
    return sorted(found)


def downward(graph: nx.DiGraph[str]) -> nx.DiGraph[str]:
    """All imports but those that close a circle."""
    rest = graph.copy()
    rest.remove_edges_from(upward(graph))
    return rest


def arrows(graph: nx.DiGraph[str]) -> list[tuple[str, str]]:
    """The downward imports that no chain of others implies."""
    return sorted(nx.transitive_reduction(downward(graph)).edges)


def heights(graph: nx.DiGraph[str]) -> dict[str, int]:
    """The row of each room, counted from below: each above all that it imports."""
    order = downward(graph)
    found: dict[str, int] = {}
    for room in reversed(list(nx.lexicographical_topological_sort(order))):
        found[room] = max((found[below] + 1 for below in order.successors(room)), default=0)
    return found
