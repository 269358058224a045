/* Opens a run by its link, and moves through it: buttons, keys, play, and the link of every step. */

const APART_MS = 220; // between two steps while it plays

const known = JSON.parse(place("run-known").textContent);
let view = null;
let playing = null;
let asked = "";

/* ------------------------------------------------------ links */

function link() {
  return new URLSearchParams(location.hash.slice(1));
}

function linkTo(result, step, more = {}, watched = []) {
  const words = new URLSearchParams({ result, step, ...more });
  for (const text of watched) words.append("watch", text);
  return `#${words.toString()}`;
}

function remember() {
  if (!view || playing || view.trace.from !== undefined) return; // a link cannot hold the steps that were taken here
  const more = { ...(view.part ? { machine: view.part } : {}), ...(view.plotted.length ? { chart: view.plotted.join(",") } : {}) };
  asked = linkTo(view.result, view.step, more, view.watched);
  history.replaceState(null, "", asked);
}

let soon = 0;
function moved() {
  clearTimeout(soon);
  soon = setTimeout(remember, 150);
  say();
}

/* ------------------------------------------------------ opening */

async function open() {
  if (location.hash === asked && view) return;
  const words = link();
  const result = words.get("result");
  const run = place("run");
  const shows = result !== null || known.alone;
  document.documentElement.classList.toggle("shows-run", shows);
  run.hidden = !shows;
  if (!shows) return;
  stop();
  try {
    await openRun(result ?? known.first, words);
  } catch (error) {
    refuse(error.message);
  }
}

function refuse(text) {
  view = null;
  place("run-body").hidden = true;
  place("run-flaw").hidden = false;
  place("run-flaw").textContent = text;
}

async function openRun(result, words) {
  const name = Object.keys(known.machines).find((one) => result.startsWith(`${one}/`));
  if (!name) throw new Error(`This report has no run of ${result}.`);
  const { file, runs, view: beside, script } = known.machines[name];
  const data = await fetched(`view ${file}`, beside);
  if (data.made !== known.made) throw new Error(`${beside} is of another report than this page. ${AGAIN}`);
  const read = new Runs(await fetched(`runs ${file}`, runs));
  const trace = read.find(result);
  if (!trace) throw new Error(`${runs} has no run of ${result}.`);
  trace.results = [result, ...trace.results.filter((one) => one !== result)];
  place("run-flaw").hidden = true;
  place("run-body").hidden = false;
  head(data, trace);
  choices(read, result);
  showRun(data, trace);
  view.plotted = (words.get("chart") ?? "").split(",").filter((one) => view.signal(one));
  setUp(words.get("machine") ?? "");
  const step = words.has("step") ? Number(words.get("step")) : (view.violating ?? (view.fired[0] ?? 0));
  view.watched = words.getAll("watch");
  go(Number.isInteger(step) ? step : 0);
  const opened = view;
  let flaw = script ? "this is a run of one machine by itself" : "this page has no script of the machine";
  const live = await machineOf(file, script, trace).catch((error) => {
    flaw = error.message;
    return null;
  });
  if (view !== opened) return;
  if (live) return start(live);
  view.unexplained = flaw;
  view.show(view.step);
}

function start(live) {
  view.setLive(live);
  offer(live);
}

function showRun(data, trace) {
  view?.close();
  view = new View(data, trace, moved);
  offer(null);
}

function head(data, trace) {
  const [result] = trace.results;
  const { verdict, statement, at } = data.results[result] ?? { verdict: "", statement: "", at: "" };
  place("run-machine").textContent = data.name;
  place("run-title").textContent = result.split("/").slice(2).join("/") || result;
  place("run-verdict").replaceChildren(element("span", { class: `verdict ${verdict.replace(" ", "-")}` }, verdict), ` ${wordOf(result, trace, data)}`);
  place("run-statement").textContent = statement;
  place("run-back").href = known.alone ? "" : `${known.report}${at ? `#${at}` : ""}`;
  place("run-back").hidden = known.alone;
  const others = trace.results.slice(1);
  place("run-shows").textContent = others.length ? `also shows ${others.length} other result${others.length > 1 ? "s" : ""}` : "";
  place("run-shows").title = others.join("\n");
  document.title = `${result}: run`;
}

function choices(read, result) {
  const options = read.runs.flatMap((run) => run.results.map((one) => element("option", { value: one, selected: one === result }, `${one.split("/").slice(1).join("/")} (${run.steps})`)));
  place("run-choice").replaceChildren(...options);
}

function wordOf(result, trace, data) {
  const steps = `${trace.steps} step${trace.steps === 1 ? "" : "s"}`;
  if (data.results[result]?.verdict === "unknown") return `a counterexample to induction, ${steps} from a state that keeps all that is proved to one that breaks the property; no run need come there`;
  const broken = [...new Set((data.results[result]?.broken ?? []).map(([, step]) => step))];
  return broken.length ? `at step ${broken.join(", ")} of ${trace.steps}` : `a run of ${steps}`;
}

