"""Margins of figures: limits that are known in closed form, what the world alone may do, refusals and bad names."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path

import pytest

from safeloc.assurance.evidence.interval import HOLDS, claims_of
from safeloc.assurance.margins.asking import UNMOVED, Answer, Asking, Way, Where, chosen_claims
from safeloc.assurance.margins.figures import Figure, Refused, chosen_figures, figures, moved
from safeloc.assurance.margins.limits_of_figures import Direction, Limit, limit, nearest
from safeloc.assurance.margins.makers import maker_digest
from safeloc.assurance.margins.margin_data import in_words
from safeloc.assurance.margins.margin_work import Margins, from_data, front
from safeloc.catalogue import load_target
from safeloc.cli.margins import _say_what_it_takes
from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.proof.cache.contents import target_digest
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target
from tests.cli.calling import Call, caller

EXAMPLE, TWO_READERS = Path("docs/examples/marked_line.py"), Path("docs/examples/two_readers.py")
LIMITS = Limits(seconds=10)


@pytest.fixture(name="line", scope="module")
def _line() -> Target:
    return load_target(f"{EXAMPLE}:machine", EXAMPLE.with_suffix(".toml"))


def limit_of(target: Target, name: str, way: Direction, where: Where, *only: str) -> Limit:
    return limit(Asking(target, where, LIMITS, only), figures(target)[name], way)


def longest_stretch(layout: LayoutConfig) -> int:
    """Closed form: (tolerance - constant) (1 - rate) / rate - constant, without the error of the fix."""
    rest = layout.tolerance_mm - layout.odometry_constant_mm
    return rest * (1_000_000 - layout.odometry_rate_ppm) // layout.odometry_rate_ppm - layout.odometry_constant_mm


@pytest.mark.parametrize("where", ["world", "design"])
def test_the_longest_stretch_is_that_of_the_closed_form(line: Target, where: Where) -> None:
    """470 m for 30 m at 5 m + 5 %: a proof at this value, a run one millimetre beyond."""
    found = limit_of(line, "stretch_mm", "up", where)
    assert longest_stretch(LayoutConfig()) == found.holds_to == 470_000
    assert (470_001, "broken", "a position everywhere") == (found.beyond, found.end.end, found.end.claim)
    assert found.end.inputs[-1]["true_run_mm"] == 470_001


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("constant", "rate", "tolerance"), [(1_000, 20_000, 10_000), (6_000, 100_000, 50_000)])
def test_the_longest_stretch_of_other_figures(tmp_path: Path, constant: int, rate: int, tolerance: int) -> None:
    """The search finds the closed form's value, whatever the figures are."""
    given = f"constant_mm = {constant}\nrate_ppm = {rate}\ntolerance_mm = {tolerance}\nstretch_mm = 50000\n"
    (tmp_path / "line.toml").write_text(given, encoding="utf-8")
    layout = LayoutConfig(odometry_constant_mm=constant, odometry_rate_ppm=rate, tolerance_mm=tolerance)
    found = limit_of(load_target(f"{EXAMPLE}:machine", tmp_path / "line.toml"), "stretch_mm", "up", "design")
    assert longest_stretch(layout) == found.holds_to


def test_a_run_that_is_known_breaks_the_claim_at_another_figure(line: Target) -> None:
    """The run that ends a stretch is tried for the rate as well: beside the limit of the rate it breaks the claim, at the limit nothing does."""
    end = limit_of(line, "stretch_mm", "up", "world").end
    assert end.first is not None
    ways = [Way(end.claim, end.first, end.inputs)]
    edge = limit_of(line, "rate_ppm", "up", "design").holds_to
    knowing = Asking(line, "design", LIMITS, ways=ways)
    assert knowing.along_known({"rate_ppm": edge + 1})
    assert ("broken", end.claim) == (knowing.answer({"rate_ppm": edge + 1}).end, end.claim)
    assert not knowing.along_known({"rate_ppm": edge})
    assert not Asking(line, "design", LIMITS).along_known({"rate_ppm": edge + 1})


