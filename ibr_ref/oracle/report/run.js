"use strict";
{
  const table = document.querySelector("table.run"), body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[0].cells);
  const value = (row, i, number) => {
    const cell = row.cells[i], text = cell.dataset.value ?? cell.textContent;
    return number ? Number(text) || 0 : text;
  };
  heads.forEach((head, i) => head.querySelector("button")?.addEventListener("click", () => {
    const number = head.dataset.of === "number", falls = head.getAttribute("aria-sort") === "ascending";
    for (const other of heads) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", falls ? "descending" : "ascending");
    const sign = falls ? -1 : 1;
    const rows = Array.from(body.rows).sort((a, b) => {
      const [x, y] = [value(a, i, number), value(b, i, number)];
      return sign * (number ? x - y : x.localeCompare(y));
    });
    body.append(...rows);
  }));
  document.body.dataset.ready = "yes";
}
