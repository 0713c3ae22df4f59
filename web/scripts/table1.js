// Motions compared: who calibrates better, by how much, and is it more than chance.

function settingOf(row) {
  return [row.task, row.carrier && `${row.carrier} carrier`,
          row.fidelity && `${row.fidelity} simulation`].filter(Boolean).join(", ");
}

/** Rows, or what is drawn of them, by task, carrier and fidelity, in their order. */
function settings(rows) {
  const made = new Map();
  for (const row of rows) {
    const setting = settingOf(row);
    if (!made.has(setting)) made.set(setting, []);
    made.get(setting).push(row);
  }
  return made;
}

/** One card for each setting; one that says what is missing if there is none. */
function cardsBySetting(entries, makeCard) {
  if (entries.length === 0) return [makeCard("", [])];
  return [...settings(entries)].map(([setting, group]) => makeCard(setting, group));
}

function withSetting(setting, note) {
  return setting === "" ? note : `${capitalised(setting)}. ${note}`;
}

/** One sentence on a policy and handcrafted, and whether it is good, open or bad news. */
function comparison(setting, row) {
  const where = setting === "" ? "" : `${capitalised(setting)}: `;
  const ci = list(row.ratio_ci95);
  const known = ci.length === 2 && ci.every(isNumber);
  const range = known ? ` (95 % interval ${interval(ci)})` : "";
  const rigs = isNumber(row.n) ? `, over ${counted(row.n, "rig", "rigs")}` : "";
  const sentence = `${where}${row.policy} has ${number(row.ratio_to_handcrafted, 3)} times the ` +
      `error of handcrafted${range}${rigs}`;
  if (!known) return {verdict: "inform", text: `${sentence}.`};
  if (ci[1] < 1) return {verdict: "pass", text: `${sentence}: better, and more than chance.`};
  if (ci[0] > 1) return {verdict: "fail", text: `${sentence}: worse, and more than chance.`};
  return {verdict: "inconclusive", text: `${sentence}: no difference is shown.`};
}

const kComparisonTags = {
  pass: "better", fail: "worse", inconclusive: "open", inform: "compared", warn: "mixed",
};

function table1Summary(result) {
  const rows = list(result.rows);
  const all = [];
  for (const [setting, group] of settings(rows)) {
    for (const policy of ["learned", "fine-tuned"]) {
      const row = group.find((candidate) => candidate.policy === policy);
      if (row && isNumber(row.ratio_to_handcrafted)) all.push(comparison(setting, row));
    }
  }
  const failures = rows.reduce((sum, row) => sum + (row.failures ?? 0), 0);
  const details = failures > 0
      ? `${counted(failures, "calibration", "calibrations")} failed; see the table.` : "";
  if (all.length === 0) {
    const line = rows.length === 0 ? "Nothing was compared."
                                   : `${counted(rows.length, "row", "rows")} of results; none ` +
                                     "compares a learned motion with handcrafted.";
    return {verdict: "inform", line, details, findings: list(result.findings)};
  }
  const same = all.every((each) => each.verdict === all[0].verdict);
  const verdict = same ? all[0].verdict : "warn";
  return {
    verdict, tag: kComparisonTags[verdict], line: all[0].text,
    also: all.slice(1).map((each) => each.text), details, findings: list(result.findings),
  };
}

/** What a column says, by its key: header, digits. Those that no row has are left out. */
const kColumns = [
  ["n", "rigs", 4],
  ["mean_error_percent", "mean error [%], 95 % interval", 3, "ci95"],
  ["median_error_percent", "median error [%]", 3],
  ["ratio_to_handcrafted", "error relative to handcrafted, 95 % interval", 3, "ratio_ci95"],
  ["path_length_m", "path [m]", 4],
  ["path_length_original_m", "path as the paper summed it [m]", 4],
  ["motion_s", "time [s]", 3],
  ["prediction_error_px", "prediction error [px]", 3],
  ["focal_error_px", "focal length error [px]", 3],
  ["translation_error_m", "translation error [m]", 3],
  ["rotation_error_rad", "rotation error [rad]", 3],
  ["time_offset_error_s", "time offset error [s]", 3],
  ["a_optimality", "A-optimality", 3],
  ["a_optimality_conditional", "A-optimality as the paper's code", 3],
  ["error_over_bound", "error over bound [1]", 3],
  ["failures", "failures", 4],
];

function policyCell(policy) {
  const swatch = element("span", {class: "swatch"});
  swatch.style.background = policyColour(policy);
  return element("span", {}, swatch, policy);
}

function numberCell(row, [key, , digits, intervalKey]) {
  const range = intervalKey ? interval(row[intervalKey], digits) : "";
  if (range === "") return number(row[key], digits);
  return element("span", {}, number(row[key], digits), element("span", {class: "interval"}, range));
}