def worst_run(length: int, distance: int) -> int:
    """Closed form, for 0 < L < D: no run between readings of a front and a rear reader reaches this; every shorter one occurs."""
    return max(length, distance - length)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(("length", "distance"), [(204_700, 500_000), (100_000, 550_000)])
@pytest.mark.parametrize(
    ("name", "way"), [("vehicle_length_mm", "up"), ("vehicle_length_mm", "down"), ("marker_distance_mm", "up")]
)
def test_two_readers_run_as_far_as_the_closed_form_says(
    tmp_path: Path, length: int, distance: int, name: str, way: Direction
) -> None:
    """max(L, D - L) against the longest run that the tolerance allows: proved up to it, a run beyond it."""
    given = {"vehicle_length_mm": length, "marker_distance_mm": distance}
    law = {"constant_mm": 5_000, "rate_ppm": 50_000, "tolerance_mm": 30_000}
    text = "\n".join(f"{one} = {value}" for one, value in {**given, **law}.items())
    (tmp_path / "vehicle.toml").write_text(text, encoding="utf-8")
    found = limit_of(load_target(f"{TWO_READERS}:machine", tmp_path / "vehicle.toml"), name, way, "world")
    bound = longest_stretch(LayoutConfig()) + 1
    at, beyond = ({**given, name: value} for value in (found.holds_to, found.holds_to + (1 if way == "up" else -1)))
    assert worst_run(*at.values()) <= bound < worst_run(*beyond.values())
    assert found.end.end == "broken"


def test_a_figure_of_the_machine_alone_does_not_move_the_world(line: Target) -> None:
    """No clause has the tolerance; as a design it has a limit: 30 m less what 300 m leave."""
    assert limit_of(line, "tolerance_mm", "down", "world").proved_why == UNMOVED
    design = limit_of(line, "tolerance_mm", "down", "design")
    assert (21_053, 21_052, "broken") == (design.holds_to, design.beyond, design.end.end)


def test_a_narrower_world_needs_no_proof(line: Target) -> None:
    """Shorter stretches are among those that were proved."""
    found = limit_of(line, "stretch_mm", "down", "world")
    assert (0, "proved") == (found.holds_to, found.end.end)
    assert found.proved_why == "the world allows nothing that it did not allow before"


@pytest.fixture(name="ranged")
def _ranged(tmp_path: Path) -> Target:
    """The example with the longest stretch as the range of the true run, and a shortest one of 100 m as a law."""
    text = EXAMPLE.read_text(encoding="utf-8")
    text = text.replace('true_run = number("true_run_mm", MM, 0, 10_000_000)\n', "")
    text = text.replace(
        "    constant, tolerance =",
        '    true_run = number("true_run_mm", MM, 0, given["stretch_mm"])\n    constant, tolerance =',
    )
    text = text.replace(
        "Law(true_run <= given", "Law(true_run >= 100_000, 'None is shorter.'), 'other': Law(measured <= 10 * given"
    )
    (tmp_path / "ranged.py").write_text(text, encoding="utf-8")
    return load_target(f"{tmp_path / 'ranged.py'}:machine", EXAMPLE.with_suffix(".toml"))


def test_a_narrower_range_needs_no_proof(ranged: Target) -> None:
    """The true run has fewer values, each of which was proved before; with more values a claim is asked, and a run breaks it."""
    asking = Asking(ranged, "world", LIMITS)
    shorter = asking.answer({"stretch_mm": 299_999})
    assert ("proved", "the world allows nothing that it did not allow before") == (shorter.end, shorter.why)
    assert asking.answer({"stretch_mm": 470_000}) == Answer("proved")
    assert asking.answer({"stretch_mm": 470_001}).end == "broken"


def test_a_world_that_allows_no_cycle_is_no_margin(ranged: Target) -> None:
    """A true run of 100 m at least has no value in a range up to less: every claim would hold, and say nothing."""
    found = limit_of(ranged, "stretch_mm", "down", "world")
    assert (100_000, 99_999) == (found.holds_to, found.beyond)
    assert ("vacuous", "the world allows no cycle at all") == (found.end.end, found.end.why)