function setUp(part) {
  const { trace, data } = view;
  const parts = data.parts.map(({ name }) => name).filter((name) => trace.names.state.some((one) => one.startsWith(`${name}.`) && trace.first.get(one) !== null));
  place("run-part-box").hidden = parts.length < 2;
  place("run-part").replaceChildren(element("option", { value: "" }, "all"), ...parts.map((name) => element("option", { value: name, selected: name === part }, name)));
  place("run-slider").max = place("run-step").max = trace.steps;
  place("run-of").textContent = `of ${trace.steps}`;
  place("run-violating").hidden = view.violating === null;
  place("run-variables").replaceChildren(...["state", "outputs", "inputs"].flatMap((kind) => view.names(kind).map((value) => element("option", { value }))));
  if (parts.includes(part)) project(part);
  else view.fillCharts();
}

function project(part) {
  view.part = part;
  view.fired = view.firingSteps();
  view.drawnFrom = null;
  view.fill();
  go(view.step);
}

/* ------------------------------------------------------ moving */

function go(step) {
  if (!view) return;
  view.show(step);
  view.follow();
}

function say() {
  place("run-slider").value = view.step;
  if (document.activeElement !== place("run-step")) place("run-step").value = view.step;
  const fired = view.firedAt(view.step).map(([, name]) => name).join(", ");
  place("run-slider").setAttribute("aria-valuetext", `step ${view.step}, ${fired || "start"}`);
  if (!playing) place("run-said").textContent = `step ${view.step} of ${view.trace.steps}: ${fired || "start"}`;
}

const goFired = (sign) => goFirst(view.fired, sign);

function goFirst(steps, sign) {
  const found = sign > 0 ? steps.find((step) => step > view.step) : steps.findLast((step) => step < view.step);
  if (found !== undefined) go(found);
  else place("run-said").textContent = sign > 0 ? "none after this step" : "none before this step";
}

function goChange(sign) {
  const name = place("run-variable").value;
  const kind = ["state", "outputs", "inputs"].find((one) => view.trace.names[one].includes(name));
  place("run-variable").setAttribute("aria-invalid", String(!kind));
  if (!kind) return;
  const steps = [];
  for (let step = 1; step <= view.trace.steps; step += 1) if (view.trace.changed(kind, name, step)) steps.push(step);
  goFirst(steps, sign);
}

/* The next step that violates something, and after the last one the first again. */
function goViolating() {
  const steps = view.broken.map(([, step]) => step);
  if (steps.length) go(steps.find((step) => step > view.step) ?? steps[0]);
}

function play() {
  if (playing) return stop();
  if (view.step === view.trace.steps) go(0);
  place("run-play").setAttribute("aria-pressed", "true");
  place("run-play").textContent = "pause";
  playing = setInterval(() => (view.step < view.trace.steps ? go(view.step + 1) : stop()), APART_MS);
}

function stop() {
  clearInterval(playing);
  playing = null;
  place("run-play").setAttribute("aria-pressed", "false");
  place("run-play").textContent = "play";
  if (view) moved();
}

/* ------------------------------------------------------ other inputs */

let inputs = null;

/* Offers to branch off where the machine itself is in the page and the run is one of the whole of it. */
function offer(live) {
  place("run-if").hidden = !live?.fits;
  if (live?.fits && view.trace.from === undefined) branching(false);
}

function branching(on) {
  for (const id of ["take", "ten", "rest", "back", "stream", "test", "close"]) place(`run-if-${id}`).hidden = !on;
  place("run-if-open").hidden = on;
  place("run-if-flaw").hidden = true;
  if (!on) place("run-if-inputs").replaceChildren();
  const says = on
    ? [`The stored run up to step ${view.trace.from}; then the inputs below. No property is checked on it: save the run, and `, element("code", {}, "safeloc replay"), " checks it."]
    : ["From this step on the machine goes on in the page, with inputs that you choose."];
  place("run-if-says").replaceChildren(...says);
}

function branchOff() {
  const { live, data, trace, step } = view;
  const branch = new Branch(trace, live, step);
  inputs = new Inputs(place("run-if-inputs"), live);
  inputs.fill(branch.storedInputs(Math.min(step + 1, trace.steps)));
  showBranch(data, branch);
}

function showBranch(data, branch) {
  const { plotted, watched, part } = view;
  showRun(data, branch);
  [view.plotted, view.watched, view.part] = [plotted, watched, part];
  view.fill();
  place("run-verdict").textContent = `not checked: other inputs from step ${branch.from + 1} on`; // no verdict speaks of this run
  place("run-statement").textContent = "";
  place("run-slider").max = place("run-step").max = branch.steps;
  place("run-of").textContent = `of ${branch.steps}`;
  view.setLive(branch.live);
  offer(branch.live);
  branching(true);
  go(branch.steps);
}

