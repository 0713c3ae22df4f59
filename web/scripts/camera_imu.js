// A camera-IMU calibration: what is known of each number, and what it rests on. What it is given:
// calibrato/report/report.h.

const kAxisNames = ["x", "y", "z"];

function cameraImuSummary(result) {
  const verdict = result.verdict ?? "unknown";
  const details = [];
  if (result.termination) details.push(`Solver: ${result.termination}`);
  const residuals = result.residuals ?? {};
  if (isNumber(residuals.reprojection_rms_px)) {
    const rms = number(residuals.reprojection_rms_px, 3);
    details.push(`reprojection error ${rms} px root mean square`);
  }
  for (const [name, key] of [["gyroscope", "gyro"], ["accelerometer", "accel"]]) {
    const ratio = residuals[`${key}_normalised`];
    if (isNumber(ratio)) {
      details.push(`${name} residuals ${number(ratio, 3)} times the stated noise`);
    }
  }
  return {
    verdict,
    line: kVerdictLines[verdict] ?? "This result carries no verdict.",
    details: details.length > 0 ? `${details.join("; ")}.` : "",
    findings: list(result.findings),
  };
}

/** Rows of one quantity along three axes, each with its own verdict. */
function axisRows(name, unit, values, sigmas, verdicts, scale) {
  return kAxisNames.map((axisName, i) => {
    const sigma = isNumber(list(sigmas)[i]) ? scale * sigmas[i] : null;
    const verdict = list(verdicts)[i] ?? "unknown";
    return [`${name} ${axisName} [${unit}]`, withSigma(values[i], sigma),
            sigma === null ? "not observable" : number(sigma, 2), tag(verdict, verdict)];
  });
}

function extrinsicsCard(camera, title) {
  const note = "T_cam_imu maps the IMU's coordinates to the camera's. The time offset is added " +
      "to the camera's stamps.";
  if (!isPose(camera.T_cam_imu)) return wide(card(title, note, emptyNote("There is no estimate.")));
  const degrees = 180 / Math.PI;
  const verdicts = camera.verdicts ?? {};
  const rows = [
    ...axisRows("rotation", "degrees", rotationVector(camera.T_cam_imu), camera.rotation_sigma_rad,
                verdicts.rotation, degrees),
    ...axisRows("translation", "mm", camera.T_cam_imu.slice(0, 3).map((row) => 1000 * row[3]),
                camera.translation_sigma_m, verdicts.translation, 1000),
  ];
  if (isNumber(camera.time_offset_s)) {
    const sigma = isNumber(camera.time_offset_sigma_s) ? 1000 * camera.time_offset_sigma_s : null;
    rows.push(["time offset [ms]", withSigma(1000 * camera.time_offset_s, sigma),
               verdicts.time_offset ? number(sigma, 2) : "held",
               verdicts.time_offset ? tag(verdicts.time_offset, verdicts.time_offset) : ""]);
  }
  const matrix = element("details", {}, element("summary", {}, "As a matrix"),
                         element("pre", {}, camera.T_cam_imu.map((row) => {
                           return row.map((x) => x.toFixed(8).padStart(12)).join(" ");
                         }).join("\n")));
  const prediction = camera.prediction_error_px;
  const expected = isNumber(prediction)
      ? element("p", {class: "note"},
                `Whoever predicts pixels from this, turning at 1 rad/s, errs by ` +
                    `${number(prediction, 2)} px (root mean square over the image, points at ` +
                    `0.5 m, 2 m and infinity, and all directions of turning), if the covariance ` +
                    `tells the truth.`)
      : "";
  return card(title, note, table(["parameter", "value", "one sigma", "verdict"], rows), expected,
              matrix);
}

