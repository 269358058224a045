/* Opens a run by its link, and moves through it: buttons, keys, play, and the link of every step. */

const APART_MS = 220; // between two steps while it plays
const FEW_INPUTS = 12; // fit on the screen
const MOST_OF_LINK = 8000; // characters, which every browser and mail program takes

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
  if (!view || playing) return;
  const more = { ...(view.part ? { machine: view.part } : {}), ...(view.plotted.length ? { chart: view.plotted.join(",") } : {}) };
  const { trace } = view;
  const branch = trace.from === undefined ? {} : { of: view.data.declaration, from: trace.from, take: JSON.stringify(trace.changes()), ...chosenToGoOn() };
  asked = linkTo(view.result, view.step, { ...more, ...branch }, view.watched);
  const tooLong = asked.length > MOST_OF_LINK;
  place("run-if-link").textContent = tooLong ? `This run is too long for a link (${shown(asked.length, null)} characters, at most ${shown(MOST_OF_LINK, null)}): save it as a stream. The link leads to the step at which it branches off.` : "";
  if (tooLong) asked = linkTo(view.result, trace.from, more, view.watched);
  history.replaceState(null, "", asked);
}

let soon = 0;
function moved() {
  clearTimeout(soon);
  soon = setTimeout(remember, 150);
  say();
}

/* How a run with other inputs is to go on: what a link holds of the form beside the steps. */
function chosenToGoOn() {
  const [how, until, most] = ["how", "until", "most"].map((name) => place(`run-if-${name}`).value);
  return { how, ...(until ? { until } : {}), most, ...(inputs.own.size ? { yours: [...inputs.own].join(",") } : {}) };
}

/* The same out of a link; what the machine has not, or a link of an earlier version has not, stays as it is. */
function chooseToGoOn(words) {
  for (const name of ["how", "until"]) {
    const field = place(`run-if-${name}`);
    if ([...field.options].some(({ value }) => value === words.get(name))) field.value = words.get(name);
  }
  const most = Number(words.get("most"));
  if (Number.isInteger(most) && most >= 1 && most <= MOST_STEPS) place("run-if-most").value = String(most);
  const yours = (words.get("yours") ?? "").split(",").filter(Boolean);
  if (view.trace.taken.length) inputs.restore(yours, view.trace.taken.at(-1));
  refill();
  moved();
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
  choices(read, result, data);
  showRun(data, trace);
  view.plotted = (words.get("chart") ?? "").split(",").filter((one) => view.signal(one));
  setUp(words.get("machine") ?? "");
  const step = words.has("step") ? Number(words.get("step")) : words.has("drive") ? locatedStep(view) : (view.violating ?? (view.fired[0] ?? 0));
  view.watched = words.getAll("watch");
  go(Number.isInteger(step) ? step : 0);
  const opened = view;
  let flaw = script ? "this is a run of one machine by itself" : "this page has no script of the machine";
  const live = await machineOf(file, script, trace).catch((error) => {
    flaw = error.message;
    return null;
  });
  if (view !== opened) return;
  if (live) start(live);
  else {
    view.unexplained = flaw;
    view.show(view.step);
  }
  if (words.has("take")) takeLink(words, live, flaw);
  else if (words.has("drive")) drive(live, flaw);
}

function start(live) {
  view.setLive(live);
  offer(live);
}

/* The steps with other inputs that a link holds; where they cannot be taken, the reason, and the stored run stays. */
function takeLink(words, live, flaw) {
  const { data, trace } = view;
  try {
    if (!live?.fits) throw new Error(flaw || live.flaw || "this run has not all variables of the machine");
    if (words.get("of") !== data.declaration) throw new Error(`it is of another version of ${data.name}`);
    const from = Number(words.get("from"));
    if (!Number.isInteger(from) || from < 0 || from > trace.steps) throw new Error(`this run has no step ${words.get("from")}`);
    const branch = new Branch(trace, live, from);
    branch.follow(changesOf(words.get("take")), data.signals);
    begin(branch, live);
    chooseToGoOn(words);
    go(Number(words.get("step") || branch.steps));
  } catch (error) {
    place("run-flaw").hidden = false;
    place("run-flaw").textContent = `The steps with other inputs of this link cannot be shown: ${spoken(error.message)} The stored run stands below.`.replace(/([^.])( The stored)/, "$1.$2");
  }
}

function changesOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    throw new Error("its changes are damaged");
  }
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
  place("run-verdict").replaceChildren(element("span", { class: `verdict ${verdict.replaceAll(" ", "-")}` }, verdict), ` ${wordOf(result, trace, data)}`);
  place("run-statement").textContent = spoken(statement);
  place("run-back").href = known.alone ? "" : `${known.report}${at ? `#${at}` : ""}`;
  place("run-back").hidden = known.alone;
  const others = trace.results.slice(1);
  place("run-shows").textContent = others.length ? `also shows ${others.length} other result${others.length > 1 ? "s" : ""}` : "";
  place("run-shows").title = others.join("\n");
  document.title = `${result}: run`;
}

function choices(read, result, data) {
  const options = read.runs.flatMap((run) => run.results.map((one) => element("option", { value: one, selected: one === result }, `${one.split("/").slice(1).join("/")} (${run.steps}${data.results[one]?.defence ? ", defence" : ""})`)));
  place("run-choice").replaceChildren(...options);
}

function wordOf(result, trace, data) {
  const member = memberOf(data, trace);
  const steps = `${trace.steps} step${trace.steps === 1 ? "" : "s"}${member ? ` of ${member} by itself` : ""}`;
  if (data.results[result]?.verdict === "unknown") return `a counterexample to induction, ${steps} from a state that keeps all that is proved to one that breaks the property; no run need come there`;
  if (data.results[result]?.defence) return `a defence: a run of ${steps} that breaks a law of the world, to which the machine answers in its last step`;
  const broken = [...new Set((data.results[result]?.broken ?? []).map(([, step]) => step))];
  const last = broken.at(-1);
  if (broken.length > 1) return `at steps ${broken.slice(0, -1).join(", ")} and ${last} of ${trace.steps}`;
  return broken.length ? `at step ${last} of ${trace.steps}` : `a run of ${steps}`;
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
  place("run-now-title").textContent = view.step ? `step ${view.step} of ${view.trace.steps}` : "before the first step";
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
  place("run-if-open").hidden = !live?.fits;
  branching(Boolean(live?.fits) && view.trace.from !== undefined);
}

function branching(on) {
  place("run").classList.toggle("branching", on);
  place("run-if").hidden = !on;
  if (on) place("run-if-open").hidden = true;
  place("run-if-flaw").hidden = place("run-if-note").hidden = true;
}

function branchOff() {
  const { live, trace, step } = view;
  begin(new Branch(trace, live, step), live);
  place("run-if-title").scrollIntoView({ block: matchMedia("(max-width: 600px)").matches ? "start" : "nearest" }); // on a phone the charts stand before the form
}

/* A step early in the longest stretch with a valid position, for somebody who wants to see what becomes of it. */
function locatedStep({ data, trace }) {
  if (!data.reported) return 0;
  const valid = trace.series("outputs", data.reported.valid).map((value) => value === data.reported.valid_is);
  let longest = [0, 0];
  for (const [isValid, from, to] of stretches(valid, 0, trace.steps)) if (isValid && to - from > longest[1] - longest[0]) longest = [from, to];
  return longest[0] + Math.floor((longest[1] - longest[0]) / 4);
}

/* Branches off for somebody who wants to break a sensor: goes on as recorded, until the position is withdrawn. */
function drive(live, flaw) {
  if (!live?.fits) {
    place("run-flaw").hidden = false;
    place("run-flaw").textContent = `The machine cannot be driven here: ${live?.flaw || flaw}. The stored run stands below.`;
    return;
  }
  branchOff();
  place("run-if-until").value = "withdrawn";
  place("run-if-most").value = 1000;
  place("run-if-note").hidden = false;
  place("run-if-note").textContent = "To break a sensor, empty its field below (it is then absent in each step) and press \u201cgo on\u201d. The charts show what becomes of the interval.";
}

