"""Random compositions of our own: wires, shared variables, and what machines owe each other."""

from __future__ import annotations

from dataclasses import replace

from tests.fuzz.draw import Draw
from tests.fuzz.draw_terms import Pen, clamped, fitting
from tests.fuzz.terms import TRUE, Term, below, rewritten
from tests.fuzz.world import Row, Var, Whole, World

STATES = 100


def whole(draw: Draw) -> Whole:
    """Two or three machines, each hearing something of those before it."""
    count = draw.rng.choice((2, 2, 2, 3))
    shared: dict[str, Var] = {}
    worlds = [
        draw.world("ABC"[n], _inputs(draw, shared, n), STATES if count == 2 else STATES // 4) for n in range(count)
    ]
    made = Whole("w", tuple(worlds), shared=frozenset(name for name, var in shared.items() if _twice(worlds, var)))
    for world in worlds[1:]:
        made = replace(made, wires={**made.wires, **_wires(draw, made, world)})
    made = _late(draw, _with_roles(draw, made))
    told = _told_from_the_first_step_on(draw, made)
    return replace(told or made, discharge=(*_discharged(draw, told or made), *([told.worlds[1].name] if told else [])))


def _late(draw: Draw, made: Whole) -> Whole:
    """Perhaps a machine, most often the first one, hears the state of any machine before the step."""
    inputs = [(world, var) for world in made.worlds for var in world.inputs if _free(made, world, var)]
    if not inputs or not draw.sometimes(0.35):
        return made
    world, var = inputs[0] if draw.sometimes(0.7) else draw.rng.choice(inputs)
    heard = [(one, kept) for one in made.worlds for kept in one.state if kept.kind == var.kind]
    if not heard:
        return made
    of, kept = draw.rng.choice(heard[::-1])
    before: Term = ("was", made.called(of, kept.name))
    wire = clamped(var, before) if var.kind == "number" else before
    return replace(made, wires={**made.wires, f"{world.name}.{var.name}": wire})


def _told_from_the_first_step_on(draw: Draw, made: Whole) -> Whole | None:
    """What the second machine assumes of what it hears holds after every step of the first one, and not before."""
    first, second = made.worlds[:2]
    states = [var for var in first.state if var.kind == "number" and var.low < var.high]
    heard = [var for var in second.inputs if var.kind == "number" and _free(made, second, var)]
    pairs = [(var, sure) for var in states for sure in heard if var.low == sure.low < sure.high]
    if not (pairs and draw.trap("inherited over a wire", 0.1)):
        return None
    var, sure = draw.rng.choice(pairs)
    up = Row(
        "tick", tuple(range(first.modes)), 0, sets={var.name: clamped(var, ("add", ("var", var.name), ("lit", 1)))}
    )
    ticks = replace(first, state={**first.state, var: var.low}, rows=(up,), initially=(), lemmas={})
    hears = replace(second, assumption=("gt", ("var", sure.name), ("lit", sure.low)), clauses={})
    wires = {**made.wires, f"{second.name}.{sure.name}": clamped(sure, ("var", f"{first.name}.{var.name}"))}
    return replace(made, worlds=(ticks, hears, *made.worlds[2:]), wires=wires)


def _twice(worlds: list[World], var: Var) -> bool:
    return sum(var in world.inputs for world in worlds) > 1


def _inputs(draw: Draw, shared: dict[str, Var], number: int) -> list[Var]:
    """Own inputs, and perhaps one that several machines have."""
    made = [var for var in draw.variables("i", draw.rng.randint(1, 2), ((0, 1), (0, 2), (1, 3)), 4)]
    made = made or [Var("i0", "number", 0, 2)]
    if draw.sometimes(0.12):
        made.append(Var("o0", "number", *draw.rng.choice(((0, 1), (1, 2))), optional=True))
    if number == 0 and draw.sometimes(0.25):
        shared["c"] = Var("c", "number", 0, 2)
    if number == 0 and draw.trap("optional shared", 0.08):
        shared["oc"] = Var("oc", "number", *draw.rng.choice(((0, 2), (1, 2))), optional=True)
    if draw.sometimes(0.8):
        made += [var for var in shared.values() if var.name in ("c", "oc")]
    return made


def _wires(draw: Draw, made: Whole, world: World) -> dict[str, Term]:
    """Terms over the machines before it for some of its inputs."""
    wires: dict[str, Term] = {}
    for var in world.inputs:
        name = f"{world.name}.{var.name}"
        if var.name not in made.shared and draw.sometimes(0.75):
            wires[name] = _wire(draw, made, world, var)
            if var.optional:
                wires[f"{world.name}.{var.present}"] = _pen(draw, made, world).atom()
    for var in world.ghost_inputs:
        if draw.sometimes(0.3):
            wires[f"{world.name}.{var.name}"] = _wire(draw, made, world, var)
    return wires


def _earlier(made: Whole, world: World) -> tuple[World, ...]:
    return made.worlds[: made.worlds.index(world)]


def _pen(draw: Draw, made: Whole, world: World, *, ghosts: bool = False) -> Pen:
    variables = [
        replace(var, name=made.called(one, var.name), optional=False)
        for one in _earlier(made, world)
        for var in (*one.state, *(var for var in one.inputs if not var.optional), *(one.ghosts if ghosts else ()))
    ]
    modes = tuple((f"{one.name}.mode", one.modes) for one in _earlier(made, world))
    return Pen(draw.rng, tuple(variables), modes, draw.wide)


def _wire(draw: Draw, made: Whole, world: World, var: Var) -> Term:
    """What an earlier machine has come to; now and then more than may be heard, or the truth itself."""
    pen = _pen(draw, made, world)
    ghosts = [(one, ghost) for one in _earlier(made, world) for ghost in one.ghosts if ghost.kind == var.kind]
    if ghosts and var in world.inputs and draw.trap("wire reads a ghost", 0.3):
        one, ghost = draw.rng.choice(ghosts)
        told: Term = ("var", made.called(one, ghost.name))
        return clamped(var, told) if var.kind == "number" else told
    if var.kind == "number" and draw.sometimes(0.5):
        same = [one for one in pen.variables if one.kind == "number"]
        if same:
            return _told(draw, var, draw.rng.choice(same))
    return fitting(pen, var, 1)


def _told(draw: Draw, var: Var, earlier: Var) -> Term:
    inside = var.low <= earlier.low and earlier.high <= var.high
    term: Term = ("var", earlier.name)
    return term if inside or (draw.sometimes(0.1) and not draw.wide) else clamped(var, term)


def _discharged(draw: Draw, made: Whole) -> list[str | tuple[str, str]]:
    """A later machine whose assumption the others keep, or a clause of it."""
    owed: list[str | tuple[str, str]] = []
    for world in made.worlds[1:]:
        if world.assumed != TRUE and draw.sometimes(0.6):
            by_clause = bool(world.clauses) and draw.sometimes(0.5)
            owed.append((world.name, next(iter(world.clauses))) if by_clause else world.name)
    return owed


# ------------------------------------------------------------------ roles of shared variables


def _with_roles(draw: Draw, made: Whole) -> Whole:
    """Perhaps a ghost that two machines have; or a ghost that is another machine's input."""
    first, second = made.worlds[:2]
    free = [var for var in second.inputs if _free(made, second, var)]
    if free and not first.ghosts and draw.trap("ghost shared with an input", 0.1):
        return _renamed_input(made, free[0], ghost=True)
    if free and not first.ghosts and draw.trap("ghost input shared with an input", 0.1):
        return _renamed_input(made, free[0], ghost=False)
    if not first.ghosts and not second.ghosts and draw.sometimes(0.15):
        ghost = Var("truth", "number", 0, 2)
        move = clamped(ghost, ("add", ("var", "truth"), ("lit", draw.rng.choice((-1, 1)))))
        both = {ghost: draw.rng.choice((0, 1, 2))}
        worlds = [replace(one, ghosts=both, ghost_moves={"truth": move}) for one in (first, second)]
        return replace(made, worlds=(*worlds, *made.worlds[2:]), shared=made.shared | {"truth"})
    return made


def _free(made: Whole, world: World, var: Var) -> bool:
    name = f"{world.name}.{var.name}"
    used = {one[1] for term in made.wires.values() for one in below(term) if one[0] == "var"}
    return not var.optional and name not in made.wires and name not in used and var.name not in made.shared


def _renamed_input(made: Whole, var: Var, *, ghost: bool) -> Whole:
    """The second machine's input is the first one's ghost (which rests), or its ghost input."""
    first, second = made.worlds[:2]
    role = replace(var, name="role")
    second = renamed(second, var.name, role)
    if ghost:
        first = replace(first, ghosts={role: role.least}, ghost_moves={"role": ("var", "role")})
    else:
        told = Var("hidden", role.kind, role.low, role.high)
        first = replace(first, ghosts={told: told.least}, ghost_inputs=(role,), ghost_moves={"hidden": ("var", "role")})
    return replace(made, worlds=(first, second, *made.worlds[2:]), shared=made.shared | {"role"})


def renamed(world: World, name: str, var: Var) -> World:
    """The machine with one input under another name."""

    def change(term: Term) -> Term:
        return rewritten(term, lambda one: (one[0], var.name) if one[1] == name else one)

    rows = tuple(
        replace(row, guard=change(row.guard), sets={k: change(t) for k, t in row.sets.items()}) for row in world.rows
    )
    return replace(
        world,
        inputs=tuple(var if one.name == name else one for one in world.inputs),
        rows=rows,
        ghost_moves={k: change(t) for k, t in world.ghost_moves.items()},
        assumption=change(world.assumption),
        clauses={k: change(t) for k, t in world.clauses.items()},
    )
