/* Narrows the list of conditions to those of one owner, and to those with a figure that has to be confirmed. On paper all stand. */

function narrow() {
  const [owner, confirm] = ["owner", "confirm"].map((name) => document.querySelector(`[data-narrows="${name}"]`));
  const rows = [...document.querySelectorAll("table.conditions tr[data-owner]")];
  for (const row of rows) row.hidden = Boolean((owner.value && row.dataset.owner !== owner.value) || (confirm.checked && !("confirm" in row.dataset)));
  owner.closest("p").querySelector("[role=status]").textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`;
}

document.documentElement.classList.add("narrowed");
addEventListener("change", (event) => event.target.dataset.narrows && narrow());