function splitCard(camera, title) {
  const note = "Each half of the recording, calibrated alone: how far the two are apart.";
  const split = camera.split;
  if (!split) return card(title, note, emptyNote("The halves do not determine the result alone."));
  const units = [180 / Math.PI, 180 / Math.PI, 180 / Math.PI, 1000, 1000, 1000, 1000];
  const names = [...kAxisNames.map((name) => `rotation ${name} [degrees]`),
                 ...kAxisNames.map((name) => `translation ${name} [mm]`), "time offset [ms]"];
  const rows = list(split.difference_rad_m_s).map((difference, i) => {
    const sigma = list(split.sigma_rad_m_s)[i];
    return [names[i], withSigma(units[i] * difference, units[i] * sigma),
            number(units[i] * sigma, 2),
            sigma > 0 ? number(Math.abs(difference) / sigma, 2) : kNothing];
  });
  const chance = `As large by chance: ${chanceText(split.probability)}.`;
  return card(title, note, table(["parameter", "difference", "one sigma", "sigmas"], rows),
              element("p", {class: "note"}, chance));
}

function vectorText(vector, digits) {
  const numbers = list(vector);
  return numbers.length === 3 ? numbers.map((x) => number(x, digits)).join(", ") : "";
}

/** Each with as many digits as its sigma can bear, and the sigmas in brackets. */
function vectorWithSigmas(vector, sigmas) {
  if (list(sigmas).length !== 3) return vectorText(vector, 3);
  const values = list(vector).map((x, i) => withSigma(x, sigmas[i]));
  return `${values.join(", ")} (± ${vectorText(sigmas, 2)})`;
}

/** What was used and, in brackets, what was stated. */
function noiseText(imu, key) {
  if (!isNumber(imu.noise?.[key])) return "";
  return `${number(imu.noise[key], 3)} (${number(imu.stated_noise?.[key], 3)})`;
}

function imuCard(imu, title) {
  return card(title, "Biases are means over the recording; residuals are of one axis.", facts([
    ["model", imu.model ?? ""],
    ["gyroscope bias [rad/s]", vectorWithSigmas(imu.gyro_bias, imu.gyro_bias_sigma)],
    ["accelerometer bias [m/s²]", vectorWithSigmas(imu.accel_bias, imu.accel_bias_sigma)],
    ["gyroscope residuals [rad/s]", number(imu.gyro?.rms, 3)],
    ["... over stated noise", number(imu.gyro?.normalised, 3)],
    ["accelerometer residuals [m/s²]", number(imu.accel?.rms, 3)],
    ["... over stated noise", number(imu.accel?.normalised, 3)],
    ["gyroscope samples left out", number(imu.gyro?.num_outliers)],
    ["accelerometer samples left out", number(imu.accel?.num_outliers)],
    ["gyroscope noise density (stated)", noiseText(imu, "gyro_noise_density")],
    ["accelerometer noise density (stated)", noiseText(imu, "accel_noise_density")],
  ]));
}

/** The IMU as its data sheet has it, beside one with scale and misaligned axes. */
function imuModelsCard(models) {
  const title = "Which model of the IMU";
  if (!models) return card(title, "", emptyNote("The motion does not tell the models apart."));
  const used = (name) => name === models.used ? "in use" : "";
  const rows = [
    [models.simple ?? "", "0", "0", "0", used(models.simple)],
    [models.richer ?? "", number(models.degrees), number(models.squared_residuals_fall, 3),
     number(models.qaic_change, 3), used(models.richer)],
  ];
  const moves = list(models.change_rad_m).map((change, n) => {
    const scaled = list(change).map((x, i) => number((i < 3 ? 180 / Math.PI : 1000) * x, 2));
    return [`cam${n}`, scaled.slice(0, 3).join(", "), scaled.slice(3).join(", ")];
  });
  return card(title,
              "Both on this recording, by one linearisation. Likelihoods are those of residuals " +
                  "over the noise, scaled as the sigmas are. A QAIC below zero speaks for the " +
                  "richer model.",
              table(["model", "further parameters", "2 ln of the likelihood gained", "QAIC", ""],
                    rows),
              element("p", {class: "note"},
                      `By chance alone? ${capitalised(chanceText(models.probability))}. From the ` +
                          `first model's result to the second's the extrinsics move by:`),
              table(["", "rotation x, y, z [degrees]", "translation x, y, z [mm]"], moves));
}