@pytest.mark.thorough
def test_the_front_of_two_figures(line: Target) -> None:
    """Each point is the other figure's limit, and the more one takes, the less is left to the other."""
    work = Margins(line, "world", chosen_claims(line, None), LIMITS)
    every = figures(line)
    points = list(front(work, (every["stretch_mm"], "up"), (every["rate_ppm"], "up")))
    assert [300_000, 470_000] == [points[0][0], points[-1][0]]
    left = [one.holds_to for _, one in points]
    assert left == sorted(left, reverse=True)
    assert [50_001, 50_002] == [points[-1][1].holds_to, points[-1][1].beyond]


def test_singles_are_kept(line: Target, tmp_path: Path) -> None:
    """A second search finds the same limits in the store, and a run comes back whole."""
    store = Store(tmp_path)
    chosen = [figures(line)["stretch_mm"]]

    def found(look_in: Store | None) -> list[Limit]:
        claims = chosen_claims(line, None)
        return sorted(
            Margins(line, "world", claims, LIMITS, 1, look_in, store).singles(chosen), key=lambda one: one.direction
        )

    first = found(None)
    assert [one.holds_to for one in first] == [0, 470_000]
    assert found(store) == first


def test_margins_belong_to_the_code_that_makes_the_machine(tmp_path: Path) -> None:
    """With other figures an edited maker makes another world, though with these it makes the same."""
    own, text = tmp_path / "own.py", EXAMPLE.read_text(encoding="utf-8")
    own.write_text(text, encoding="utf-8")
    before = load_target(f"{own}:machine", EXAMPLE.with_suffix(".toml"))
    first = maker_digest(before)
    assert maker_digest(before) == first
    own.write_text(text.replace('given["stretch_mm"]', 'min(given["stretch_mm"], 400_000)'), encoding="utf-8")
    after = load_target(f"{own}:machine", EXAMPLE.with_suffix(".toml"))
    assert target_digest(before) == target_digest(after)
    assert maker_digest(after) != first


def test_a_shipped_machine_in_a_world_that_errs_more() -> None:
    """The balise machine adds what the odometer's law says: a rate of 1 ppm more breaks containment, whatever else holds."""
    target = load_target("balise")
    asking = Asking(target, "world", LIMITS, [HOLDS])
    found = limit(asking, figures(target)["odometer.rate_ppm"], "up")
    assert (found.margin, found.beyond, found.end.end, found.end.claim) == (0, 50_001, "broken", HOLDS)


@pytest.mark.thorough
def test_a_range_of_the_world_moves_with_its_figure() -> None:
    """`max_speed_mm_s` is the range of a variable of stop_point's world; claims speak of the variable in its new range."""
    target = load_target("stop_point")
    found = limit_of(target, "max_speed_mm_s", "down", "world", "brake order in time")
    assert (1, "proved", "") == (found.holds_to, found.end.end, found.proved_why)


@pytest.mark.thorough
def test_what_the_configuration_refuses_ends_the_search() -> None:
    """The reason is the configuration's own."""
    found = limit_of(load_target("stop_point"), "reduced_speed_mm_s", "down", "design", "brake order in time")
    assert (151, 150, "refused") == (found.holds_to, found.beyond, found.end.end)
    assert in_words(found).startswith("150 is refused: reduced_speed_mm_s must exceed")


def test_a_figure_that_makes_other_variables_cannot_move_alone() -> None:
    """The number of stop points is the form of the world."""
    found = limit_of(load_target("stop_point"), "stop_points", "up", "world")
    assert "another value gives the world other variables or clauses" in in_words(found)


def test_moved_refuses_with_the_reason() -> None:
    with pytest.raises(Refused, match="Input should be greater than or equal to"):
        moved(load_target("stop_point"), {"brake_mm_s2": -1})