function begin(branch, live) {
  inputs = new Inputs(place("run-if-inputs"), live);
  inputs.changed = moved;
  place("run-if-filter").value = "";
  filterInputs();
  place("run-if-how").value = branch.steps < branch.stored.steps ? "recorded" : "repeat"; // after the recording's end there is nothing to follow
  untils();
  showBranch(view.data, branch);
  refill();
}

/* Fills the form for the next step: with what is recorded of it, or with what was given last. */
function refill() {
  const { trace } = view;
  const next = trace.steps + 1;
  const recorded = place("run-if-how").value === "recorded" || !trace.taken.length;
  inputs.fill(recorded ? trace.storedInputs(Math.min(next, trace.stored.steps)) : trace.taken.at(-1));
}

/* Leaves the inputs whose names have the words of the filter; of a few inputs nobody needs one. */
function filterInputs() {
  const found = inputs.filter(place("run-if-filter").value);
  place("run-if-filters").hidden = inputs.rows.length <= FEW_INPUTS;
  place("run-if-found").textContent = `${found} of ${inputs.rows.length}`;
}

/* Until what the machine may go on: its position, its modes, or an output. */
function untils() {
  const { reported } = view.data;
  const names = view.names("outputs").map((name) => element("option", { value: `output ${name}` }, `${name} changes`));
  const withdrawn = reported ? [element("option", { value: "withdrawn" }, "the position is withdrawn")] : [];
  place("run-if-until").replaceChildren(element("option", { value: "" }, "that many steps"), ...withdrawn, element("option", { value: "mode" }, "a mode changes"), ...names);
}

/* A function that tells after each step whether to stop. Error where that can never be. */
function stopper() {
  const { trace, data } = view;
  const until = place("run-if-until").value;
  const at = (kind, names) => JSON.stringify(names.map((name) => String(trace.at(kind, name, trace.steps))));
  const changes = (kind, names) => {
    const before = at(kind, names);
    return () => at(kind, names) !== before;
  };
  if (until === "withdrawn") {
    const isValid = () => trace.at("outputs", data.reported.valid, trace.steps) === data.reported.valid_is;
    if (!isValid()) throw new Error(`no position is valid at step ${trace.steps}, so none can be withdrawn.`);
    return () => !isValid();
  }
  if (until === "mode") return changes("state", trace.names.state.filter((name) => name.split(".").at(-1) === "mode"));
  return until ? changes("outputs", [until.slice("output ".length)]) : () => false;
}

function showBranch(data, branch) {
  const { plotted, watched, part } = view;
  showRun(data, branch);
  [view.plotted, view.watched, view.part] = [plotted, watched, part];
  view.fired = view.firingSteps(); // of the chosen machine alone
  view.fill();
  place("run-verdict").textContent = `a run by hand: other inputs from step ${branch.from + 1} on; no proof speaks of it`;
  place("run-statement").textContent = "";
  place("run-slider").max = place("run-step").max = branch.steps;
  place("run-of").textContent = `of ${branch.steps}`;
  view.setLive(branch.live);
  offer(branch.live);
  place("run-violating").hidden = view.violating === null;
  sayBranch(branch);
  go(branch.steps);
}