function solutionCard(result) {
  const information = result.information ?? {};
  return card("Information and gravity",
              "What the recording says of camera 0's rotation and translation, in units of " +
                  "1 mrad and 1 mm; smaller is better.",
              facts([
                ["A-optimality (trace)", number(information.a_optimality, 3)],
                ["D-optimality (determinant)", number(information.d_optimality, 3)],
                ["E-optimality (largest eigenvalue)", number(information.e_optimality, 3)],
                ["eigenvalues",
                 list(information.eigenvalues).map((x) => number(x, 2)).join(", ")],
                ["gravity in the board's frame [m/s²]", vectorText(result.gravity_g, 5)],
                ["knots of the trajectory [ms]", number(1000 * result.knot_spacing_s, 3)],
                ["change with knots twice as dense [sigmas]",
                 number(result.change_with_finer_knots, 2)],
                ["iterations", number(result.num_iterations)],
              ]));
}

/** An envelope as one line that runs from each piece's least to its largest value. */
function zigzag(envelope, scale = 1) {
  const x = [];
  const y = [];
  for (const [i, time] of list(envelope?.time_s).entries()) {
    x.push(time);
    y.push(scale * envelope.low[i]);
    if (envelope.high[i] !== envelope.low[i]) {
      x.push(time);
      y.push(scale * envelope.high[i]);
    }
  }
  return {x, y};
}

/** Three plots, one an axis, above each other in one; of each, the traces that `tracesOf` makes. */
function threeAxes(unit, duration, tracesOf) {
  const data = [];
  const layout = {
    xaxis: axis("time [s]", {range: [0, duration], anchor: "y"}),
    hovermode: "closest",
    legend: {orientation: "h", x: 0, y: 1.02, yanchor: "bottom"},
  };
  for (const [i, name] of kAxisNames.entries()) {
    const yaxis = i === 2 ? "y" : `y${i + 2}`;
    const low = (2 - i) * 0.345;
    layout[`yaxis${yaxis.slice(1)}`] = axis(`${name} ${unit}`, {
      domain: [low, low + 0.31], nticks: 5, exponentformat: "e",
    });
    for (const trace of tracesOf(i)) {
      data.push({type: "scatter", mode: "lines", yaxis, showlegend: i === 0, ...trace});
    }
  }
  return {data, layout};
}

function readingsCard(title, unit, sensor, duration) {
  const build = () => {
    if (list(sensor?.measured).length !== 3) return "No samples were handed over.";
    const outliers = list(sensor.outliers);
    return threeAxes(unit, duration, (i) => {
      const traces = [
        {name: "measured", ...zigzag(sensor.measured[i]), line: {color: kGrey, width: 1.5},
         hovertemplate: `%{x:.2f} s: measured %{y:.4g}<extra></extra>`},
        {name: "predicted", ...zigzag(sensor.predicted[i]), line: {color: kBlue, width: 1},
         hovertemplate: `%{x:.2f} s: predicted %{y:.4g}<extra></extra>`},
      ];
      if (outliers.length > 0) {
        traces.push({
          name: "left out", mode: "markers", x: outliers.map((row) => row[0]),
          y: outliers.map((row) => row[1 + i]), marker: {color: kVermilion, symbol: "x", size: 7},
          hovertemplate: "%{x:.3f} s: left out, %{y:.4g}<extra></extra>",
        });
      }
      return traces;
    });
  };
  return wide(card(title, "Long recordings are drawn from the least to the largest value of each " +
                              "short span, so that nothing that stands out is lost.",
                   plot(build, {height: "480px"})));
}

function residualsCard(title, unit, sensor, duration) {
  const build = () => {
    if (list(sensor?.residual).length !== 3) return "No residuals were handed over.";
    const band = 3 * sensor.stddev;
    const {data, layout} = threeAxes(unit, duration, (i) => [
      {name: "predicted - measured", ...zigzag(sensor.residual[i]),
       line: {color: kBlue, width: 1},
       hovertemplate: "%{x:.2f} s: %{y:.3g}<extra></extra>"},
      {name: "3 sigmas of the stated noise", x: [0, duration, null, 0, duration],
       y: [band, band, null, -band, -band], line: {color: kVermilion, width: 1.5, dash: "dash"},
       hoverinfo: "skip"},
    ]);
    // A spike that was left out would make a line of all the others.
    for (const yaxis of ["yaxis", "yaxis2", "yaxis3"]) {
      layout[yaxis].range = [-3 * band, 3 * band];
    }
    return {data, layout};
  };
  return wide(card(title, "Within the dashed lines but for a few in a thousand, and without a " +
                              "pattern, if the noise is as stated. What is beyond nine sigmas is " +
                              "cut off; a double click shows it.",
                   plot(build, {height: "440px"})));
}

