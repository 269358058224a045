"use strict";
/* Opens parts of the page: each lies beside it as a script that hands over packed HTML, since a page that was opened from
   disk may load scripts and nothing else. Whatever is missing, damaged or of another report is told in its place. */
(() => {
  const made = document.documentElement.dataset.made;
  const again = "; `safeloc report FOLDER` writes the page and its parts again";
  const waiting = new Map();

  function say(box, text) {
    const place = box.querySelector("div");
    place.textContent = text;
    place.className = "violated";
  }

  async function unpacked(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  }

  window.safelocPart = async (name, of, text) => {
    const box = waiting.get(name);
    waiting.delete(name);
    if (!box) return;
    if (of !== made) {
      say(box, `${name} is of another report than this page${again}.`);
    } else if (typeof DecompressionStream === "undefined") {
      say(box, "This browser is too old to open parts; `safeloc report FOLDER --single-file` writes a page that has none.");
    } else {
      try {
        box.querySelector("div").innerHTML = await unpacked(text);
        box.dataset.shown = "";
        box.dispatchEvent(new CustomEvent("shown", { bubbles: true }));
      } catch {
        say(box, `${name} is damaged${again}.`);
      }
    }
  };

  function load(name, onload, onerror) {
    const script = document.createElement("script");
    script.src = name;
    script.onload = onload;
    script.onerror = onerror;
    document.head.append(script);
  }

  function open(box) {
    if ("asked" in box.dataset) return;
    box.dataset.asked = "";
    const name = box.dataset.part;
    waiting.set(name, box);
    box.querySelector("div").textContent = "opening";
    load(
      name,
      () => waiting.delete(name) && say(box, `${name} is damaged${again}.`),
      () => waiting.delete(name) && say(box, `${name} is missing beside this page${again}.`),
    );
  }

  const boxes = document.querySelectorAll("details.part");
  for (const box of boxes) box.addEventListener("toggle", () => box.open && open(box));
  /* A link to a place in a part that is not open yet, the one that follows the link, opens it first. */
  document.addEventListener("click", (event) => {
    const link = event.target.closest('a[href^="#"]');
    if (!link || document.getElementById(link.hash.slice(1))) return;
    const after = (box) => link.compareDocumentPosition(box) & Node.DOCUMENT_POSITION_FOLLOWING;
    const named = (box) => box.dataset.part === link.dataset.in;
    const box = [...boxes].find(link.dataset.in ? named : after);
    if (!box) return;
    event.preventDefault();
    box.open = true;
    const seen = new MutationObserver(() => {
      if (!document.getElementById(link.hash.slice(1))) return;
      seen.disconnect();
      location.hash = link.hash;
    });
    seen.observe(box, { childList: true, subtree: true });
  });
  function openAll() {
    for (const box of boxes) box.open = true;
  }
  document.getElementById("open-all").addEventListener("click", openAll);

  /* What is printed is opened first, and each part has come or said why not. Of one machine: nothing else is on paper. */
  const come = (box) => "shown" in box.dataset || box.querySelector("div.violated");
  async function opened(printed) {
    for (const box of printed) box.open = true;
    while (!printed.every(come)) await new Promise((resolve) => setTimeout(resolve, 50));
  }
  async function prepared(section) {
    document.documentElement.classList.toggle("prints-one", Boolean(section));
    section?.classList.add("printed");
    await opened([...boxes].filter((box) => !section || section.contains(box)));
    unlinked(section ?? document);
    return section;
  }
  /* On paper the number of a term leads nowhere; thousands of links make a printer slow. Afterwards they are back. */
  let links = [];
  function unlinked(where) {
    links = [...where.querySelectorAll(".term a")].map((link) => [link, document.createTextNode(link.textContent)]);
    for (const [link, text] of links) link.replaceWith(text);
  }
  function linked() {
    for (const [link, text] of links) text.replaceWith(link);
    links = [];
    for (const section of document.querySelectorAll(".printed")) section.classList.remove("printed");
    document.documentElement.classList.remove("prints-one");
  }
  const printed = async (section) => {
    await prepared(section);
    print();
  };
  addEventListener("afterprint", linked);
  const printAll = () => printed(null);
  document.getElementById("print-all").addEventListener("click", printAll);
  for (const button of document.querySelectorAll("button.print-one")) button.addEventListener("click", () => printed(button.closest("section")));
  /* `index.html#print`, and `#print=MACHINE` or `#print=conditions`, are ready for a program that prints: what is to be printed is open. */
  const asked = new URLSearchParams(location.hash.slice(1)).get("print");
  if (asked !== null) {
    const section = asked && [...document.querySelectorAll("[data-prints]")].find(({ dataset }) => dataset.prints === asked);
    if (asked && !section) warnOf(`this report has no machine ${asked}`);
    else prepared(section || null).then(() => (document.documentElement.dataset.printable = ""));
  }
  document.addEventListener("keydown", (event) => {
    if (event.key !== "p" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    printAll();
  });

  function warn(what) {
    warnOf(`${what}: the parts of this page cannot be opened${again}.`);
  }
  function warnOf(text) {
    const place = document.getElementById("beside");
    place.textContent = text;
    place.hidden = false;
  }
  window.safelocBeside = (of) => {
    if (of === made) return;
    warn("The files beside this page are of another report");
    document.documentElement.classList.add("unfit"); // no verdict is shown beside evidence of another
  };
  load("page/beside.js", null, () => warn("The files beside this page (folder `page`) are missing"));
})();
