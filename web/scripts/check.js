// The check of a recording before it is solved. What it is given:
// calibrato/diagnosis/check_document.h.

function checkSummary(result) {
  const verdict = result.verdict ?? "unknown";
  const lines = {
    pass: "Nothing speaks against calibrating with this recording.",
    warn: "This recording can be calibrated with; it could be better.",
    inconclusive: "This recording would leave something open.",
    fail: "A calibration with this recording can't be right.",
  };
  return {
    verdict,
    line: lines[verdict] ?? "This check carries no verdict.",
    findings: list(result.findings),
  };
}

function percent(share) {
  return isNumber(share) ? `${number(100 * share, 3)} %` : kNothing;
}

function streamsCard(streams) {
  const title = "Streams";
  if (streams.length === 0) return card(title, "", emptyNote("There is no stream with stamps."));
  const rows = streams.map((stream) => {
    const defects = [];
    const count = (n, words) => {
      if (n > 0) defects.push(`${number(n)} ${words}`);
    };
    count(stream.num_missing, "missing");
    count(stream.num_out_of_order, "out of order");
    count(stream.num_duplicates, "twice");
    count(stream.num_not_finite, "not finite");
    count(stream.num_saturated, "at the end of the range");
    count(list(stream.steps_back_s).length, "steps back of the clock");
    return [
      stream.name ?? "", number(stream.num), number(stream.duration_s, 4),
      number(stream.rate_hz, 4), number(1000 * stream.jitter_s, 2),
      stream.num_gaps > 0 ? `${number(stream.num_gaps)}, longest ${number(stream.longest_gap_s, 3)} s`
                          : "none",
      defects.length > 0 ? defects.join(", ") : "none", tag(stream.verdict, stream.verdict),
    ];
  });
  return card(title, "Rates are by the median interval; jitter is that of one stamp about when it " +
                         "was due.",
              table(["stream", "measurements", "seconds", "rate [Hz]", "jitter [ms]", "gaps",
                     "defects", "verdict"], rows));
}

function clocksCard(clocks) {
  const note = "How far an IMU's clock is ahead of a camera's, by when both turn; to a hundredth of " +
      "a second.";
  if (clocks.length === 0) {
    return card("Clocks and units", note,
                emptyNote("Without the motion of a camera and an IMU nothing can be compared."));
  }
  const rows = clocks.map((clock) => {
    const offsets = list(clock.pieces).map((piece) => piece.time_offset_s);
    const spread = offsets.length > 1 ?
        `${number(Math.min(...offsets), 2)} to ${number(Math.max(...offsets), 2)}` : kNothing;
    return [`${clock.imu} and ${clock.camera}`, number(clock.time_offset_s, 2), spread,
            number(clock.correlation, 4), number(clock.speed_ratio, 4)];
  });
  return card("Clocks and units", note + " Turning by the gyroscope over turning by the board is 1 " +
                  "in rad/s, 57 in degrees per second.",
              table(["between", "offset [s]", "over the recording [s]", "correlation",
                     "gyroscope over camera"], rows));
}

function checkedBoardCard(board) {
  const coverage = board.coverage ?? {};
  const uncovered = list(board.uncovered_parts);
  return card(`The board in ${board.camera}`, "Coverage is the share of what a calibration of the " +
                  "lens wants. Edges of 2 px are sharp.",
              facts([
                ["images with the board",
                 `${number(board.num_with_board)} of ${number(board.num_images)}`],
                ["longest time without it [s]", number(board.longest_away_s, 3)],
                ["coverage from left to right", percent(coverage.x)],
                ["coverage from top to bottom", percent(coverage.y)],
                ["coverage of sizes", percent(coverage.size)],
                ["coverage of tilts", percent(coverage.skew)],
                ["never covered", uncovered.length > 0 ? uncovered.join(", ") : "no part"],
                ["way along x, y, z of the board [m]", vectorText(board.travel_m, 2)],
                ["edges [px]", number(board.edge_width_px, 2)],
                ["black and white [of 255]",
                 isNumber(board.black) ? `${number(board.black, 3)} and ${number(board.white, 3)}`
                                       : ""],
                ["brightness of the images [of 255]", number(board.brightness, 3)],
              ]));
}