/* Takes steps with what `given` returns for each; what the machine refuses is said, and the steps before it stay. */
function takeSteps(count, given) {
  const { trace, data } = view;
  let flaw = "";
  try {
    for (let taken = 0; taken < count; taken += 1) trace.take(given(trace.steps + 1), data.signals);
  } catch (error) {
    flaw = error.message;
  }
  showBranch(data, trace);
  place("run-if-flaw").hidden = !flaw;
  place("run-if-flaw").textContent = flaw;
}

function takeBack() {
  if (view.trace.steps > view.trace.from) view.trace.back();
  showBranch(view.data, view.trace);
}

function save(form, ending) {
  try {
    download(`${view.data.name}-run${ending}`, view.trace.written(form));
  } catch (error) {
    place("run-if-flaw").hidden = false;
    place("run-if-flaw").textContent = error.message;
  }
}

function closeBranch() {
  const { from, stored } = view.trace;
  const { live, data } = view;
  head(data, stored);
  showRun(data, stored);
  setUp("");
  const whole = new Live(live.machine, stored);
  view.setLive(whole);
  offer(whole);
  go(from);
}

async function copyLink() {
  remember();
  try {
    await navigator.clipboard.writeText(location.href);
    place("run-said").textContent = "link copied";
  } catch {
    place("run-said").textContent = `the link is in the address line: ${location.href}`;
  }
}

function help() {
  place("run-help").hidden = !place("run-help").hidden;
  place("run-keys").setAttribute("aria-expanded", String(!place("run-help").hidden));
}

/* ------------------------------------------------------ buttons and keys */

const zoom = (factor) => view.charts.zoom(factor);

function zoomAll() {
  view.charts.whole();
  view.charts.draw();
}

const PRESSED = {
  "run-start": () => go(0),
  "run-back-one": () => go(view.step - 1),
  "run-play": play,
  "run-on-one": () => go(view.step + 1),
  "run-end": () => go(view.trace.steps),
  "run-fired-before": () => goFired(-1),
  "run-fired-next": () => goFired(1),
  "run-violating": goViolating,
  "run-change-before": () => goChange(-1),
  "run-change-next": () => goChange(1),
  "run-link": copyLink,
  "run-keys": help,
  "run-if-open": branchOff,
  "run-if-take": () => takeSteps(1, () => inputs.given),
  "run-if-ten": () => takeSteps(10, () => inputs.given),
  "run-if-rest": () => takeSteps(view.trace.stored.steps - view.trace.steps, (step) => view.trace.storedInputs(step)),
  "run-if-back": takeBack,
  "run-if-stream": () => save("asStream", ".jsonl"),
  "run-if-test": () => save("asTest", "_test.py"),
  "run-if-close": closeBranch,
  "run-zoom-in": () => zoom(0.5),
  "run-zoom-out": () => zoom(2),
  "run-zoom-all": zoomAll,
};

const KEYS = {
  ArrowLeft: () => go(view.step - 1),
  ArrowRight: () => go(view.step + 1),
  "Shift ArrowLeft": () => goFired(-1),
  "Shift ArrowRight": () => goFired(1),
  Home: () => go(0),
  End: () => go(view.trace.steps),
  " ": play,
  v: goViolating,
  c: () => goChange(1),
  "Shift C": () => goChange(-1),
  "+": () => zoom(0.5),
  "-": () => zoom(2),
  0: zoomAll,
  "/": () => place("run-filter").focus(),
  "?": help,
};

for (const [id, pressed] of Object.entries(PRESSED)) place(id).addEventListener("click", () => view && pressed());
place("run-slider").addEventListener("input", (event) => view && go(Number(event.target.value)));
place("run-step").addEventListener("change", (event) => view && go(Math.trunc(Number(event.target.value)) || 0));
place("run-watch").addEventListener("submit", (event) => {
  event.preventDefault();
  view?.watch(place("run-expression").value.trim());
  place("run-expression").value = "";
});
place("run-filter").addEventListener("input", () => view?.showValues());
place("run-only").addEventListener("change", () => view?.showValues());
place("run-part").addEventListener("change", (event) => view && project(event.target.value));
place("run-choice").addEventListener("change", (event) => (location.hash = linkTo(event.target.value, "").replace("&step=", "")));

document.addEventListener("keydown", (event) => {
  if (!view || place("run").hidden || event.ctrlKey || event.metaKey || event.altKey) return;
  const typed = event.target.closest("input:not([type=range]):not([type=checkbox]), select, textarea");
  if (typed || (event.key === " " && event.target.closest("button, summary, input"))) return;
  if (event.target.type === "range" && /^(Arrow|Home|End)/.test(event.key) && !event.shiftKey) return;
  const pressed = (event.shiftKey && KEYS[`Shift ${event.key}`]) || KEYS[event.key];
  if (!pressed) return;
  event.preventDefault();
  pressed();
});

addEventListener("hashchange", async () => {
  const before = view;
  await open();
  if (view !== before && document.activeElement !== place("run-choice")) place("run-title").focus(); // whoever does not see the page hears that another run is shown
});
addEventListener("beforeprint", () => view?.rowsAround(0, true));
addEventListener("afterprint", () => view?.follow());
queueMicrotask(open); // after the data that stand behind this script
