// What all plots share: colours, type, size, and how they come onto the page one after the other.

// Okabe and Ito's palette, which people with any colour vision can tell apart.
const kOrange = "#e69f00";
const kSkyBlue = "#56b4e9";
const kGreen = "#009e73";
const kBlue = "#0072b2";
const kVermilion = "#d55e00";
const kPurple = "#cc79a7";
const kBlack = "#1b1f24";
const kGrey = "#8a929b";
const kPalette = [kBlue, kVermilion, kGreen, kPurple, kOrange, kSkyBlue, kBlack];

const kPolicyColours = {
  "random": kOrange,
  "handcrafted": kBlue,
  "learned": kGreen,
  "fine-tuned": kPurple,
};
const kPolicySymbols = {
  "random": "triangle-up",
  "handcrafted": "square",
  "learned": "circle",
  "fine-tuned": "diamond",
};

/** The policy of which this is the motion with a rival's path length, or the policy itself. */
function withoutPath(policy) {
  return typeof policy === "string" ? policy.replace(/ at (random|handcrafted)'s path$/, "") : policy;
}

/** The same on the whole page, for policies that are not the paper's as well. */
const policyColour = (() => {
  const others = [kVermilion, kSkyBlue, kBlack, kGrey];
  const given = new Map(Object.entries(kPolicyColours));
  return (policy) => {
    // The same motion at another length is the same colour made lighter.
    if (withoutPath(policy) !== policy) return shade(policyColour(withoutPath(policy)), 0.45);
    if (!given.has(policy)) {
      given.set(policy, others[(given.size - Object.keys(kPolicyColours).length) % others.length]);
    }
    return given.get(policy);
  };
})();

function policySymbol(policy) {
  return kPolicySymbols[withoutPath(policy)] ?? "cross";
}

/** A colour of the form #rrggbb, mixed with white (towards 1) or black (towards -1). */
function shade(colour, amount) {
  const target = amount > 0 ? 255 : 0;
  const parts = [1, 3, 5].map((i) => {
    const value = parseInt(colour.slice(i, i + 2), 16);
    const mixed = Math.round(value + (target - value) * Math.abs(amount));
    return mixed.toString(16).padStart(2, "0");
  });
  return `#${parts.join("")}`;
}

/** Plotly reads tags in its texts; a name is to be shown as it is. */
function plotText(text) {
  return String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

const kTouch = window.matchMedia("(pointer: coarse)").matches;
const kHover = window.matchMedia("(hover: hover)").matches;
const kNarrow = window.matchMedia("(max-width: 480px)").matches;
const kFont = {
  family: "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif",
  size: 13,
  color: kBlack,
};
const kConfig = {
  responsive: true,
  displaylogo: false,
  displayModeBar: kHover && !kNarrow ? "hover" : false,
  modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d"],
  // By default plotly offers to send the chart to its maker's server; a report stays where it is.
  showSendToCloud: false,
  plotlyServerURL: "",
};

function axis(title, more = {}) {
  return {
    title: {text: title, standoff: 8, font: {size: 13}},
    automargin: true,
    exponentformat: "power",
    gridcolor: "#e8ebef",
    zerolinecolor: "#c5cbd2",
    ...more,
  };
}

/** Names of categories, one below the other, the first at the top. */
function namesAxis(numNames) {
  return {
    automargin: true, type: "category", range: [numNames - 0.5, -0.5], ticks: "outside", ticklen: 6,
    tickcolor: "rgba(0,0,0,0)", gridcolor: "#e8ebef",
  };
}

/**
 * Logarithmic, with every tick written out: 0.01, 0.02, 0.05, 0.1 ..; only powers of ten where the
 * values span more than three of them.
 */
function logAxis(title, values = []) {
  const known = values.filter((x) => x > 0);
  const span = known.reduce((a, b) => Math.max(a, b), 0) /
      known.reduce((a, b) => Math.min(a, b), Infinity);
  const ticks = [];
  for (let power = -12; power < 9; ++power) {
    const digits = span > 1e3 ? [1] : [1, 2, 5];
    ticks.push(...digits.map((digit) => Number(`${digit}e${power}`)));
  }
  const words = ticks.map((tick) => tick < 1e-4 || tick >= 1e6
      ? tick.toExponential(0).replace(/^(\d)e\+?(-?\d+)$/, "$1×10<sup>$2</sup>") : String(tick));
  return axis(title, {type: "log", tickvals: ticks, ticktext: words});
}

function sceneAxis(title, nticks) {
  return {
    title: {text: title, font: {size: 13}},
    gridcolor: "#d5dae0",
    zerolinecolor: "#aab2bb",
    backgroundcolor: "#fafbfc",
    showbackground: true,
    nticks,
  };
}

/** Sides of the box around what is shown of 3-D traces. */
function boxSides(traces) {
  return ["x", "y", "z"].map((name) => {
    const values = traces.flatMap((trace) => trace.visible === false ? [] : trace[name])
        .filter(isNumber);
    return values.reduce((a, b) => Math.max(a, b), -Infinity) -
        values.reduce((a, b) => Math.min(a, b), Infinity);
  });
}

/** A 3-D scene with equal scales, seen from this direction, far enough away to see all of it. */
function scene(titles, direction, traces) {
  const sides = boxSides(traces);
  const longest = Math.max(...sides);
  // Plotly makes the box as large as a cube of side 1.
  const cube = Math.cbrt(sides[0] * sides[1] * sides[2]);
  const distance = (kNarrow ? 1.5 : 1) * Math.max(1, cube > 0 ? 0.85 * longest / cube : 1);
  const eye = Object.fromEntries(direction.map((x, i) => ["xyz"[i], distance * x]));
  const axes = titles.map(
      (title, i) => sceneAxis(title, Math.max(2, Math.round(6 * sides[i] / longest))));
  return {
    xaxis: axes[0],
    yaxis: axes[1],
    zaxis: axes[2],
    aspectmode: "data",
    camera: {eye, center: {x: 0, y: 0, z: -0.15}, projection: {type: "perspective"}},
  };
}

function completeLayout(layout) {
  return {
    font: kFont,
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    margin: {l: 10, r: 10, t: 10, b: 10},
    legend: {orientation: "h", x: 0, y: 1.02, yanchor: "bottom", itemsizing: "constant"},
    modebar: {bgcolor: "rgba(255,255,255,0.85)", color: kGrey, activecolor: kBlue},
    // A finger on a plot is to scroll the page.
    dragmode: kTouch ? false : "zoom",
    hoverlabel: {align: "left"},
    ...layout,
  };
}

/** A bar that says what the colours mean, above the plot, where it takes little room. */
function colourBar(title) {
  return {
    orientation: "h", x: 0, xanchor: "left", y: 1.02, yanchor: "bottom", thickness: 10,
    lenmode: "pixels", len: 240, outlinewidth: 0, nticks: 6,
    title: {text: title, side: "top", font: {size: 13}},
  };
}

/** Texts without the tags that plotly reads. */
function untagged(text) {
  return String(text ?? "").replace(/<br>/g, " ").replace(/<[^>]*>/g, "")
      .replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&");
}

/** What the axes of a trace are called: with their units, where the plot says them. */
function axisTitles(place, trace) {
  const layout = trace.scene === undefined && !trace.type.endsWith("3d")
      ? place.layout : place.layout.scene;
  return ["x", "y", "z"].map((name) => {
    const own = trace[`${name}axis`]?.slice(1) ?? "";
    const title = layout?.[`${name}axis${own}`]?.title?.text ?? layout?.[`${name}axis`]?.title?.text;
    return untagged(title) || name;
  });
}

/** The points of a trace: [x, y, z, text, below, above], the last two the ends of its interval. */
function pointsOf(trace) {
  if (list(trace.z).some(Array.isArray)) {
    return trace.z.flatMap((row, r) => row.map((z, c) => [
      trace.x?.[c] ?? c, trace.y?.[r] ?? r, z, null, null, null,
    ]));
  }
  const length = Math.max(...["x", "y", "z"].map((name) => trace[name]?.length ?? 0));
  const bars = trace.error_x ?? trace.error_y;
  const value = (i) => trace[trace.error_x ? "x" : "y"]?.[i];
  return Array.from({length}, (_, i) => [
    trace.x?.[i], trace.y?.[i], trace.z?.[i], Array.isArray(trace.text) ? trace.text[i] : null,
    bars ? value(i) - (bars.arrayminus ?? bars.array)[i] : null,
    bars ? value(i) + bars.array[i] : null,
  ]);
}

/** What a plot shows, a line for each point; columns without a value are left out. */
function plotRows(place) {
  // Where traces have axes of their own, as of x, y and z one above the other, the series says which.
  const ownAxis = (trace) => axisTitles(place, trace)[1];
  const several = new Set(place.data.map(ownAxis)).size > 1;
  const series = (trace) => several ? `${untagged(trace.name)}, ${ownAxis(trace)}` : untagged(trace.name);
  const rows = place.data.flatMap((trace) => pointsOf(trace).map(
      (point) => [series(trace), ...point].map(
          (cell) => typeof cell === "string" ? untagged(cell) : cell)));
  const axes = axisTitles(place, place.data[0]);
  if (several) axes[1] = "value";
  const titles = ["series", ...axes, "text", "low", "high"];
  const known = titles.map((_, k) => k).filter(
      (k) => rows.some((row) => row[k] !== "" && row[k] !== null && row[k] !== undefined));
  return [titles, ...rows].map((row) => known.map((k) => row[k]));
}

function csvOf(rows) {
  const cell = (x) => {
    const text = x === null || x === undefined || Number.isNaN(x) ? "" : String(x);
    return /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  };
  return rows.map((row) => `${row.map(cell).join(",")}\n`).join("");
}

function saveText(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], {type}));
  element("a", {href: url, download: name}).click();
  // Whoever saves it has to open it first.
  setTimeout(() => URL.revokeObjectURL(url), 60e3);
}

