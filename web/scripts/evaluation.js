// Figures of the paper, and error against budget: tables of rows and charts, as they come.

const kEvaluationLines = {
  evaluation: "Every table and figure, one after the other.",
  figure4: "Error of the intrinsics against the field of view.",
  figure5: "How the error of the extrinsics is distributed over rigs.",
  figure7: "What the estimator says of one recording of each motion.",
  pareto: "What a method makes of a smaller budget: of path, of time, of frames.",
  ablation: "Learners that differ in one thing, from as many episodes each.",
  planners: "Planners under equal budgets of expected information.",
  rows: "Open loop, robust, closed loop, and what an oracle would have done.",
  rivals: "Estimators and motions, each with each, on the same recordings.",
};

/** Over how many trials, and how many of them failed. */
function evaluationSummary(result) {
  const rows = list(result.rows);
  const trials = rows.reduce((sum, row) => sum + (row.n ?? 0), 0);
  const failures = rows.reduce((sum, row) => sum + (row.failures ?? 0), 0);
  const failed = failures > 0 ? `, of which ${number(failures)} failed` : "";
  const details = rows.length === 0 ? ""
      : `${counted(rows.length, "row", "rows")} of ${counted(trials, "trial", "trials")}${failed}.`;
  return {
    verdict: "inform", tag: "results", line: kEvaluationLines[result.kind] ?? "", details,
    findings: list(result.findings),
  };
}

function evaluationCell(row, column) {
  if (column.key === "policy") return policyCell(row.policy ?? kNothing);
  const value = row[column.key];
  if (typeof value === "string") return value;
  if (column.unit === "" && Number.isInteger(value)) return number(value);
  const range = column.interval_key ? interval(row[column.interval_key]) : "";
  if (range === "") return measured(value);
  return element("span", {}, measured(value), element("span", {class: "interval"}, range));
}

function evaluationTable(setting, rows, columns) {
  const known = columns.filter(({key}) => {
    // Which of several motions of one name: no news where there is one of each.
    if (key === "member" && rows.every((row) => row.member === 1)) return false;
    return rows.some((row) => isNumber(row[key]) || typeof row[key] === "string");
  });
  return table(known.map(({name, unit}) => headerCell(["", name, unit])),
               rows.map((row) => known.map((column) => evaluationCell(row, column))),
               capitalised(setting));
}

/** The policy in a series' name, of "learned, scaled" and of "opencv, learned": its colour tells it. */
function seriesPolicy(name) {
  const parts = String(name).split(", ");
  return parts.find((part) => Object.hasOwn(kPolicyColours, part)) ?? parts[0];
}

function seriesTrace(series, kind) {
  const policy = seriesPolicy(series.name);
  const colour = policyColour(policy);
  const name = plotText(series.name);
  if (kind === "boxes") {
    return {
      ...boxTrace(series.name, colour, series.y.length <= kMostDots, series.y),
      hovertemplate: "%{x:.3g}<extra></extra>",
    };
  }
  const bars = list(series.low).length === series.y.length && series.low.length > 0
      ? {error_y: {type: "data", symmetric: false, thickness: 1.5, width: 4,
                   array: series.high.map((high, i) => high - series.y[i]),
                   arrayminus: series.low.map((low, i) => series.y[i] - low)}}
      : {};
  const isLine = kind === "lines";
  const few = series.y.length <= kMostDots;
  return {
    type: "scatter", name, x: series.x, y: series.y, ...bars,
    mode: isLine ? (few ? "lines+markers" : "lines") : "markers",
    line: {color: colour, width: few ? 2 : 1, dash: /, cut$/.test(series.name) ? "dot" : "solid"},
    marker: {color: colour, size: isLine ? 8 : 4, symbol: policySymbol(policy),
             opacity: isLine ? 1 : 0.5},
    hovertemplate: `${name}: %{y:.3g} at %{x:.4g}<extra></extra>`,
  };
}

function chartCard(chart) {
  const series = list(chart.series).filter((each) => list(each.y).some(isNumber));
  return card(chart.title, chart.note, plot(() => {
    if (series.length === 0) return "No trial has this figure.";
    const all = (key) => series.flatMap((each) => list(each[key]));
    const scaled = (isLogarithmic, title, values) => {
      return isLogarithmic ? logAxis(title, values) : axis(title);
    };
    const values = scaled(chart.is_y_logarithmic, chart.y_title, all("y"));
    // Boxes lie down.
    const layout = chart.kind === "boxes"
        ? {xaxis: values, yaxis: namesAxis(series.length)}
        : {xaxis: scaled(chart.is_x_logarithmic, chart.x_title, all("x")), yaxis: values};
    return {data: series.map((each) => seriesTrace(each, chart.kind)), layout};
  }, {height: "420px"}));
}

function evaluationSection(result) {
  const rows = list(result.rows);
  const plots = result.plots ?? {};
  const made = element("div", {class: "cards"});
  if (rows.length > 0) {
    const tables = card("The numbers", "Each column sorts at a click on its head; 95 % intervals " +
                                       "stand below the means.");
    for (const [setting, group] of settings(rows)) {
      tables.append(evaluationTable(setting, group, list(plots.columns)));
    }
    made.append(wide(tables));
  }
  made.append(...list(plots.charts).map(chartCard));
  return [made];
}
