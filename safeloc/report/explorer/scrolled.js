/* What is wider than its place can be scrolled by key: it takes the focus as long as it does not fit, and says what it is. */

function reachable(box) {
  const wide = box.scrollWidth > box.clientWidth + 1;
  if (wide === box.hasAttribute("data-wide")) return;
  if (wide) fill(box, { "data-wide": true, tabindex: 0, role: "group", "aria-label": "wider than the page: the arrow keys scroll it" }, []);
  else for (const name of ["data-wide", "tabindex", "role", "aria-label"]) box.removeAttribute(name);
}

const sizes = new ResizeObserver((seen) => seen.forEach(({ target }) => reachable(target)));

/* A picture has its own name; the lists of the page of runs take the focus always. */
function watchSizes(where) {
  for (const box of where.querySelectorAll(".scroll:not([tabindex]), pre")) sizes.observe(box);
}

watchSizes(document);
document.addEventListener("shown", (event) => watchSizes(event.target));
document.addEventListener("toggle", (event) => event.target.open && event.target.closest(".scroll") && reachable(event.target.closest(".scroll")), true);