/**
 * Buttons that save a figure's data as a list and its picture, for papers and talks.
 * @param name  what stands before it, beside its card's title; may be empty.
 * @param rowsOf  () -> rows of cells, the first one of titles.
 * @param svgOf  () -> SVG text, or a promise of it.
 */
function saveButtons(place, name, rowsOf, svgOf) {
  const title = `${place.closest(".card")?.querySelector("h3")?.textContent ?? "plot"} ${name}`;
  const file = title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  const csv = element("button", {type: "button", title: "Its data as a table"}, "CSV");
  csv.addEventListener("click", () => saveText(`${file}.csv`, "text/csv", csvOf(rowsOf())));
  const svg = element("button", {type: "button", title: "Its picture"}, "SVG");
  svg.addEventListener("click", async () => {
    saveText(`${file}.svg`, "image/svg+xml", await svgOf());
  });
  return element("div", {class: "save"}, csv, svg);
}

async function plotSvg(place) {
  const {clientWidth: width, clientHeight: height} = place;
  const url = await Plotly.toImage(place, {format: "svg", width, height});
  return decodeURIComponent(url.slice(url.indexOf(",") + 1));
}

const drawQueue = [];

/** What is drawn here waits for its turn; `draw` may return a promise. */
function whenItsTurnComes(place, draw) {
  drawQueue.push({place, draw});
}