@pytest.mark.parametrize(
    ("raised", "refused"),
    [("InputError('no: too long')", True), ("ValueError('a defect')", False), ("KeyError(1)", False)],
)
def test_only_a_refusal_is_a_reason(tmp_path: Path, raised: str, refused: bool) -> None:
    """What the maker raises on purpose ends a search; its defects are told as they are."""
    own = tmp_path / "own.py"
    changed = EXAMPLE.read_text(encoding="utf-8").replace(
        "    error = measured", f"    if given['stretch_mm'] > 300_000:\n        raise {raised}\n    error = measured"
    )
    own.write_text(f"{changed}\nfrom safeloc.errors import InputError\n", encoding="utf-8")
    line = load_target(f"{own}:machine", EXAMPLE.with_suffix(".toml"))
    with pytest.raises(
        InputError, match="too long" if refused else r"own.py:machine fails: (Value|Key)Error"
    ) as caught:
        moved(line, {"stretch_mm": 400_000})
    assert isinstance(caught.value, Refused) is refused


PAGE = re.findall(
    r"```sh\nsafeloc (margins .*?)\n```\n```text\n(.*?)```", Path("docs/margins.md").read_text("utf-8"), re.DOTALL
)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("command", "printed"), PAGE)
def test_the_page_tells_what_the_command_prints(call: Call, tmp_path: Path, command: str, printed: str) -> None:
    assert len(PAGE) == 2
    assert printed in call(*command.split(), "--cache", str(tmp_path)).out


def test_unknown_names_are_refused_with_the_nearest(line: Target) -> None:
    with pytest.raises(InputError, match=r"no figure 'stretch_m'; it has constant_mm, .* Did you mean 'stretch_mm'"):
        chosen_figures(line, ["stretch_m"])
    with pytest.raises(InputError, match="no claim 'everywhere'; it has a position everywhere"):
        chosen_claims(line, ["everywhere"])


def test_a_machine_without_figures_is_refused(tmp_path: Path) -> None:
    own = tmp_path / "own.py"
    own.write_text(
        EXAMPLE.read_text(encoding="utf-8")
        .replace("given: Mapping[str, int]", "given: dict = GIVEN")
        .replace(
            "def machine",
            'GIVEN = {"constant_mm": 1, "rate_ppm": 1, "tolerance_mm": 2, "stretch_mm": 1}\n\n\ndef machine',
        ),
        encoding="utf-8",
    )
    with pytest.raises(InputError, match=r"no figure to move: .* give a machine of your own with --config FILE"):
        figures(load_target(f"{own}:machine"))


@pytest.mark.parametrize(("good", "bad", "edge"), [(0, 100, 37), (100, 0, 37), (-5, -4, -5)])
def test_nearest_finds_neighbours(good: int, bad: int, edge: int) -> None:
    if good < bad:
        assert nearest(good, bad, lambda value: value <= edge) == (edge, edge + 1)
    else:
        assert nearest(good, bad, lambda value: value >= edge) == (edge, edge - 1)


def test_nearest_stops_when_it_has_asked_enough() -> None:
    assert nearest(0, 1_000, lambda value: value <= 3, 2) == (0, 250)


@pytest.fixture(name="call")
def _call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    return caller(monkeypatch, capsys)


def test_the_command(call: Call, tmp_path: Path) -> None:
    """JSON for programs, and a clear refusal of a direction; lines for people are those of the page."""
    words = [f"{EXAMPLE}:machine", "--config", str(EXAMPLE.with_suffix(".toml")), "--cache", str(tmp_path)]
    data = json.loads(call("margins", *words, "--figure", "stretch_mm", "--json").out)
    assert [(one["direction"], one["holds_to"]) for one in data["limits"]] == [("down", 0), ("up", 470_000)]
    pair = call("margins", *words, "--pair", "stretch_mm:up,rate_ppm:sideways")
    assert pair.code == 2
    assert "each with :up or :down" in pair.err
    assert "'rate_ppm:sideways'" in pair.err


