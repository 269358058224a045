/* The state diagram of a machine, with the mode before and after a step and the way between them. */

/* Reports of earlier versions have the tips of arrows as a marker. */
const PERMITTED = new Set(["svg", "g", "path", "rect", "text", "defs", "marker"]);

class Diagram {
  constructor(box) {
    this.box = box;
    this.part = null;
  }

  show(part, before, after) {
    if (this.part !== part) this.load(part);
    for (const one of this.svg.querySelectorAll("[data-mode]")) {
      one.classList.toggle("before", one.dataset.mode === before);
      one.classList.toggle("now", one.dataset.mode === after);
    }
    for (const one of this.svg.querySelectorAll("[data-from]")) {
      one.classList.toggle("taken", one.dataset.from === before && one.dataset.to === after);
    }
    this.svg.setAttribute("aria-label", `state diagram of ${part.name}: ${before === after ? `in ${after}` : `from ${before} to ${after}`}`);
  }

  /* The drawing is text of the report: only elements that draw are taken from it, and nothing that acts. */
  load(part) {
    this.part = part;
    const read = new DOMParser().parseFromString(part.svg, "image/svg+xml").documentElement;
    for (const one of [...read.querySelectorAll("*")]) {
      if (!PERMITTED.has(one.localName) || one.classList.contains("legend")) one.remove();
    }
    for (const one of [read, ...read.querySelectorAll("*")]) {
      for (const { name } of [...one.attributes]) if (/^on|href/i.test(name)) one.removeAttribute(name);
    }
    this.svg = document.importNode(read, true);
    this.svg.classList.add("diagram");
    this.box.replaceChildren(this.svg);
    const drawing = this.svg.getBBox();
    this.svg.setAttribute("viewBox", [drawing.x - 8, drawing.y - 8, drawing.width + 16, drawing.height + 16].join(" "));
    this.svg.style.maxWidth = `${Math.round(drawing.width + 16)}px`;
    this.svg.removeAttribute("width");
    this.svg.removeAttribute("height");
  }
}