function checkedMotionCard(motion) {
  const rest = motion.rest;
  return card(`The motion of ${motion.imu}`, "Standard deviations about and along the IMU's axes; a " +
                  "tenth of a rad/s about each of them is a gentle start.",
              facts([
                ["turning about x, y, z [rad/s]", vectorText(motion.rates_rad_s, 2)],
                ["forces along x, y, z [m/s²]", vectorText(motion.forces_m_s2, 2)],
                ["median force [m/s²]", number(motion.median_force_m_s2, 4)],
                ["longest rest [s]", rest ? number(rest.duration_s, 2) : "less than a second"],
                ["gyroscope's noise then [rad/s/√Hz]", number(rest?.gyro_noise_density, 2)],
                ["accelerometer's noise then [m/s²/√Hz]", number(rest?.accel_noise_density, 2)],
              ]));
}

/** What a sigma is best said in. */
function sigmaUnit(name) {
  if (name.includes(".rot_")) return ["degrees", 180 / Math.PI];
  if (name.includes(".pos_")) return ["mm", 1000];
  if (name.includes("time_offset")) return ["ms", 1000];
  return /\.(fu|fv|pu|pv)$/.test(name) ? ["px", 1] : ["", 1];
}

function expectedCard(expected) {
  const title = "What this recording would tell";
  const note = "The sigma that each parameter would have after a calibration, by the information of " +
      "the poses that were seen.";
  if (expected.length === 0) {
    return wide(card(title, note,
                     emptyNote("Not known: it takes views of the board (--target), for extrinsics " +
                               "the IMU's noise as well (--imu), and a recording that can be right.")));
  }
  const rows = expected.map((parameter) => {
    const [unit, scale] = sigmaUnit(parameter.name);
    const isJudged = isNumber(parameter.enough);
    return [
      `${parameter.name}${unit ? ` [${unit}]` : ""}`,
      isNumber(parameter.sigma) ? number(scale * parameter.sigma, 2) : "does not show",
      isJudged ? number(scale * parameter.enough, 2) : kNothing,
      !isJudged ? "" : tag(parameter.verdict === "pass" ? "enough" : parameter.verdict,
                           parameter.verdict),
      parameter.advice ?? "",
    ];
  });
  return wide(card(title, note,
                   table(["parameter", "expected sigma", "enough", "verdict", "what to do"], rows)));
}

/** A line of steps with a break where more than three medians lie between two stamps. */
function withBreaks(times, values) {
  const steps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
  const longest = 3 * (steps[Math.floor(steps.length / 2)] ?? 0);
  const x = [], y = [];
  times.forEach((time, i) => {
    if (i > 0 && time - times[i - 1] > longest) {
      x.push(times[i - 1]);
      y.push(null);
    }
    x.push(time);
    y.push(values[i]);
  });
  return {x, y};
}

function visibilityCard(plots) {
  const build = () => {
    const cameras = list(plots.cameras).filter((camera) => list(camera.time_s).length > 0);
    if (cameras.length === 0) return "There are no images with stamps that were searched.";
    return {
      data: cameras.map((camera, i) => ({
        type: "scatter", mode: "lines", name: camera.name,
        ...withBreaks(camera.time_s, camera.num_corners),
        line: {color: kPalette[i % kPalette.length], width: 1.2, shape: "hv"},
        hovertemplate: `${camera.name}, %{x:.2f} s: %{y} corners<extra></extra>`,
      })),
      layout: {
        xaxis: axis("time [s]", {range: [0, plots.duration_s]}),
        yaxis: axis("corners found", {rangemode: "tozero"}),
      },
    };
  };
  return wide(card("When the board was seen", "At 0 an image was taken, and the board was not found " +
                       "in it; where the line is broken there are no images.", plot(build)));
}

