// Noise of an IMU from a log of it at rest. What it is given: calibrato/diagnosis/noise_document.h.

function noiseSummary(result) {
  const warnings = list(result.warnings);
  return {
    verdict: warnings.length > 0 ? "warn" : "pass",
    tag: warnings.length > 0 ? "too short for some" : "all figures",
    line: warnings.length > 0 ? "The log is too short, or too broken, for some of the figures." :
                                "The log shows every figure of imu.yaml.",
    findings: warnings.map((what) => ({severity: "warn", what})),
  };
}

function figureText(sensor, key) {
  const value = number(sensor[key], 4);
  if (sensor[`${key}_is_upper_bound`]) return `below ${value} (95 %)`;
  return `${value} ± ${number(100 * sensor[`${key}_relative_sigma`], 2)} %`;
}

function noiseFigures(sensor, unit) {
  const axes = list(sensor.axes);
  const row = (name, key, of) => [
    name, of, ...axes.map((one) => one[key] > 0 ?
        (one[`${key}_is_upper_bound`] ? "below " : "") + number(one[key], 4) : "does not show"),
  ];
  return table(["figure", "all axes", "x", "y", "z"], [
    row(`noise density [${unit}/√Hz]`, "noise_density", figureText(sensor, "noise_density")),
    row(`random walk [${unit}/s/√Hz]`, "random_walk", figureText(sensor, "random_walk")),
    row(`bias instability [${unit}]`, "bias_instability", kNothing),
  ]);
}

/** What was measured with its uncertainty, and the lines that were fitted. */
function allanCard(sensor, title, unit) {
  const axes = list(sensor.axes);
  const build = () => {
    if (axes.length === 0) return "No Allan deviations were handed over.";
    const colours = [kBlue, kVermilion, kGreen];
    const data = axes.map((one, i) => ({
      type: "scatter", mode: "lines+markers", name: kAxisNames[i], x: one.tau_s, y: one.deviation,
      marker: {size: 4}, line: {color: colours[i], width: 1.5},
      error_y: {
        type: "data", array: one.deviation.map((y, k) => y * one.relative_sigma[k]),
        color: colours[i], thickness: 0.8, width: 0,
      },
      hovertemplate: `${kAxisNames[i]}, %{x:.3g} s: %{y:.3g}<extra></extra>`,
    }));
    const taus = axes[0].tau_s;
    const line = (name, dash, at) => data.push({
      type: "scatter", mode: "lines", name, x: taus, y: taus.map(at), hoverinfo: "skip",
      line: {color: kBlack, width: 1.2, dash},
    });
    const lowest = Math.min(...axes.flatMap((one) => one.deviation));
    const seen = (y) => y > lowest / 3 ? y : null;
    if (!sensor.noise_density_is_upper_bound) {
      line("white noise", "dash", (tau) => seen(sensor.noise_density / Math.sqrt(tau)));
    }
    if (!sensor.random_walk_is_upper_bound) {
      line("random walk", "dot", (tau) => seen(sensor.random_walk * Math.sqrt(tau / 3)));
    }
    return {
      data,
      layout: {
        xaxis: logAxis("averaged over [s]"),
        yaxis: axis(`Allan deviation [${unit}]`, {type: "log", exponentformat: "e"}),
      },
    };
  };
  return wide(card(title, `${number(sensor.duration_s, 5)} s at ${number(sensor.rate_hz, 4)} Hz. ` +
                       "Bars are one sigma; the lines are those of the figures for all axes.",
                   noiseFigures(sensor, unit), plot(build, {height: "460px"})));
}

function noiseSection(result) {
  const made = element("div", {class: "cards"});
  for (const imu of list(result.imus)) {
    made.append(allanCard(imu.gyro, `Gyroscope of ${imu.name}`, "rad/s"),
                allanCard(imu.accel, `Accelerometer of ${imu.name}`, "m/s²"));
  }
  return [made];
}
