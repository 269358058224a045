/* Search and filter over everything in the report: results, requirements, assumptions and transitions. */

const MOST_ROWS = 100; // more are drawn when they are asked for
const HELD = new Set(["proved", "shown by a run", "properties proved", "held", ""]);
const KIND_ORDER = ["property", "requirement", "assumption", "lemma", "obligation", "transition", "test", "replay"];
const FIELDS = ["machine", "kind", "verdict", "name", "statement", "method", "assumption", "reason"];

const overview = JSON.parse(place("overview-known").textContent);
let reading = null; // the promise of all results, once somebody asked for them
let searches = 0;

/* Results that could not be read are asked for again the next time. */
function results() {
  reading ??= read().catch((error) => {
    reading = null;
    throw error;
  });
  return reading;
}

async function read() {
  const data = await fetched("results all", overview.results);
  if (data.made !== overview.made) throw new Error(`${overview.results} is of another report than this page. ${AGAIN}`);
  const everything = data.rows.map((row) => {
    const one = Object.fromEntries(FIELDS.map((field, at) => [field, data.words[row[at]]]));
    [one.requirements, one.laws, one.certificates, one.steps, one.at, one.declared, one.source] = row.slice(FIELDS.length);
    one.id = one.steps === null ? "" : `${one.machine}/${one.kind}/${one.name}`;
    one.text = [...FIELDS.map((field) => one[field]), ...one.requirements, ...one.laws, one.declared].join(" ").toLowerCase();
    return one;
  });
  for (const field of ["machine", "kind", "verdict"]) choices(field, everything);
  return everything;
}

function choices(field, everything) {
  const found = [...new Set(everything.map((one) => one[field]).filter(Boolean))];
  const before = place(`overview-${field}`).value;
  const options = found.map((value) => element("option", { value, selected: value === before }, value));
  place(`overview-${field}`).replaceChildren(element("option", { value: "" }, `any ${field}`), ...options);
}

/* ------------------------------------------------------ searching */

function wanted() {
  const words = place("overview-words").value.toLowerCase().split(/\s+/).filter(Boolean);
  const chosen = ["machine", "kind", "verdict"].map((field) => [field, place(`overview-${field}`).value]).filter(([, value]) => value);
  return { words, chosen, any: words.length + chosen.length > 0 };
}

/* Shows what was found. A search that another one has overtaken shows nothing: it would close what has been opened since. */
async function search(most = MOST_ROWS) {
  const mine = ++searches;
  const { words, chosen, any } = wanted();
  const box = place("overview-found");
  if (!any) {
    box.replaceChildren();
    place("overview-count").textContent = "";
    return;
  }
  try {
    const all = await results();
    if (mine !== searches) return;
    const found = all.filter(
      (one) => chosen.every(([field, value]) => one[field] === value) && words.every((word) => one.text.includes(word)),
    );
    const asked = words.join(" ");
    found.sort((one, other) => rank(one, asked) - rank(other, asked));
    place("overview-count").textContent = found.length === 1 ? "1 found" : `${found.length} found`;
    const more = element("button", { onclick: () => search(most + 10 * MOST_ROWS) }, `show more of ${found.length}`);
    box.replaceChildren(element("ul", {}, ...found.slice(0, most).map(row)), ...(found.length > most ? [more] : []));
    remember(words, chosen);
  } catch (error) {
    if (mine === searches) place("overview-count").textContent = error.message;
  }
}

/* What has exactly this name comes first, then what does not hold, then claims before the evidence for them. */
const rank = (one, asked) => (one.name?.toLowerCase() === asked ? 0 : 1000) + (HELD.has(one.verdict) ? 100 : 0) + KIND_ORDER.indexOf(one.kind);

function remember(words, chosen) {
  const given = new URLSearchParams([["search", words.join(" ")], ...chosen]);
  history.replaceState(null, "", `#${given}`);
}

/* ------------------------------------------------------ one result */

function row(one) {
  const verdict = one.verdict ? element("span", { class: `verdict ${one.verdict.replaceAll(" ", "-")}` }, one.verdict) : null;
  const head = element("summary", {}, verdict, element("span", { class: "of" }, one.machine), element("b", {}, one.name), element("span", { class: "soft" }, one.kind));
  const box = element("details", {}, head);
  box.addEventListener("toggle", () => box.childElementCount === 1 && box.append(...about(one)));
  return element("li", {}, box);
}

function about(one) {
  const lines = [];
  if (one.statement && one.statement !== one.name) lines.push(element("p", {}, one.statement));
  if (one.reason) lines.push(element("p", {}, one.reason));
  if (one.method) lines.push(element("p", { class: "soft" }, one.method));
  const under = [one.assumption, ...one.laws];
  if (under.some(Boolean)) lines.push(element("p", {}, "rests on: ", under.filter(Boolean).join(", ")));
  const links = leads(one);
  if (links.length) lines.push(element("p", { class: "leads" }, ...links));
  return lines;
}