function sharpnessCard(plots) {
  const build = () => {
    const cameras = list(plots.cameras).filter((camera) => list(camera.edge_time_s).length > 0);
    if (cameras.length === 0) return "No images with a board that has edges were looked at.";
    return {
      data: cameras.map((camera, i) => ({
        type: "scatter", mode: "lines+markers", name: camera.name, x: camera.edge_time_s,
        y: camera.edge_width_px, marker: {size: 4},
        line: {color: kPalette[i % kPalette.length], width: 1},
        hovertemplate: `${camera.name}, %{x:.2f} s: %{y:.1f} px<extra></extra>`,
      })),
      layout: {
        xaxis: axis("time [s]", {range: [0, plots.duration_s]}),
        yaxis: axis("width of edges [px]", {rangemode: "tozero"}),
      },
    };
  };
  return card("Blur over time", "Of some images, evenly chosen. Peaks at fast motion are motion " +
                  "blur; a high floor is a lens out of focus.", plot(build));
}

function cornersCard(camera) {
  const title = `Where ${camera.name} saw corners`;
  const corners = list(camera.corners);
  if (corners.length === 0 || list(camera.resolution).length !== 2) {
    return card(title, "", emptyNote("No corners were handed over."));
  }
  return card(title, "The lens will be known only where there are corners.",
              picture(camera.resolution, (pen) => {
                pen.context.globalAlpha = 0.4;
                pen.dots(corners, 1.5, () => kBlue);
              }, () => [["u [px]", "v [px]"], ...corners]));
}

function checkReadingsCard(title, unit, envelopes, duration) {
  const build = () => {
    if (list(envelopes).length !== 3) return "No samples were handed over.";
    return threeAxes(unit, duration, (i) => [{
      name: "measured", ...zigzag(envelopes[i]), line: {color: kBlue, width: 1},
      hovertemplate: "%{x:.2f} s: %{y:.4g}<extra></extra>",
    }]);
  };
  return wide(card(title, "", plot(build, {height: "420px"})));
}

function checkIntervalsCard(plots) {
  const build = () => {
    const streams = list(plots.intervals).filter((stream) => stream.median_ms > 0);
    if (streams.length === 0) return "No intervals were handed over.";
    return {
      data: streams.map((stream, i) => ({
        type: "scatter", mode: "lines",
        name: `${stream.name}, median ${number(stream.median_ms, 4)} ms`,
        ...zigzag(stream.interval_ms, 1 / stream.median_ms),
        line: {color: kPalette[i % kPalette.length], width: 1.5},
        hovertemplate: `${stream.name}, %{x:.2f} s: %{y:.3g} intervals<extra></extra>`,
      })),
      layout: {
        xaxis: axis("time [s]", {range: [0, plots.duration_s]}),
        yaxis: axis("interval over its median", {rangemode: "tozero"}),
      },
    };
  };
  return card("Intervals between measurements",
              "At 1, stamps are even; at 2 one measurement is missing.", plot(build));
}

function checkSection(result) {
  const made = element("div", {class: "cards"});
  made.append(wide(streamsCard(list(result.streams))), expectedCard(list(result.expected)));
  for (const board of list(result.boards)) made.append(checkedBoardCard(board));
  for (const motion of list(result.motions)) made.append(checkedMotionCard(motion));
  made.append(clocksCard(list(result.clocks)));
  const plots = result.plots;
  if (!plots) {
    made.append(wide(card("Time lines", "", emptyNote("Nothing was handed over for drawing."))));
    return [made];
  }
  const duration = plots.duration_s ?? 1;
  made.append(checkIntervalsCard(plots));
  if (list(plots.cameras).length > 0) {
    made.append(visibilityCard(plots));
    if (plots.cameras.some((camera) => list(camera.edge_time_s).length > 0)) {
      made.append(sharpnessCard(plots));
    }
    for (const camera of list(plots.cameras)) made.append(cornersCard(camera));
  }
  for (const imu of list(plots.imus)) {
    made.append(checkReadingsCard(`Rates of ${imu.name}`, "[rad/s]", imu.gyro, duration),
                checkReadingsCard(`Forces of ${imu.name}`, "[m/s²]", imu.accel, duration));
  }
  return [made];
}
