// A camera calibration: may it be believed, what are the numbers, and what do they rest on. What it
// is given: calibrato/report/report.h.

const kVerdictLines = {
  pass: "This calibration can be trusted.",
  warn: "Usable, with the reservations below.",
  fail: "Do not use this calibration.",
  inconclusive: "The recording does not determine the result.",
};

const kProjectionNames = {
  pinhole: ["fu", "fv", "pu", "pv"],
  omni: ["xi", "fu", "fv", "pu", "pv"],
  ds: ["xi", "alpha", "fu", "fv", "pu", "pv"],
  eucm: ["alpha", "beta", "fu", "fv", "pu", "pv"],
};
const kDistortionNames = {
  none: [],
  radtan: ["k1", "k2", "p1", "p2"],
  radtan5: ["k1", "k2", "p1", "p2", "k3"],
  equi: ["k1", "k2", "k3", "k4"],
  fov: ["w"],
};
const kPixelParameters = ["fu", "fv", "pu", "pv"];

function cameraSummary(result) {
  const cameras = list(result.cameras);
  const details = [];
  if (result.termination) details.push(`Solver: ${result.termination}`);
  for (const [index, camera] of cameras.entries()) {
    const name = cameras.length > 1 ? `camera ${index}: ` : "";
    const parts = [];
    if (isNumber(camera.num_views)) parts.push(counted(camera.num_views, "view", "views"));
    if (isNumber(camera.num_corners)) parts.push(counted(camera.num_corners, "corner", "corners"));
    if (isNumber(camera.reprojection_rms_px)) {
      parts.push(`reprojection error ${number(camera.reprojection_rms_px, 3)} px root mean square`);
    }
    if (parts.length > 0) details.push(name + parts.join(", "));
  }
  const verdict = result.verdict ?? "unknown";
  return {
    verdict,
    line: kVerdictLines[verdict] ?? "This result carries no verdict.",
    details: details.length > 0 ? `${details.join("; ")}.` : "",
    findings: list(result.findings),
  };
}

function parameterTable(camera) {
  const [projection, distortion] = String(camera.model ?? "").split("-");
  const rows = [];
  const add = (names, values, sigmas) => {
    for (const [i, value] of list(values).entries()) {
      const name = names?.[i] ?? `parameter ${i}`;
      const sigma = list(sigmas)[i];
      const relative = isNumber(sigma) && value !== 0 ? 100 * sigma / Math.abs(value) : null;
      rows.push([
        name,
        withSigma(value, sigma),
        sigma === 0 ? "held" : number(sigma, 2),
        kPixelParameters.includes(name) ? "px" : "",
        sigma === 0 ? kNothing : number(relative, 2),
      ]);
    }
  };
  add(kProjectionNames[projection], camera.intrinsics, camera.intrinsics_sigma);
  add(kDistortionNames[distortion], camera.distortion, camera.distortion_sigma);
  if (rows.length === 0) return emptyNote("There is no estimate: the solve had nothing to report.");
  return table(["parameter", "value", "one sigma", "unit", "sigma / value [%]"], rows);
}

function cameraFacts(camera) {
  return facts([
    ["model", camera.model ?? ""],
    ["resolution", Array.isArray(camera.resolution) ? `${camera.resolution.join(" x ")} px` : ""],
    ["views", number(camera.num_views)],
    ["corners", number(camera.num_corners)],
    ["reprojection error, inliers [px]", number(camera.reprojection_rms_px, 3)],
    ["reprojection error, all [px]", number(camera.reprojection_rms_all_px, 3)],
  ]);
}

function coverageCard(coverage) {
  const title = "Coverage";
  const note = "How much of the wanted range the views reach: the board's place in the image " +
      "(X, Y), its size and its tilt (skew).";
  if (!coverage) return card(title, note, emptyNote("No coverage is stated."));
  const made = card(title, note);
  for (const [name, key] of [["X", "x"], ["Y", "y"], ["size", "size"], ["skew", "skew"]]) {
    const value = coverage[key];
    if (!isNumber(value)) continue;
    const fill = element("span", {"class": "meter-fill", "data-reached": value < 1 ? "no" : "yes"});
    fill.style.width = `${100 * Math.min(1, Math.max(0, value))}%`;
    made.append(element("div", {class: "meter-row"}, element("span", {}, name),
                        element("span", {class: "meter"}, fill),
                        element("span", {class: "meter-value"}, `${number(100 * value, 3)} %`)));
  }
  return made;
}

function informationCard(information) {
  const made = card(
      "Information",
      "How much the views say about the four intrinsics, in units of 1 px; smaller is better.");
  if (!information) {
    made.append(emptyNote("No information is stated: there is no covariance."));
    return made;
  }
  made.append(facts([
    ["A-optimality (trace)", number(information.a_optimality, 3)],
    ["D-optimality (determinant)", number(information.d_optimality, 3)],
    ["E-optimality (largest eigenvalue)", number(information.e_optimality, 3)],
    ["eigenvalues", list(information.eigenvalues).map((x) => number(x, 3)).join(", ")],
  ]));
  return made;
}