/* What the claims of the machine say of the steps that were taken here. */
function sayBranch(branch) {
  const { claims } = branch.live.machine;
  const many = claims.length === 1 ? "1 property is" : `${claims.length} properties are`;
  const checked = claims.length ? `${many} checked in every step.` : "It has no property that can be checked here.";
  place("run-if-says").textContent = `The stored run up to step ${branch.from}; then the inputs below. ${checked} That none is violated is no proof.`;
  const lines = branch.broken.map(([statement, step, name]) => {
    const to = element("button", { class: "quiet violated", onclick: () => go(step) }, `step ${step}`);
    return element("p", { class: "violated" }, element("b", {}, `violated: ${name}`), spoken(statement) === name ? " " : `, ${spoken(statement)} `, to);
  });
  const laws = branch.steps > branch.from ? view.live.broken(branch.steps) : [];
  if (laws.length) lines.push(element("p", { class: "unknown" }, `Step ${branch.steps} breaks ${laws.join("; ")}. What would be lawful stands below, at \u201cthis step\u201d.`));
  const { silent } = branch;
  if (silent.length) lines.push(element("p", { class: "unknown" }, `From step ${silent[0].step} on ${silent.length} of ${many.replace(/ (is|are)$/, "")} say nothing, since a step broke what they assume.`));
  place("run-if-broken").replaceChildren(...lines);
}

/* Takes the step that is filled in; what the machine refuses is said. */
function takeOne() {
  takeSteps(1, () => inputs.given, () => false);
}

/* Takes steps until one does what is asked for, a property is violated, or the number is reached. */
function goOn() {
  const { trace } = view;
  const most = Number(place("run-if-most").value);
  const asRecorded = place("run-if-how").value === "recorded";
  if (!Number.isInteger(most) || most < 1 || most > MOST_STEPS) return sayFlaw(`at most 1 to ${shown(MOST_STEPS, null)} steps can be taken at once.`);
  try {
    const repeated = asRecorded ? null : inputs.given;
    takeSteps(most, (step) => repeated ?? (step > trace.stored.steps ? null : inputs.over(trace.storedInputs(step))), stopper());
  } catch (error) {
    sayFlaw(error.message);
  }
}

/* `given` tells the inputs of a step, null where the recording has ended. */
function takeSteps(most, given, isEnough) {
  const { trace, data } = view;
  const [begun, violated] = [trace.steps, trace.broken.length];
  let [flaw, why, note] = ["", "", ""];
  try {
    while (!why && !note && trace.steps - begun < most) {
      const next = given(trace.steps + 1);
      if (next) trace.take(next, data.signals);
      if (!next) note = `The recording ends with step ${trace.stored.steps}${notCome()}.`;
      else if (trace.broken.length > violated) why = "a property is violated";
      else if (isEnough()) why = place("run-if-until").selectedOptions[0].textContent;
    }
  } catch (error) {
    flaw = error.message;
  }
  showBranch(data, trace);
  refill();
  const taken = trace.steps - begun;
  if (most > 1) place("run-if-says").textContent = `${taken} step${taken === 1 ? "" : "s"} taken${why ? `: ${why}` : ""}. ${place("run-if-says").textContent}`;
  place("run-if-note").hidden = !note;
  place("run-if-note").textContent = note;
  if (flaw) sayFlaw(flaw);
}

/* That what the machine should go on until has not come. */
function notCome() {
  const until = place("run-if-until").value;
  if (until === "withdrawn") return "; the position was not withdrawn";
  if (until === "mode") return "; no mode changed";
  return until ? `; ${until.slice("output ".length)} did not change` : "";
}

function sayFlaw(text) {
  place("run-if-flaw").hidden = false;
  place("run-if-flaw").textContent = spoken(text);
}

function takeBack() {
  if (view.trace.steps > view.trace.from) view.trace.back();
  showBranch(view.data, view.trace);
  refill();
}

function save(form, ending) {
  try {
    download(`${view.data.name}-run${ending}`, view.trace.written(form));
  } catch (error) {
    sayFlaw(error.message);
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
  "run-if-take": takeOne,
  "run-if-on": goOn,
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
place("run-if-how").addEventListener("change", () => view?.trace.from !== undefined && refill());
for (const name of ["how", "until", "most"]) for (const kind of ["change", "input"]) place(`run-if-${name}`).addEventListener(kind, () => view && moved());
place("run-if-filter").addEventListener("input", filterInputs);
place("run-filter").addEventListener("keydown", (event) => {
  if (event.key !== "Enter") return;
  event.preventDefault(); // else the key would press the button that has the focus then
  view?.openFirst();
});
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