@pytest.mark.thorough
def test_a_front_is_printed_drawn_and_kept(call: Call, tmp_path: Path) -> None:
    """A vehicle with a longer stretch between its readers may err less; the second call finds the points in the store."""
    words = [f"{TWO_READERS}:machine", "--config", str(TWO_READERS.with_suffix(".toml")), "--cache", str(tmp_path)]
    pair = ["--pair", "vehicle_length_mm:up,marker_distance_mm:up"]
    told = call("margins", *words, *pair, "--out", str(tmp_path / "drawn"))
    assert "vehicle_length_mm:up,marker_distance_mm:up (world): vehicle_length_mm, marker_distance_mm" in told.out
    data = json.loads(call("margins", *words, *pair, "--json").out)
    [front] = data["fronts"]
    assert [204_700, 674_701] == front["points"][0][:2]
    assert all(second == first + 470_001 for first, second, _ in front["points"])
    drawn = tmp_path / "drawn" / "front-vehicle-length-mm-up-marker-distance-mm-up.svg"
    assert drawn.read_text(encoding="utf-8").startswith("<svg")


def test_what_pairs_refuse(call: Call) -> None:
    """A machine without declared pairs, one figure, three figures, and single figures beside pairs."""
    words = [f"{TWO_READERS}:machine", "--config", str(TWO_READERS.with_suffix(".toml"))]
    assert "two_readers declares no pairs of figures; give two with --pair" in call("margins", *words, "--pairs").err
    for text in ("rate_ppm:up", "rate_ppm:up,constant_mm:up,stretch_mm:up"):
        told = call("margins", *words, "--pair", text)
        assert told.code == 2
        assert "--pair takes two figures joined by a comma" in told.err
    both = call("margins", "stop_point", "--pairs", "--figure", "brake_mm_s2")
    assert both.code == 2
    assert "asks for the limits of single figures" in both.err


def test_a_claim_that_fails_as_it_is_leaves_no_margin(call: Call, tmp_path: Path) -> None:
    """Nothing is searched around a design that does not hold."""
    short = EXAMPLE.with_suffix(".toml").read_text(encoding="utf-8").replace("300000", "500000")
    (tmp_path / "long.toml").write_text(short, encoding="utf-8")
    told = call("margins", f"{EXAMPLE}:machine", "--config", str(tmp_path / "long.toml"), "--cache", str(tmp_path))
    assert told.code == 2
    assert "there is no margin to find: 'a position everywhere' is violated" in " ".join(told.err.split())


def test_data_of_a_limit_come_back() -> None:
    one = Limit(Figure("a", 1, "mm", 0, 9), "up", 4, Answer("broken", "c", first={"m": 0}, inputs=({"x": 1},)), 5)
    assert from_data(json.loads(json.dumps(asdict(one)))) == one


@pytest.mark.parametrize(
    ("name", "said"), [("supervised_odometry", "each asks up to 7 claims of the whole"), ("odometry", "")]
)
def test_what_the_limits_of_a_composition_take_is_said_first(
    name: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its machines alone answer in minutes; those are named."""
    target = load_target(name)
    _say_what_it_takes(target, chosen_figures(target, None), [one.name for one in claims_of(target)])
    told = capsys.readouterr().err
    assert said in told
    assert ("`safeloc margins odometry`" in told) == bool(said)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("valley",), "valley is a line; say for which tolerance to design it, such as --for tolerance=30m."),
        (("transmission", "--pair", "age_limit_ms:up,period_m:down"), "period_m"),
        (("transmission", "--pair", "age_limit_ms:up,period_ms:sideways"), "sideways"),
    ],
)
def test_what_cannot_be_asked_is_refused_before_anything_is_proved(
    arguments: tuple[str, ...],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("safeloc.cli.margins.Margins", None)  # nobody comes so far
    called = caller(monkeypatch, capsys)("margins", *arguments)
    assert called.code == 2
    assert said in " ".join(called.err.replace("│", " ").split())