function correlationCard(covariance) {
  const names = list(covariance?.names);
  const matrix = list(covariance?.matrix);
  const build = () => {
    if (names.length === 0 || matrix.length !== names.length) {
      return "There is no covariance, so nothing can be said about correlations.";
    }
    const correlations = matrix.map((row, i) => row.map((value, j) => {
      const scale = Math.sqrt(matrix[i][i] * matrix[j][j]);
      return scale > 0 ? value / scale : null;
    }));
    const shown = names.map(plotText);
    const readable = names.length <= 12 && !kNarrow;
    return {
      data: [{
        type: "heatmap", x: shown, y: shown, z: correlations, zmin: -1, zmax: 1, xgap: 1, ygap: 1,
        colorscale: [[0, kVermilion], [0.5, "#f7f7f7"], [1, kBlue]],
        colorbar: {thickness: 12, outlinewidth: 0},
        texttemplate: readable ? "%{z:.2f}" : "",
        textfont: {size: 11},
        hovertemplate: "%{y}, %{x}: %{z:.3f}<extra></extra>",
      }],
      layout: {
        xaxis: {tickangle: -45, automargin: true, showgrid: false},
        yaxis: {autorange: "reversed", automargin: true, showgrid: false},
      },
    };
  };
  return card("Correlation of the parameters",
              "Near 1 or -1, the recording cannot tell two parameters apart; empty where a " +
                  "parameter was held.",
              plot(build, {height: kNarrow ? "360px" : "420px"}));
}

/** How often chance alone would make it as large; below 0.27 %, three sigmas, it is more. */
function chanceText(probability) {
  if (!isNumber(probability)) return "not tested";
  if (probability < 0.0027) return "no: it is more";
  return `in ${number(100 * probability, 2)} % of cases`;
}

function pixels(value) {
  return `${number(value, 3)} px`;
}

/** What the data say of themselves: halves against each other, views held out, board's shape. */
function checksCard(camera, title) {
  const rows = [];
  const {split, residual_field: field, bending, stretch} = camera.checks ?? {};
  if (split) {
    rows.push(["difference of the two halves", "", chanceText(split.probability)],
              ["noise of the views that were fitted", pixels(split.in_sample_stddev_px)],
              ["noise of views held out", pixels(split.held_out_stddev_px)],
              ["noise to be expected of those", pixels(split.expected_held_out_stddev_px)]);
  }
  if (field) {
    rows.push(["residuals that depend on the place", pixels(field.systematic_rms_px),
               chanceText(field.probability)]);
  }
  if (bending) {
    rows.push(["bending of the board", `${number(1000 * bending.depth_m, 2)} mm`,
               chanceText(bending.probability)]);
  }
  if (stretch) {
    rows.push(["board longer along y than stated", `${number(100 * stretch.stretch, 2)} %`,
               chanceText(stretch.probability)]);
  }
  const note = "Each half of the views calibrates alone; then each predicts the other's corners.";
  if (rows.length === 0) return card(title, note, emptyNote("Nothing was cross-checked."));
  return card(title, note, table(["what", "how much", "by chance"],
                                 rows.map(([what, value, chance]) => [what, value, chance ?? ""])));
}

function cameraTitle(title, index, cameras) {
  return cameras.length > 1 ? `${title} of camera ${index}` : title;
}

function cameraSection(result) {
  const cameras = list(result.cameras);
  const made = element("div", {class: "cards"});
  if (cameras.length === 0) {
    made.append(wide(card("Parameters", "", emptyNote("No camera was calibrated."))));
  }
  for (const [index, camera] of cameras.entries()) {
    const parameters = card(cameraTitle("Parameters", index, cameras), "", cameraFacts(camera),
                            parameterTable(camera));
    parameters.classList.add("tall");
    made.append(parameters);
  }
  for (const [index, camera] of cameras.entries()) {
    made.append(checksCard(camera, cameraTitle("Cross-checks", index, cameras)));
  }
  if (cameras.length > 1) made.append(...rigCards(result));
  const correlation = correlationCard(result.covariance);
  made.append(coverageCard(result.coverage), informationCard(result.information),
              cameras.length > 1 ? wide(correlation) : correlation);
  const parts = [made];
  for (const [index, camera] of cameras.entries()) {
    const plots = result[index === 0 ? "plots" : `plots_cam${index}`];
    const cards = element("div", {class: "cards"});
    if (cameras.length > 1) parts.push(element("h3", {class: "part"}, `Camera ${index}`));
    if (plots) {
      cards.append(...viewCards(plots, camera));
    } else {
      const reason = emptyNote("The views were not handed over for drawing.");
      cards.append(wide(card("Views", "", reason)));
    }
    parts.push(cards);
  }
  return parts;
}
