/* Makes elements. Every text becomes a text node, so no name can bring markup with it. */

function element(tag, given = {}, ...children) {
  const made = document.createElement(tag);
  fill(made, given, children);
  return made;
}

function drawn(tag, given = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(made, given, children);
  return made;
}

function fill(made, given, children) {
  for (const [name, value] of Object.entries(given)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null));
}

const place = (id) => document.getElementById(id);

/* A value as the machine's own words have it; digits in groups of three. */
function shown(value, signal) {
  if (value === null || value === undefined) return "absent";
  if (typeof value === "boolean") return String(value);
  if (signal?.members?.length) return signal.members[Number(value)] ?? String(value);
  return grouped(String(value).replace("-", "\u2212"));
}

/* The digits before a decimal point in groups of three. */
const grouped = (digits) => digits.replace(/^[^.]+/, (whole) => whole.replace(/\B(?=(\d{3})+$)/g, "\u202f"));
