/* Why something is as it is: parts of a term with their values, which unfold level by level. What was unfolded stays so from step to step. */

const unfoldedNow = new Map(); // key of a fold -> whether it is open, for every fold that somebody opened or closed

/* A fold that remembers whether it is open; what is in it is made when it is opened. */
function fold(key, summary, made, { open = false, css = null } = {}) {
  const box = element("details", { class: css, open: unfoldedNow.get(key) ?? open }, element("summary", { "data-key": key }, ...summary));
  const fill = () => box.open && box.childElementCount === 1 && box.append(...made());
  box.addEventListener("toggle", () => {
    if (box.open !== (unfoldedNow.get(key) ?? open)) unfoldedNow.set(key, box.open);
    fill();
  });
  fill();
  return box;
}

/* Puts other elements into a box; what had the focus has it again. */
function replaced(box, ...made) {
  const key = box.contains(document.activeElement) ? document.activeElement.dataset.key : undefined;
  box.replaceChildren(...made);
  if (key !== undefined) [...box.querySelectorAll("[data-key]")].find((one) => one.dataset.key === key)?.focus({ preventScroll: true });
}

/* The parts one level below a term; first those that decide, and the others in a fold. A single part that has no name of its own is
   open: it says no more than the whole. */
function partsOf(seen, place, key) {
  const parts = seen.parts(place);
  const others = parts.filter((part) => !part.decides);
  const list = (some) => element("ul", { class: "parts" }, ...some.map((part) => partItem(seen, part, `${key}/${part.place}`, parts.length === 1 && !part.name && !part.reads.length)));
  const deciding = list(parts.filter((part) => part.decides));
  if (!others.length) return [deciding];
  const words = others.length === 1 ? "1 part that does not decide" : `${others.length} parts that do not decide`;
  return [deciding, fold(`${key}/others`, [words], () => [list(others)], { css: "others" })];
}

function partItem(seen, part, key, open) {
  const head = partHead(part);
  if (!part.more) return element("li", {}, ...head);
  return element("li", {}, fold(key, head, () => [...meaning(part), ...partsOf(seen, part.place, key)], { open }));
}

function partHead(part) {
  const isTruth = part.value === "true" || part.value === "false";
  const reads = part.reads.filter(({ text }) => text !== part.value).map(({ text, value, unit }) => `${spoken(text)} = ${withUnit(value, unit)}`);
  const about = reads.length ? element("span", { class: "soft" }, ` (${reads.join(", ")})`) : null;
  const name = element("code", { class: part.name ? "named" : null }, spoken(part.name || part.text));
  if (isTruth) return [element("span", { class: part.value === "true" ? "is-true" : "is-false" }, part.value), " ", name, about];
  return [name, " = ", element("b", {}, withUnit(part.value, part.unit)), about];
}

/* What a name stands for. */
const meaning = (part) => (part.name ? [element("p", { class: "meaning" }, "is ", element("code", {}, spoken(part.text)))] : []);

/* A whole term: what it is and its value, with the parts that decide. */
function wholeTerm(seen, place, key) {
  const part = seen.part(place);
  const head = element("p", { class: "meaning" }, ...partHead({ ...part, name: "" }));
  return part.more && !part.reads.length ? [head, ...partsOf(seen, place, key)] : part.more ? [head, fold(`${key}/sides`, ["its sides"], () => partsOf(seen, place, key), { css: "others" })] : [head];
}

/* Whole numbers in a text, in groups of three digits and set apart from their units; names with digits stay as they are. */
function spoken(text) {
  return text.replace(/(?<![\w#]|\d\.)\d{4,}(?!\w)/g, (digits) => grouped(digits)).replace(/(?<![\w#.])(\d[\d\u202f]*) (?=(?:nm|mm|m|ms|s|ppm|km|count)\b)/g, "$1\u00a0");
}

function withUnit(value, unit) {
  const isNumber = /^-?\d+$/.test(value);
  return isNumber ? `${shown(value, null)}${unit ? `\u00a0${unit}` : ""}` : value;
}
