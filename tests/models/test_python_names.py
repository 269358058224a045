"""The Python name of a variable is the variable's own name (docs/decisions/language.md): nobody has to learn two.

The unit may be left out, and words in front that the owner, a machine or a group of variables, says already.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

MODELS = Path(__file__).parents[2] / "models"
_MAKERS = {"number", "boolean", "choice", "optional"}
_ROLES = {"sensor", "state", "ghost", "choice"}
_UNIT = re.compile(r"_(ps|mm_s2|mm_s|um_s|mm2_s2|mm2|um|nm|mm|ms|s|cycles|permille|ppm|mrad|cdb)$")
_ALONE = "the variable has the group's name alone"
_KEYWORD = "`from` is a word of Python"
_READINGS = "one word for every reading that is compared, whatever device it comes from"
OTHERWISE = {
    "area.Side.bound": "the word of the side stands at the end",
    "area.Side.came_in": "the word of the side stands at the end",
    "area.Inner.start": _KEYWORD,
    "area.Inner.end": _KEYWORD,
    "fibre_area.Parts.source": _KEYWORD,
    "fibre_handover.Parts.source": _KEYWORD,
    "balise.Announcement.place": _READINGS,
    "motion.CheckGhosts.reported": "shared with the machines that have the odometer's error",
    "motion.CheckGhosts.next_reported": "shared with the machines that have the odometer's error",
    "odometry.Unit.measured": _ALONE,
    "odometry.Reader.place": _READINGS,
    "odometry.Reader.verdict": _READINGS,
    "odometry.SatelliteReader.place": _READINGS,
    "odometry.SatelliteReader.verdict": _READINGS,
    "reflector.BaliseReading.identity": _ALONE,
    "reflector.Entry.position": _ALONE,
    "satellite.Parts.why_missing": "`missing` is the fix's own reason there, `fix_missing`",
}
"""Class and Python name -> why it is another one."""


@dataclass(frozen=True)
class Named:
    """A variable where it is declared: its class, its Python name, and its own name with `{}` for what a group is called."""

    owner: str
    python: str
    name: str

    @property
    def is_its_own_name(self) -> bool:
        """Whether the Python name is the variable's, without unit or words in front."""
        name, python = self.name.rpartition("{}")[2], self.python
        if self.name.startswith("next_") and python.startswith("next_") and not _is_end(python, name):
            name, python = (
                name.removeprefix("next_"),
                python.removeprefix("next_"),
            )  # it stands before a group's name as well
        return _is_end(python, name)


def _is_end(python: str, name: str) -> bool:
    return any(one == python or one.endswith(f"_{python}") for one in (name, _UNIT.sub("", name)))


def named_in(path: Path, fields: Mapping[str, list[str]]) -> Iterator[Named]:
    """Every variable of a file that is bound to a field or attribute where it is declared."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    above = {below: node for node in ast.walk(tree) for below in ast.iter_child_nodes(node)}
    for node in ast.walk(tree):
        name = _own_name(node)
        if name is None:
            continue
        bound = _bound(node, above, fields)
        if bound is not None:
            yield Named(f"{path.parent.name}.{bound[0]}", bound[1], name)


def _own_name(node: ast.AST) -> str | None:
    """The name that a call makes a variable of."""
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _MAKERS and node.args):
        return None
    match node.args[0]:
        case ast.Constant(value=str(name)):
            return name
        case ast.JoinedStr(values=parts):
            return "".join(str(one.value) if isinstance(one, ast.Constant) else "{}" for one in parts)
    return None


def _bound(node: ast.AST, above: Mapping[ast.AST, ast.AST], fields: Mapping[str, list[str]]) -> tuple[str, str] | None:
    """The class and the Python name that a variable gets, if it gets them where it is declared."""
    one, upper = node, above[node]
    while isinstance(upper, ast.IfExp) or _gives_a_role(upper):
        one, upper = upper, above[upper]
    match upper:
        case ast.Assign(targets=[ast.Attribute(value=ast.Name(id="self"), attr=python)]):
            return _class_around(upper, above), python
        case ast.keyword(arg=str(python)) if (owner := _class_called(above[upper])) is not None:
            return owner, python
        case ast.Call(args=args) if (owner := _class_called(upper)) is not None and one in args:
            place, names = args.index(one), fields.get(owner, [])  # type: ignore[arg-type]
            return (owner, names[place]) if place < len(names) else None
    return None


def _gives_a_role(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _ROLES


def _class_called(node: ast.AST) -> str | None:
    is_class = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id.lstrip("_")[:1].isupper()
    return node.func.id if is_class else None  # type: ignore[attr-defined]


def _class_around(node: ast.AST, above: Mapping[ast.AST, ast.AST]) -> str:
    while not isinstance(node, ast.ClassDef):
        node = above[node]
    return node.name


def _fields(tree: ast.Module) -> dict[str, list[str]]:
    return {
        one.name: [
            each.target.id for each in one.body if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name)
        ]
        for one in tree.body
        if isinstance(one, ast.ClassDef)
        and all(isinstance(base, ast.Name) and base.id == "Protocol" for base in one.bases)
    }


@cache
def every() -> tuple[Named, ...]:
    """Every variable of the machines that ship."""
    found: list[Named] = []
    for folder in sorted(path for path in MODELS.iterdir() if path.is_dir()):
        files = sorted(folder.rglob("*.py"))
        fields = {
            name: of for path in files for name, of in _fields(ast.parse(path.read_text(encoding="utf-8"))).items()
        }
        for path in files:
            found += named_in(path, {**fields, **_fields(ast.parse(path.read_text(encoding="utf-8")))})
    return tuple(found)


def test_the_python_name_is_the_variables_own() -> None:
    """Each that is not stands in the list, with its reason."""
    wrong = {f"{one.owner}.{one.python}" for one in every() if not one.is_its_own_name}
    assert wrong == set(OTHERWISE)


def test_most_variables_are_looked_at() -> None:
    """Those of a group that is made elsewhere are not seen; all others are."""
    assert len(every()) > 400


def test_another_name_is_noticed() -> None:
    """Also where the words in front are a group's, or the variable is of the next step."""
    assert Named("a.Parts", "speed_low", "axle_speed_low_mm_s").is_its_own_name
    assert Named("a.Slot", "last", "{}_last_mm").is_its_own_name
    assert Named("a.Slot", "next_front", "next_{}_front_um").is_its_own_name
    assert not Named("a.Parts", "slow", "axle_speed_low_mm_s").is_its_own_name
    assert not Named("a.Slot", "place", "{}_position_mm").is_its_own_name
    assert not Named("a.Parts", "next_speed", "next_true_course").is_its_own_name
