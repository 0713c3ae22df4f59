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

/** One sentence on a motion and a rival, and whether it is good, open or bad news. */
function comparison(setting, row, rival, ratio, ratioInterval) {
  const where = setting === "" ? "" : `${capitalised(setting)}: `;
  const ci = list(ratioInterval);
  const known = ci.length === 2 && ci.every(isNumber);
  const range = known ? ` (95 % interval ${interval(ci)})` : "";
  const rigs = isNumber(row.n) ? `, over ${counted(row.n, "rig", "rigs")}` : "";
  const sentence = `${where}${row.policy} has ${number(ratio, 3)} times the error of ` +
      `${rival}${range}${rigs}`;
  if (!known) return {verdict: "inform", text: `${sentence}.`};
  if (ci[1] < 1) return {verdict: "pass", text: `${sentence}: better, and more than chance.`};
  if (ci[0] > 1) return {verdict: "fail", text: `${sentence}: worse, and more than chance.`};
  return {verdict: "inconclusive", text: `${sentence}: no difference is shown.`};
}

/**
 * What a policy is worth in one setting: against handcrafted as it is, and against random at a path
 * no longer than random's.
 */
function comparisonsOf(policy, setting, rows) {
  const row = rows.find((candidate) => candidate.policy === policy);
  const fair = rows.find((candidate) => candidate.policy === `${policy} at random's path`) ?? row;
  const made = [];
  if (row && isNumber(row.ratio_to_handcrafted)) {
    made.push(comparison(setting, row, "handcrafted", row.ratio_to_handcrafted, row.ratio_ci95));
  }
  if (fair && isNumber(fair.ratio_to_random)) {
    made.push(comparison(setting, fair, "random", fair.ratio_to_random,
                         fair.ratio_to_random_ci95));
  }
  const rival = row?.best_simple_rival;
  if (rival && rival !== "handcrafted" && isNumber(row.ratio_to_best_simple_rival)) {
    made.push(comparison(setting, row, `the best simple rival (${rival})`,
                         row.ratio_to_best_simple_rival, row.ratio_to_best_simple_rival_ci95));
  }
  return made;
}

const kComparisonTags = {
  pass: "better", fail: "worse", inconclusive: "open", inform: "compared", warn: "mixed",
};

function table1Summary(result) {
  const rows = list(result.rows);
  const all = [];
  for (const [setting, group] of settings(rows)) {
    for (const policy of ["learned", "fine-tuned"]) {
      all.push(...comparisonsOf(policy, setting, group));
    }
  }
  const failures = rows.reduce((sum, row) => sum + (row.failures ?? 0), 0);
  const details = failures > 0
      ? `${counted(failures, "calibration", "calibrations")} failed; see the table.` : "";
  if (all.length === 0) {
    const line = rows.length === 0 ? "Nothing was compared."
                                   : `${counted(rows.length, "row", "rows")} of results; none ` +
                                     "compares a learned motion with another.";
    return {verdict: "inform", line, details, findings: list(result.findings)};
  }
  const same = all.every((each) => each.verdict === all[0].verdict);
  const verdict = same ? all[0].verdict : "warn";
  return {
    verdict, tag: kComparisonTags[verdict], line: all[0].text,
    also: all.slice(1).map((each) => each.text), details, findings: list(result.findings),
  };
}

/** A column by its key: what it is, its unit, digits, and the key of its interval. */
const kColumns = [
  ["n", "rigs", "", 4],
  ["mean_error_percent", "mean error", "%", 3, "ci95"],
  ["ratio_to_handcrafted", "over handcrafted", "", 3, "ratio_ci95"],
  ["ratio_to_random", "over random", "", 3, "ratio_to_random_ci95"],
  ["path_length_m", "path", "m", 4],
  ["motion_s", "time", "s", 3],
  ["error_over_bound", "error over bound", "", 3],
  ["failures", "failed", "", 4],
  ["paper_mean_error_percent", "the paper's mean error", "%", 3],
  ["paper_path_length_m", "the paper's path", "m", 5],
];
const kFurtherColumns = [
  ["median_error_percent", "median error", "%", 3],
  ["ratio_to_best_simple_rival", "over the best simple rival", "", 3,
   "ratio_to_best_simple_rival_ci95"],
  ["probability_as_handcrafted", "probability of no difference to handcrafted (Holm)", "", 2],
  ["focal_error_px", "focal length error", "px", 3],
  ["centre_error_px", "centre error", "px", 3],
  ["distortion_error_px", "distortion error", "px", 3],
  ["prediction_error_px", "prediction error", "px", 3],
  ["translation_error_m", "translation error", "m", 3],
  ["rotation_error_rad", "rotation error", "rad", 3],
  ["time_offset_error_s", "time offset error", "s", 3],
  ["a_optimality", "A-optimality", "", 3],
  ["a_optimality_conditional", "A-optimality, conditional", "", 3],
  ["a_optimality_original", "A-optimality as the paper's", "", 3],
  ["paper_a_optimality", "the paper's A-optimality", "", 3],
  ["num_frames", "frames", "", 4],
  ["mean_nees", "mean NEES", "", 3, "mean_nees_expected"],
  ["path_length_original_m", "path as the paper summed it", "m", 5],
  ["scale", "shrunk to fit by", "", 3],
];