/** Biases beside what the stated random walk lets them do, from where they began. */
function biasCard(title, unit, times, biases, walk, duration) {
  const build = () => {
    if (list(biases).length === 0) return "No biases were handed over.";
    const edge = Array.from({length: 41}, (_, k) => duration * k / 40);
    return threeAxes(unit, duration, (i) => {
      const start = biases[0][i];
      const bound = (sign) => edge.map((t) => start + sign * 3 * walk * Math.sqrt(t));
      return [
        {name: "bias", x: times, y: biases.map((bias) => bias[i]),
         line: {color: kBlue, width: 2}, hovertemplate: "%{x:.2f} s: %{y:.4g}<extra></extra>"},
        {name: "3 sigmas of the stated random walk", x: [...edge, null, ...edge],
         y: [...bound(1), null, ...bound(-1)], line: {color: kVermilion, width: 1.5, dash: "dash"},
         hoverinfo: "skip"},
      ];
    });
  };
  return card(title, "", plot(build, {height: "400px"}));
}

function cornerScatterCard(camera, sigma, duration, title) {
  const build = () => {
    const rows = list(camera.corner_residuals);
    if (rows.length === 0) return "No corner residuals were handed over.";
    const circle = Array.from({length: 91}, (_, k) => 2 * Math.PI * k / 90);
    const bound = 1.15 * Math.max(3 * sigma, ...rows.map((row) => Math.hypot(row[1], row[2])));
    const both = {range: [-bound, bound], zeroline: true};
    return {
      data: [{
        type: "scatter", mode: "markers",
        x: rows.map((row) => row[1]), y: rows.map((row) => row[2]),
        text: rows.map((row) => `${number(row[0], 4)} s`), showlegend: false,
        hovertemplate: "%{text}: %{x:.3f}, %{y:.3f} px<extra></extra>",
        marker: {size: 4, color: rows.map((row) => row[0]), colorscale: "Cividis", cmin: 0,
                 cmax: duration, showscale: true, colorbar: colourBar("time [s]")},
      }, {
        type: "scatter", mode: "lines", x: circle.map((a) => 3 * sigma * Math.cos(a)),
        y: circle.map((a) => 3 * sigma * Math.sin(a)), showlegend: false, hoverinfo: "skip",
        line: {color: kVermilion, width: 1.5, dash: "dash"},
      }],
      layout: {
        xaxis: axis("du [px]", {...both, constrain: "domain"}),
        yaxis: axis("dv [px]", {...both, scaleanchor: "x", constrain: "domain"}),
      },
    };
  };
  return card(title, "Up to 1500 corners, coloured by time; the circle is three sigmas of the " +
                         "corners' noise. One colour off to a side is a time at which something " +
                         "was wrong.",
              plot(build, {height: "440px"}));
}

function viewErrorCard(camera, duration, title) {
  const build = () => {
    const line = zigzag(camera.rms);
    if (line.x.length === 0) return "No reprojection errors were handed over.";
    return {
      data: [{type: "scatter", mode: "lines", ...line, line: {color: kBlue, width: 1.2},
              hovertemplate: "%{x:.2f} s: %{y:.3f} px<extra></extra>"}],
      layout: {
        xaxis: axis("time [s]", {range: [0, duration]}),
        yaxis: axis("root mean square [px]", {rangemode: "tozero"}),
      },
    };
  };
  return card(title, "Of each image, over its corners that fit.", plot(build, {height: "440px"}));
}

