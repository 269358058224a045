/* A word of the glossary carries its meaning at its first use in each section: Enter, a click or a touch shows it, Escape or a click elsewhere
   takes it away. The words and their meanings are those that the page lists at its end. */

const EVERYDAY = new Set(["border", "definition", "fix", "helper", "layer", "loose", "own", "part", "reset", "standing", "target", "whole"]); // also said in their common meaning
const LISTED = [...document.querySelectorAll("#words-list dt")].map((dt) => ({
  id: dt.id,
  names: dt.querySelector("b").textContent.split(", "),
  meaning: dt.nextElementSibling.textContent,
}));
const byName = new Map(LISTED.flatMap((word) => word.names.filter((name) => !EVERYDAY.has(name)).map((name) => [name.toLowerCase(), word])));
const inCapitals = (word) => word.names.find((name) => name.length > 1 && name === name.toUpperCase());
const WORD = new RegExp(`\\b(${[...byName.keys()].sort((one, other) => other.length - one.length).map((name) => name.replace(/[^\w ]/g, "\\$&")).join("|")})(?:s|es)?\\b`, "gi");
const SAID = "p, th, li, figcaption, td.says"; // where sentences stand
const UNSAID = "a, button, code, pre, svg, label, select, dl, #overview, .explained"; // names and code explain nothing
const explainedIn = new Map(); // heading or section -> ids of the words that were explained there

/* What stands together: a section, or everything under a heading. */
function groupOf(one) {
  const own = one.closest("[data-prints]");
  if (own) return own;
  let at = one.closest("main > *");
  while (at && at.localName !== "h2") at = at.previousElementSibling;
  return at ?? document.body;
}

function explain(box) {
  const said = [...(box.matches(SAID) ? [box] : []), ...box.querySelectorAll(SAID)];
  for (const one of said) for (const text of textsOf(one)) explainText(text);
}

function textsOf(one) {
  const walker = document.createTreeWalker(one, NodeFilter.SHOW_TEXT);
  const found = [];
  while (walker.nextNode()) if (!walker.currentNode.parentElement.closest(UNSAID)) found.push(walker.currentNode);
  return found;
}

function explainText(text) {
  const group = groupOf(text.parentElement);
  if (!explainedIn.has(group)) explainedIn.set(group, new Set());
  const known = explainedIn.get(group);
  for (const found of text.data.matchAll(WORD)) {
    const word = byName.get(found[1].toLowerCase());
    if (known.has(word.id) || (inCapitals(word) && found[1] !== inCapitals(word))) continue;
    known.add(word.id);
    const rest = text.splitText(found.index);
    rest.splitText(found[0].length);
    const link = element("a", { class: "explained", href: `#${word.id}`, "aria-expanded": "false" }, rest.data);
    rest.replaceWith(link);
    return explainText(link.nextSibling);
  }
}

/* ------------------------------------------------------ the meaning */

let shownFor = null;

function hideMeaning() {
  document.querySelector(".bubble")?.remove();
  shownFor?.setAttribute("aria-expanded", "false");
  shownFor = null;
}

function showMeaning(link) {
  const again = shownFor === link;
  hideMeaning();
  if (again) return;
  const { names, meaning } = LISTED.find(({ id }) => `#${id}` === link.hash);
  const box = element("span", { class: "bubble", role: "status" }, element("b", {}, names.join(", ")), `: ${meaning}`);
  document.querySelector("main").append(box);
  const at = link.getBoundingClientRect();
  const left = Math.max(8, Math.min(at.left, document.documentElement.clientWidth - box.offsetWidth - 8));
  box.style.left = `${left + scrollX}px`;
  box.style.top = `${at.bottom + scrollY + 6}px`;
  link.setAttribute("aria-expanded", "true");
  shownFor = link;
}

document.addEventListener("click", (event) => {
  const link = event.target.closest("a.explained");
  if (!link) return hideMeaning();
  event.preventDefault();
  showMeaning(link);
});
document.addEventListener("keydown", (event) => event.key === "Escape" && hideMeaning());

/* Only what comes into sight is looked through, all of a group at once, so that the first use is the first one. */
const near = new IntersectionObserver((seen) => {
  for (const { target, isIntersecting } of seen) {
    if (!isIntersecting) continue;
    near.unobserve(target);
    explain(target);
  }
}, { rootMargin: "400px" });
if (LISTED.length) {
  for (const one of document.querySelectorAll("main > p, main > section, main > div.scroll")) near.observe(one);
  document.addEventListener("shown", (event) => explain(event.target));
}