function policyCell(policy) {
  const swatch = element("span", {class: "swatch"});
  swatch.style.background = policyColour(policy);
  return element("span", {class: "policy"}, swatch, policy);
}

function headerCell([, name, unit]) {
  return unit === "" ? name : element("span", {}, name, element("span", {class: "unit"}, unit));
}

function numberCell(row, [key, , , digits, intervalKey]) {
  const range = intervalKey ? interval(row[intervalKey], digits) : "";
  // Figures of others are repeated as they were printed, with five digits at most.
  const value = digits > 4 || isCount(row[key], digits) ? number(row[key], digits)
                                                         : measured(row[key], digits);
  // The ratio of a rival to itself has no width.
  if (range === "" || row[intervalKey][0] === row[intervalKey][1]) return value;
  return element("span", {}, value, element("span", {class: "interval"}, range));
}

/** Of rigs and failures, with four digits: they are not measured. */
function isCount(x, digits) {
  return Number.isInteger(x) && digits === 4;
}

/** Columns of which no row has a number are left out. */
function rowsTable(rows, candidates, caption) {
  const columns = candidates.filter(([key]) => rows.some((row) => isNumber(row[key])));
  return table(["motion", ...columns.map(headerCell)],
               rows.map((row) => [policyCell(row.policy ?? kNothing),
                                  ...columns.map((column) => numberCell(row, column))]),
               caption);
}

function table1Tables(setting, rows) {
  const made = [rowsTable(rows, kColumns, capitalised(setting))];
  if (kFurtherColumns.some(([key]) => rows.some((row) => isNumber(row[key])))) {
    made.push(element("details", {}, element("summary", {}, "Further columns"),
                      rowsTable(rows, kFurtherColumns, "")));
  }
  return made;
}

/** The name of a motion made shorter, broken where it says so. */
function inTwoLines(policy) {
  return plotText(policy).replace(" at ", "<br>at ");
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
          type: "scatter", mode: "markers", x: [mean], y: [inTwoLines(row.policy ?? kNothing)],
          showlegend: false, ...bars,
          marker: {size: 12, color: policyColour(row.policy), symbol: policySymbol(row.policy)},
          hovertemplate: `%{y}: ${number(mean, 3)} % (${interval(range)})<extra></extra>`,
        };
      }),
      layout: {
        xaxis: axis("mean error [%]", {rangemode: "tozero"}),
        yaxis: namesAxis(known.length),
      },
    };
  };
  return card("Mean error, with its 95 % interval", capitalised(setting), plot(build));
}

/** More rigs than this are drawn as a box and what lies far outside it. */
const kMostDots = 100;

/** A box lying down, since names are long, with its values as dots where they are few. */
function boxTrace(name, colour, few, values) {
  return {
    type: "box", orientation: "h", name: inTwoLines(name), x: values, showlegend: false,
    boxpoints: few ? "all" : "outliers", jitter: few ? 0.6 : 0.3, pointpos: 0,
    marker: {color: colour, size: 4, opacity: 0.6}, line: {color: colour, width: 2},
    fillcolor: "rgba(0,0,0,0)",
  };
}

function errorCard(setting, errors) {
  const build = () => {
    const known = errors.filter((each) => list(each.relative_error).some((x) => x > 0));
    const few = known.every((each) => each.relative_error.length <= kMostDots);
    if (known.length === 0) return "The errors of the single rigs were not handed over.";
    return {
      data: known.map((each) => ({
        ...boxTrace(each.policy, policyColour(each.policy), few,
                    each.relative_error.map((x) => isNumber(x) && x > 0 ? 100 * x : null)),
        hovertemplate: "%{x:.3g} %<extra></extra>",
      })),
      layout: {
        xaxis: logAxis("error [%], logarithmic", known.flatMap((each) => each.relative_error)),
        yaxis: namesAxis(known.length),
      },
    };
  };
  return card("Error on each rig",
              withSetting(setting, "The box holds the middle half of the rigs, its line is the " +
                                       "median; a dot is a rig."),
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
    const colour = policyColour(each.policy);
    row.append(element("div", {}, policyCell(each.policy), picture(resolution, (pen) => {
      pen.context.globalAlpha = 0.5;
      pen.dots(each.pixels, 0.8, () => colour);
    }, () => [["u [px]", "v [px]"], ...each.pixels], {name: each.policy})));
  }
  made.append(row);
  return made;
}

function table1Section(result) {
  const rows = list(result.rows);
  const plots = result.plots ?? {};
  const made = element("div", {class: "cards"});
  const tables = card("The table", "Errors are relative to the truth, ratios are of mean errors; " +
                                   "each with its 95 % interval below. A ratio whose interval " +
                                   "excludes 1 is more than chance. What is the paper's comes " +
                                   "from its own simulator and estimators. Columns sort at a " +
                                   "click on their heads.");
  if (rows.length === 0) tables.append(emptyNote("There are no rows."));
  for (const [setting, group] of settings(rows)) tables.append(...table1Tables(setting, group));
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
      }),
      ...cardsBySetting(list(plots.motions), (setting, motions) => {
        const title = setting === "" ? "The motions, played" : `The motions, played: ${setting}`;
        return playerCards(motions, plots.board_outline_b, title);
      }).flat());
  return [made];
}