/** How evenly each sensor took its measurements: intervals over their median. */
function jitterCard(plots, duration) {
  const sensors = [];
  for (const [n, imu] of list(plots.imus).entries()) {
    sensors.push([`imu${n} gyroscope`, imu.gyro], [`imu${n} accelerometer`, imu.accel]);
  }
  for (const [n, camera] of list(plots.cameras).entries()) sensors.push([`cam${n}`, camera]);
  const build = () => {
    const known = sensors.filter(([, sensor]) => sensor?.median_interval_ms > 0);
    if (known.length === 0) return "No intervals were handed over.";
    return {
      data: known.map(([name, sensor], i) => ({
        type: "scatter", mode: "lines",
        name: `${name}, median ${number(sensor.median_interval_ms, 4)} ms`,
        ...zigzag(sensor.interval_ms, 1 / sensor.median_interval_ms),
        line: {color: kPalette[i % kPalette.length], width: 1.5},
        hovertemplate: `${name}, %{x:.2f} s: %{y:.3g} intervals<extra></extra>`,
      })),
      layout: {
        xaxis: axis("time [s]", {range: [0, duration]}),
        yaxis: axis("interval over its median", {rangemode: "tozero"}),
      },
    };
  };
  return card("Intervals between measurements",
              "At 1, stamps are even; at 2 one measurement is missing.", plot(build));
}

function knowledgeCard(knowledge) {
  const build = () => {
    const times = list(knowledge?.time_s);
    if (times.length === 0) return "No information over time was handed over.";
    const line = (name, values, scale, colour) => ({
      type: "scatter", mode: "lines+markers", name, x: times,
      y: list(values).map((x) => isNumber(x) ? scale * x : null), line: {color: colour, width: 2},
      hovertemplate: `${name}: %{y:.3g} after %{x:.1f} s<extra></extra>`,
    });
    return {
      data: [
        line("rotation [degrees]", knowledge.rotation_sigma_rad, 180 / Math.PI, kVermilion),
        line("translation [mm]", knowledge.translation_sigma_m, 1000, kBlue),
        line("time offset [ms]", knowledge.time_offset_sigma_s, 1000, kGreen),
      ],
      layout: {xaxis: axis("recorded [s]", {rangemode: "tozero"}), yaxis: logAxis("one sigma")},
    };
  };
  return card("What was known after so many seconds",
              "Root sums of squares over the three axes of camera 0. Where the lines are flat, " +
                  "more of the same motion helps little.",
              plot(build));
}

function trajectoryCard(plots) {
  const path = list(plots.trajectory_g);
  const build = () => {
    if (path.length === 0) return "No trajectory was handed over.";
    const axes = opticalAxes({axis_b: plots.axis_g}, path, 0.25 * extent(path));
    const outline = list(plots.board_outline_g);
    const duration = plots.duration_s ?? path.length;
    const times = path.map((_, i) => duration * i / (path.length - 1));
    const data = [{
      type: "scatter3d", mode: "lines", ...polylines([path]), showlegend: false,
      line: {width: 4, color: [...times, 0], colorscale: "Cividis", cmin: 0, cmax: duration,
             colorbar: {...colourBar("time [s]"), y: 1, yanchor: "top"}},
      text: times.map((t) => `${number(t, 4)} s`),
      hovertemplate: "%{text}: %{x:.3f}, %{y:.3f}, %{z:.3f} m<extra></extra>",
    }, {
      type: "scatter3d", mode: "lines", ...polylines(axes), showlegend: false, opacity: 0.5,
      line: {width: 2, color: kGrey}, hovertemplate: "camera 0 looks this way<extra></extra>",
    }];
    if (outline.length > 0) {
      data.push({
        type: "scatter3d", mode: "lines", ...polylines([[...outline, outline[0]]]),
        showlegend: false, line: {width: 6, color: kBlack}, hovertemplate: "board<extra></extra>",
      });
    }
    return {
      data,
      layout: {
        margin: {l: 0, r: 0, t: 0, b: 0},
        scene: scene(["x [m]", "y [m]", "z [m]"], [1.1, -1.3, 1.1], data),
      },
    };
  };
  return wide(card("The trajectory in the board's frame",
                   "Path of the IMU, coloured by time; thin lines show where camera 0 looks.",
                   plot(build, {height: kNarrow ? "380px" : "560px"})));
}

/** At most so many are listed; result.json has all. */
const kLeftOutToList = 500;