function table1Table(setting, rows) {
  const columns = kColumns.filter(([key]) => rows.some((row) => isNumber(row[key])));
  return table(["motion", ...columns.map(([, header]) => header)],
               rows.map((row) => [policyCell(row.policy ?? kNothing),
                                  ...columns.map((column) => numberCell(row, column))]),
               capitalised(setting));
}

function meanErrorCard(setting, rows) {
  const build = () => {
    const known = rows.filter((row) => isNumber(row.mean_error_percent));
    if (known.length === 0) return "No mean error is stated.";
    return {
      data: known.map((row) => {
        const range = list(row.ci95);
        const mean = row.mean_error_percent;
        const bars = range.length === 2 && range.every(isNumber)
            ? {error_x: {type: "data", symmetric: false, array: [range[1] - mean],
                         arrayminus: [mean - range[0]], thickness: 2.5, width: 8}}
            : {};
        return {
          type: "scatter", mode: "markers", x: [mean], y: [plotText(row.policy ?? kNothing)],
          showlegend: false, ...bars,
          marker: {size: 12, color: policyColour(row.policy), symbol: policySymbol(row.policy)},
          hovertemplate: `%{y}: ${number(mean, 3)} % (${interval(range)})<extra></extra>`,
        };
      }),
      layout: {
        xaxis: axis("mean error [%]", {rangemode: "tozero"}),
        yaxis: {automargin: true, type: "category", range: [known.length - 0.5, -0.5]},
      },
    };
  };
  return card("Mean error, with its 95 % interval", capitalised(setting), plot(build));
}

function errorCard(setting, errors) {
  const build = () => {
    const known = errors.filter((each) => list(each.relative_error).some((x) => x > 0));
    if (known.length === 0) return "The errors of the single rigs were not handed over.";
    return {
      data: known.map((each) => ({
        type: "box", name: plotText(each.policy),
        y: each.relative_error.map((x) => isNumber(x) && x > 0 ? 100 * x : null),
        boxpoints: "all", jitter: 0.6, pointpos: 0, showlegend: false,
        marker: {color: policyColour(each.policy), size: 4, opacity: 0.6},
        line: {color: policyColour(each.policy), width: 2},
        fillcolor: "rgba(0,0,0,0)", hovertemplate: "%{y:.3g} %<extra></extra>",
      })),
      layout: {
        xaxis: {automargin: true},
        yaxis: logAxis("error [%], logarithmic"),
      },
    };
  };
  return card("Error on each rig",
              withSetting(setting, "One dot a rig; the box holds the middle half, its line is " +
                                       "the median."),
              plot(build));
}

function coverageByMethodCard(setting, coverage, resolution) {
  const made = card("Where the board's corners were in the image",
                    withSetting(setting, "Corners of all frames that count, for each motion."));
  const known = coverage.filter((each) => list(each.pixels).length > 0);
  if (known.length === 0) {
    made.append(emptyNote("No corners were handed over."));
    return made;
  }
  const row = element("div", {class: "plot-row"});
  for (const each of known) {
    const build = () => ({
      data: [{
        type: pointTraceType(each.pixels.length), mode: "markers",
        x: each.pixels.map((pixel) => pixel[0]), y: each.pixels.map((pixel) => pixel[1]),
        marker: {size: 3, color: policyColour(each.policy), opacity: 0.5},
        hovertemplate: "(%{x:.1f}, %{y:.1f})<extra></extra>",
      }],
      layout: imageLayout(resolution),
    });
    row.append(element("div", {}, policyCell(each.policy),
                       plot(build, {aspect: imageAspect(resolution, false)})));
  }
  made.append(row);
  return made;
}

function table1Section(result) {
  const rows = list(result.rows);
  const plots = result.plots ?? {};
  const made = element("div", {class: "cards"});
  const tables = card("The table", "Errors are relative to the truth. A ratio whose interval " +
                                   "excludes 1 is more than chance.");
  if (rows.length === 0) tables.append(emptyNote("There are no rows."));
  for (const [setting, group] of settings(rows)) tables.append(table1Table(setting, group));
  const resolution = plots.resolution ?? [640, 480];
  made.append(
      wide(tables),
      ...cardsBySetting(list(plots.errors), errorCard),
      ...cardsBySetting(rows, meanErrorCard),
      ...cardsBySetting(list(plots.coverage), (setting, coverage) => {
        return wide(coverageByMethodCard(setting, coverage, resolution));
      }),
      ...cardsBySetting(list(plots.motions), (setting, motions) => {
        const title = setting === "" ? "The motions" : `The motions: ${setting}`;
        return wide(motionCard(motions, plots.board_outline_b, title));
      }));
  return [made];
}
