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
    gridcolor: "#e8ebef",
    zerolinecolor: "#c5cbd2",
    ...more,
  };
}

/** Logarithmic, with every tick written out: 0.01, 0.02, 0.05, 0.1 .. */
function logAxis(title) {
  const ticks = [];
  for (let power = -12; power < 9; ++power) {
    ticks.push(...[1, 2, 5].map((digit) => Number(`${digit}e${power}`)));
  }
  return axis(title, {type: "log", tickvals: ticks, ticktext: ticks.map(String)});
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

/** What a plot shows, a line for each point. */
function plotCsv(place) {
  const quoted = (text) => `"${String(text ?? "").replace(/"/g, '""')}"`;
  const lines = ["series,x,y,z"];
  for (const trace of place.data) {
    const length = Math.max(...["x", "y", "z"].map((axis) => trace[axis]?.length ?? 0));
    for (let i = 0; i < length; ++i) {
      lines.push([quoted(trace.name), trace.x?.[i], trace.y?.[i], trace.z?.[i]]
          .map((cell) => cell ?? "").join(","));
    }
  }
  return `${lines.join("\n")}\n`;
}

function saveAs(name, url) {
  element("a", {href: url, download: name}).click();
}

/** The figure's data as a list and its picture, for papers and talks. */
function saveButtons(place) {
  const title = place.closest(".card")?.querySelector("h3")?.textContent ?? "plot";
  const name = title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
  const csv = element("button", {type: "button"}, "CSV");
  csv.addEventListener("click", () => {
    const url = URL.createObjectURL(new Blob([plotCsv(place)], {type: "text/csv"}));
    saveAs(`${name}.csv`, url);
    URL.revokeObjectURL(url);
  });
  const svg = element("button", {type: "button"}, "SVG");
  svg.addEventListener("click", async () => {
    const {clientWidth: width, clientHeight: height} = place;
    saveAs(`${name}.svg`, await Plotly.toImage(place, {format: "svg", width, height}));
  });
  return element("div", {class: "save"}, csv, svg);
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
    place.after(saveButtons(place));
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