/**
 * A place for a plot, drawn when its turn comes.
 * @param build  () -> {data, layout}, or a text that says why there is nothing to draw.
 * @param options  {height: css}
 */
function plot(build, options = {}) {
  const place = element("div", {class: "plot"});
  if (options.height) place.style.height = options.height;
  whenItsTurnComes(place, async () => {
    const figure = build();
    if (typeof figure === "string") {
      place.replaceWith(emptyNote(figure));
      return;
    }
    await Plotly.newPlot(place, figure.data, completeLayout(figure.layout), kConfig);
    place.after(saveButtons(place, "", () => plotRows(place), () => plotSvg(place)));
  });
  return place;
}

function isInView(place) {
  const {top, bottom} = place.getBoundingClientRect();
  return bottom > 0 && top < window.innerHeight;
}

/** Draws what waits: first what is in view, then the rest; between two the page can breathe. */
async function drawAll() {
  while (drawQueue.length > 0) {
    const inView = drawQueue.findIndex(({place}) => isInView(place));
    const [{place, draw}] = drawQueue.splice(Math.max(0, inView), 1);
    try {
      await draw();
    } catch (error) {
      const reason = emptyNote(`This part could not be drawn: ${error.message}.`);
      reason.classList.add("plot-failed");
      place.replaceWith(reason);
    }
    await new Promise((resume) => setTimeout(resume, 0));
  }
}

// For paper the page becomes narrower. Plots of lines are drawn anew at that width. WebGL would
// draw only after the print was taken, and browsers may print its canvas empty: it keeps its size,
// is shrunk, and gets a picture of itself as background.
const kPaperWidth = 640;

function photograph(place) {
  const photo = place._fullLayout?.scene?._scene?.toImage("png");
  if (photo) place.querySelector("canvas").style.background = `url(${photo}) 0 0 / 100% 100%`;
}

function onEveryPlot(fitLines, fitWebGl) {
  for (const place of document.querySelectorAll(".js-plotly-plot")) {
    (place.querySelector("canvas") ? fitWebGl : fitLines)(place);
  }
}

window.addEventListener("beforeprint", () => {
  onEveryPlot(() => {}, (place) => {
    photograph(place);
    const width = place.offsetWidth;
    place.style.width = `${width}px`;
    place.style.zoom = Math.min(1, kPaperWidth / width);
  });
  document.body.classList.add("printing");
  // Plotly's own resizing waits until the print is taken.
  onEveryPlot((place) => {
    Plotly.relayout(place, {width: place.clientWidth, height: place.clientHeight});
  }, () => {});
});
window.addEventListener("afterprint", () => {
  document.body.classList.remove("printing");
  onEveryPlot((place) => {
    Plotly.relayout(place, {width: null, height: null, autosize: true});
  }, (place) => {
    place.style.width = "";
    place.style.zoom = "";
    place.querySelector("canvas").style.background = "";
  });
});
