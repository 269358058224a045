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

  /* On paper stands everything: all parts are opened, and each has come or said why not, before the page is printed. */
  async function printAll() {
    openAll();
    const come = (box) => "shown" in box.dataset || box.querySelector("div.violated");
    while (![...boxes].every(come)) await new Promise((resolve) => setTimeout(resolve, 50));
    print();
  }
  document.getElementById("print-all").addEventListener("click", printAll);
  document.addEventListener("keydown", (event) => {
    if (event.key !== "p" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    printAll();
  });

  function warn(what) {
    const place = document.getElementById("beside");
    place.textContent = `${what}: the parts of this page cannot be opened${again}.`;
    place.hidden = false;
  }
  window.safelocBeside = (of) => {
    if (of === made) return;
    warn("The files beside this page are of another report");
    document.documentElement.classList.add("unfit"); // no verdict is shown beside evidence of another
  };
  load("page/beside.js", null, () => warn("The files beside this page (folder `page`) are missing"));
})();
