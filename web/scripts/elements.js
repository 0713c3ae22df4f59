// The pieces of the page. What comes from a document goes in as text, never as markup.

function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children.filter((child) => child !== null && child !== ""));
  return made;
}

function card(title, note, ...children) {
  const made = element("article", {class: "card"}, element("h3", {}, title));
  if (note) made.append(element("p", {class: "note"}, note));
  made.append(...children);
  return made;
}

function wide(made) {
  made.classList.add("wide");
  return made;
}

function emptyNote(reason) {
  return element("p", {class: "empty"}, reason);
}

/** The text that stands first in a cell: its number, without the interval below it. */
function firstText(cell) {
  return document.createTreeWalker(cell, NodeFilter.SHOW_TEXT).nextNode()?.textContent ?? "";
}

/** Numbers by size, texts by letters, what is missing last; upwards at first, then downwards. */
function sortTable(head, column) {
  const body = head.closest("table").tBodies[0];
  const up = head.getAttribute("aria-sort") !== "ascending";
  for (const other of head.parentNode.children) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", up ? "ascending" : "descending");
  const keyed = [...body.rows].map((row) => {
    const text = firstText(row.cells[column]);
    return {row, text, value: text === kNothing ? NaN : Number(text)};
  });
  const numeric = keyed.every(({text, value}) => text === kNothing || !Number.isNaN(value));
  keyed.sort((a, b) => {
    if ((a.text === kNothing) !== (b.text === kNothing)) return a.text === kNothing ? 1 : -1;
    if (a.text === kNothing) return 0;
    return (up ? 1 : -1) * (numeric ? a.value - b.value : a.text.localeCompare(b.text));
  });
  body.append(...keyed.map(({row}) => row));
}

function sortingHeader(content, column) {
  const head = element("th", {scope: "col", tabindex: "0", class: "sorts"}, content);
  head.addEventListener("click", () => sortTable(head, column));
  head.addEventListener("keydown", (event) => {
    if (event.key === "Enter") sortTable(head, column);
  });
  return head;
}

/** Rows of cells; a cell is a text or an element. From three rows on, columns sort at a click. */
function table(headers, rows, caption) {
  const head = element("tr", {}, ...headers.map((text, column) => {
    return rows.length > 2 ? sortingHeader(text, column) : element("th", {scope: "col"}, text);
  }));
  const body = rows.map(
      (row) => element("tr", {}, ...row.map((cell) => element("td", {}, cell))));
  const made = element("table", {}, element("thead", {}, head), element("tbody", {}, ...body));
  if (caption) made.prepend(element("caption", {}, caption));
  return element("div", {class: "table-frame"}, made);
}

/** Pairs of a name and a text; those without a text are left out. */
function facts(pairs) {
  const made = element("dl", {class: "facts"});
  for (const [name, text] of pairs) {
    if (text === kNothing || text === "" || text === undefined) continue;
    made.append(element("div", {}, element("dt", {}, name), element("dd", {}, text)));
  }
  return made;
}

function tag(text, verdict) {
  return element("span", {"class": "tag", "data-verdict": verdict}, text);
}

/** What was found and what to do about it. */
function findingsList(findings) {
  return element("ul", {class: "findings"}, ...findings.map((finding) => {
    const severity = finding.severity ?? "note";
    const item = element("li", {}, tag(severity, severity), finding.what ?? "");
    if (finding.remedy) {
      item.append(element("span", {class: "remedy"}, element("strong", {}, "What to do: "),
                          finding.remedy));
    }
    return item;
  }));
}

/** @param summary  {verdict, tag: its word if another, line, also: [text..], details, findings} */
function verdictBanner(summary) {
  const made = element("div", {"class": "verdict", "data-verdict": summary.verdict},
                       element("p", {class: "verdict-line"},
                               tag(summary.tag ?? summary.verdict, summary.verdict), summary.line));
  for (const text of summary.also ?? []) {
    made.append(element("p", {class: "verdict-also"}, text));
  }
  if (summary.details) made.append(element("p", {}, summary.details));
  if (list(summary.findings).length > 0) made.append(findingsList(summary.findings));
  return made;
}