/** Folded away: names, where there are any, with their times as far as those are known; or times. */
function whichWereLeftOut(names, times) {
  const texts = list(names ?? times).map((_, i) => {
    const at = isNumber(list(times)[i]) ? `${times[i].toFixed(3)} s` : "";
    if (!names) return at;
    return at ? `${names[i]} (${at})` : names[i];
  });
  if (texts.length === 0) return kNothing;
  const more = texts.length - kLeftOutToList;
  const shown = texts.slice(0, kLeftOutToList).join(", ") +
      (more > 0 ? `, and ${more} more in result.json` : "");
  return element("details", {class: "names"}, element("summary", {}, names ? "names" : "when"),
                 shown);
}

function cameraImuLeftOutCard(result) {
  const rows = [];
  for (const [n, camera] of list(result.cameras).entries()) {
    const names = list(camera.rejected_views);
    if (names.length > 0) {
      rows.push([`cam${n}: images that do not fit`, number(names.length),
                 whichWereLeftOut(names, camera.rejected_view_times_s)]);
    }
    if (camera.num_outliers > 0) {
      rows.push([`cam${n}: corners that do not fit`, number(camera.num_outliers), kNothing]);
    }
  }
  for (const [n, imu] of list(result.imus).entries()) {
    for (const [name, key] of [["gyroscope", "gyro"], ["accelerometer", "accel"]]) {
      const count = imu[key]?.num_outliers;
      if (count > 0) {
        rows.push([`imu${n}: samples of the ${name}`, number(count),
                   whichWereLeftOut(null, imu[key].outlier_times_s)]);
      }
    }
  }
  const title = "What was left out";
  if (rows.length === 0) return card(title, "", emptyNote("Nothing was left out."));
  return card(title, "Times are seconds from the trajectory's beginning; result.json has the " +
                         "stamps as well.",
              table(["what", "how many", "which"], rows));
}

function cameraImuSection(result) {
  const cameras = list(result.cameras);
  const imus = list(result.imus);
  const made = element("div", {class: "cards"});
  if (cameras.length === 0) {
    made.append(wide(card("Extrinsics", "", emptyNote("There is no estimate."))));
    return [made];
  }
  for (const [n, camera] of cameras.entries()) {
    made.append(extrinsicsCard(camera, `Camera ${n} and the IMU`),
                splitCard(camera, cameraTitle("Two halves", n, cameras)));
  }
  for (const [n, imu] of imus.entries()) {
    made.append(imuCard(imu, imus.length > 1 ? `IMU ${n}` : "The IMU"));
  }
  made.append(solutionCard(result), imuModelsCard(result.imu_models));
  const plots = result.plots;
  if (!plots) {
    made.append(wide(card("Pictures", "", emptyNote("Nothing was handed over for drawing."))));
    return [made];
  }
  const duration = plots.duration_s ?? 1;
  made.append(knowledgeCard(plots.knowledge), jitterCard(plots, duration), trajectoryCard(plots));
  for (const [n, imu] of list(plots.imus).entries()) {
    const of = list(plots.imus).length > 1 ? ` of IMU ${n}` : "";
    made.append(
        readingsCard(`Rates${of}: predicted and measured`, "[rad/s]", imu.gyro, duration),
        residualsCard(`Residuals of the rates${of}`, "[rad/s]", imu.gyro, duration),
        readingsCard(`Forces${of}: predicted and measured`, "[m/s²]", imu.accel, duration),
        residualsCard(`Residuals of the forces${of}`, "[m/s²]", imu.accel, duration),
        biasCard(`Bias of the gyroscope${of}`, "[rad/s]", imu.bias_time_s, imu.gyro_bias,
                 imu.gyro_walk, duration),
        biasCard(`Bias of the accelerometer${of}`, "[m/s²]", imu.bias_time_s, imu.accel_bias,
                 imu.accel_walk, duration));
  }
  for (const [n, camera] of list(plots.cameras).entries()) {
    made.append(cornerScatterCard(camera, plots.corner_noise_px ?? 0, duration,
                                  cameraTitle("Corner residuals", n, cameras)),
                viewErrorCard(camera, duration,
                              cameraTitle("Reprojection error over time", n, cameras)));
  }
  made.append(wide(correlationCard(result.covariance)), wide(cameraImuLeftOutCard(result)));
  return [made];
}
