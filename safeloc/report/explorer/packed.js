/* Packed data of the report: each lies beside the page as a script that hands it over, since a page that was opened from disk may
   load scripts and nothing else; or in the page itself. */

const AGAIN = "`safeloc report FOLDER` writes the pages again, `safeloc verify` the runs.";

const arrived = new Map(); // "runs odometry" -> packed text
const awaited = new Map(); // the same -> what to call when it arrives

function arrive(what, text) {
  arrived.set(what, text);
  awaited.get(what)?.();
}
window.safelocRuns = (name, text) => arrive(`runs ${name}`, text);
window.safelocView = (name, text) => arrive(`view ${name}`, text);
window.safelocResults = (name, text) => arrive(`results ${name}`, text);

/* The data of a script that stands in the page, or beside it. */
async function fetched(what, file) {
  const text = await fetchedText(what, file);
  try {
    return JSON.parse(text);
  } catch {
    throw new Error(`${file} is damaged. ${AGAIN}`);
  }
}

async function fetchedText(what, file) {
  if (!arrived.has(what)) await loaded(what, file);
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old to show runs; `safeloc report FOLDER --extract DIR` writes them as text.");
  }
  try {
    return await unpacked(arrived.get(what));
  } catch {
    throw new Error(`${file} is damaged. ${AGAIN}`);
  }
}

function loaded(what, file) {
  return new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = file;
    script.onload = () => (arrived.has(what) ? resolve() : reject(new Error(`${file} is damaged. ${AGAIN}`)));
    script.onerror = () => reject(new Error(`${file} is missing beside this page. ${AGAIN}`));
    awaited.set(what, resolve);
    document.head.append(script);
  });
}

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}