function leads(one) {
  const links = [];
  const to = (href, words, part) => links.push(element("a", { href, "data-in": part ?? null }, words));
  if (one.id) to(`${overview.run}#${new URLSearchParams({ result: one.id })}`, one.steps === 1 ? "run of 1 step" : `run of ${one.steps} steps`);
  for (const [file, words] of one.certificates) to(file, words);
  if (one.source) to(`#${one.source}`, one.declared, overview.parts[one.machine]);
  else if (one.declared) links.push(element("span", {}, one.declared));
  for (const id of one.requirements) to(`#${id}`, id);
  if (one.at) to(`#${one.at}`, "in the report", overview.parts[one.machine]);
  return links;
}

/* ------------------------------------------------------ keys and links */

/* Opens the first thing that was found. */
async function openFirst() {
  await search();
  const first = place("overview-found").querySelector("details");
  if (!first) return;
  first.open = true;
  first.querySelector("summary").focus();
}

function step(event) {
  const rows = [...place("overview-found").querySelectorAll("summary")];
  const at = rows.indexOf(document.activeElement);
  const next = event.key === "ArrowDown" ? rows[at + 1] : at > 0 ? rows[at - 1] : place("overview-words");
  event.preventDefault();
  next?.focus();
}

function fromLink() {
  const given = new URLSearchParams(location.hash.slice(1));
  if (!["search", "machine", "kind", "verdict"].some((name) => given.has(name)) || given.has("result")) return;
  place("overview-words").value = given.get("search") ?? "";
  for (const field of ["machine", "kind", "verdict"]) {
    const value = given.get(field) ?? "";
    place(`overview-${field}`).replaceChildren(element("option", { value, selected: true }, value || `any ${field}`));
  }
  search();
}

/* The part that has a place which is not on the page yet: its name begins with that of the machine, or it is a row of a result. */
async function partOf(at) {
  if (at.startsWith("condition-")) return overview.conditions;
  const named = (machine) => ["law", "term", "source"].some((kind) => at.startsWith(`${kind}-${machine.replace(/[^A-Za-z0-9]+/g, "-")}-`));
  const longest = Object.keys(overview.parts).filter(named).sort((one, other) => other.length - one.length)[0];
  return overview.parts[longest ?? (await results().catch(() => [])).find((row) => row.at === at)?.machine];
}

/* A link to a place within a part that is not open yet: the part that has it is opened first. A link to a heading opens what it is the heading of. */
async function toPart() {
  const at = location.hash.slice(1);
  if (!at || at.includes("=")) return;
  if (place(at)) return unfold(place(at));
  const part = await partOf(at);
  const box = part && [...document.querySelectorAll("details.part")].find(({ dataset }) => dataset.part === part);
  if (!box) return;
  const seen = new MutationObserver(() => {
    if (!place(at)) return;
    seen.disconnect();
    unfold(place(at));
  });
  seen.observe(box, { childList: true, subtree: true });
  box.open = true;
}

function unfold(one) {
  for (let box = one.closest("details"); box; box = box.parentElement.closest("details")) box.open = true;
  if ("opens" in one.dataset) place(one.dataset.opens).open = true;
  one.scrollIntoView();
}

place("overview").hidden = false;
place("overview-words").addEventListener("focus", () => results().catch(() => {}));
place("overview-words").addEventListener("input", () => search());
for (const field of ["machine", "kind", "verdict"]) {
  place(`overview-${field}`).addEventListener("focus", () => results().catch(() => {}), { once: true });
  place(`overview-${field}`).addEventListener("change", () => search());
}
place("overview").addEventListener("keydown", (event) => {
  if (event.key === "ArrowDown" || event.key === "ArrowUp") {
    if (event.target.localName !== "select") step(event);
  } else if (event.key === "Enter" && event.target === place("overview-words")) {
    event.preventDefault();
    openFirst();
  } else if (event.key === "Escape") {
    place("overview-words").value = "";
    for (const field of ["machine", "kind", "verdict"]) place(`overview-${field}`).value = "";
    search();
    place("overview-words").focus();
  }
});
document.addEventListener("keydown", (event) => {
  const typed = event.target.closest("input, select, textarea");
  if (event.key !== "/" || typed || document.documentElement.classList.contains("shows-run")) return;
  event.preventDefault();
  place("overview-words").focus();
});
addEventListener("hashchange", fromLink);
addEventListener("hashchange", toPart);
queueMicrotask(() => {
  fromLink();
  toPart();
}); // after the data that stand behind this script
