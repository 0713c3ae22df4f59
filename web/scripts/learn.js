// What training did: did the return rise, did the networks learn, can their predictions be trusted.

const kRunningWindow = 20;

function learnSummary(result) {
  const training = episodesOf(list(result.training));
  const details = [];
  if (isNumber(result.calibrations)) details.push(`${number(result.calibrations)} calibrations`);
  if (isNumber(result.information_evaluations)) {
    details.push(`${number(result.information_evaluations)} evaluations of the information`);
  }
  const refused = training.filter((line) => line.refused > 0).length;
  if (refused > 0) details.push(`refused actions in ${counted(refused, "episode", "episodes")}`);
  const best = isNumber(result.best_return) ? `best return ${number(result.best_return, 4)}`
                                            : "no return is stated";
  const over = isNumber(result.episodes) ? ` over ${number(result.episodes)} episodes` : "";
  return {
    verdict: result.verdict ?? "learned",
    line: `${capitalised(best)}${over}.`,
    also: result.termination_text ? [`${capitalised(result.termination_text)}.`] : [],
    details: details.length > 0 ? `${capitalised(details.join(", "))}.` : "",
    findings: list(result.findings),
  };
}

/** Lines of episodes; where training went back to a checkpoint there is a line of another kind. */
function episodesOf(training) {
  return training.filter((line) => line.kind !== "rollback");
}

/** Dashed uprights where a later stage of training begins. */
function stageShapes(training) {
  const shapes = [];
  let stage = training.find((line) => line.stage)?.stage;
  for (const line of training) {
    if (!line.stage || line.stage === stage) continue;
    stage = line.stage;
    shapes.push({
      type: "line", yref: "paper", y0: 0, y1: 1, x0: line.episode - 0.5, x1: line.episode - 0.5,
      line: {color: kBlack, dash: "dot", width: 1},
    });
  }
  return shapes;
}

/** Of the last few values that exist; null where there are none yet. */
function runningMean(values) {
  const recent = [];
  return values.map((value) => {
    if (isNumber(value)) recent.push(value);
    if (recent.length > kRunningWindow) recent.shift();
    return recent.length === 0 ? null : recent.reduce((sum, x) => sum + x, 0) / recent.length;
  });
}

/** Dots of the training episodes, their running mean, and the tests as a line. */
function episodeTraces(training, valueOf) {
  const data = [];
  const add = (kinds, trace) => {
    const lines = training.filter((line) => kinds(line.kind) && isNumber(valueOf(line)));
    if (lines.length === 0) return;
    data.push({
      type: "scatter", x: lines.map((line) => line.episode), y: lines.map(valueOf),
      hovertemplate: `${trace.name}, episode %{x}: %{y:.4g}<extra></extra>`, ...trace,
    });
  };
  add((kind) => kind === "random", {
    name: "random", mode: "markers", marker: {color: kOrange, size: 4, opacity: 0.6},
  });
  add((kind) => kind !== "random" && kind !== "test", {
    name: "training", mode: "markers", marker: {color: kSkyBlue, size: 4, opacity: 0.6},
  });
  const lines = training.filter((line) => line.kind !== "test" && isNumber(valueOf(line)));
  if (lines.length > 1) {
    data.push({
      type: "scatter", mode: "lines", name: "mean of the last 20",
      x: lines.map((line) => line.episode), y: runningMean(lines.map(valueOf)),
      line: {color: kBlue, width: 2.5}, hovertemplate: "mean: %{y:.4g}<extra></extra>",
    });
  }
  add((kind) => kind === "test", {
    name: "test", mode: "lines+markers", line: {color: kVermilion, width: 2}, marker: {size: 6},
  });
  return data;
}

function episodeCard(training, title, note, yAxis, valueOf) {
  const build = () => {
    const data = episodeTraces(training, valueOf);
    if (data.length === 0) return "The training has no such numbers.";
    return {data, layout: {xaxis: axis("episode"), yaxis: yAxis, shapes: stageShapes(training)}};
  };
  return card(title, note, plot(build));
}

/** Lines over the played episodes, one a name, each a running mean. */
function meanLinesCard(training, title, note, yAxis, valuesOf, names) {
  const build = () => {
    const lines = training.filter((line) => line.kind !== "test");
    const data = [];
    for (const [i, name] of names.entries()) {
      const values = lines.map((line) => valuesOf(line, name));
      if (!values.some(isNumber)) continue;
      data.push({
        type: "scatter", mode: "lines", name: plotText(name.replace(/_/g, " ")),
        x: lines.map((line) => line.episode), y: runningMean(values),
        line: {color: kPalette[i % kPalette.length], width: 2},
        hovertemplate: `${plotText(name)}, episode %{x}: %{y:.4g}<extra></extra>`,
      });
    }
    if (data.length === 0) return "The training has no such numbers.";
    return {data, layout: {xaxis: axis("episode"), yaxis: yAxis, shapes: stageShapes(training)}};
  };
  return card(title, note, plot(build));
}

/** How far the search came in the first step of some episodes, from its first round to its last. */
function convergenceCard(training) {
  const kCurves = 7;
  const build = () => {
    const lines = training.filter((line) => list(line.best_so_far).length > 1);
    const count = Math.min(kCurves, lines.length);
    const chosen = Array.from({length: count}, (_, i) =>
      lines[count === 1 ? 0 : Math.round(i * (lines.length - 1) / (count - 1))]);
    const data = chosen.map((line, i) => ({
      type: "scatter", mode: "lines+markers", name: `episode ${line.episode}`,
      x: line.best_so_far.map((_, k) => k), y: line.best_so_far,
      line: {color: kPalette[i % kPalette.length], width: 2}, marker: {size: 5},
      hovertemplate: `episode ${line.episode}, round %{x}: %{y:.4g}<extra></extra>`,
    }));
    return {data, layout: {xaxis: axis("round of the search", {dtick: 1}),
                           yaxis: axis("best predicted return so far")}};
  };
  return card("Convergence of the search",
              "What the planner promised itself at the first loop, in episodes spread over the run. " +
              "Flat lines: it found nothing better than it began with.", plot(build));
}

/** Where training went back to its last checkpoint, and why. */
function rollbackCard(rollbacks) {
  const rows = rollbacks.map((line) => [
    `episode ${number(line.diverged_at_episode)}`,
    `${line.why ?? "diverged"}: back to episode ${number(line.episode)}, ` +
    `on with learning rate ${number(line.learning_rate, 2)}`,
  ]);
  return card("Returns to the last checkpoint", "Training had diverged.", facts(rows));
}

function predictionCard(training) {
  const build = () => {
    const lines = training.filter((line) => isNumber(line.predicted_return) &&
                                            isNumber(line.return));
    if (lines.length === 0) return "No return was predicted.";
    const values = lines.flatMap((line) => [line.predicted_return, line.return]);
    const ends = [Math.min(...values), Math.max(...values)];
    const dots = (name, kept, colour) => ({
      type: "scatter", mode: "markers", name,
      x: kept.map((line) => line.predicted_return), y: kept.map((line) => line.return),
      text: kept.map((line) => `episode ${line.episode}`), marker: {color: colour, opacity: 0.7},
      hovertemplate: "%{text}: predicted %{x:.4g}, realised %{y:.4g}<extra></extra>",
    });
    return {
      data: [
        dots("training", lines.filter((line) => line.kind !== "test"), kSkyBlue),
        dots("test", lines.filter((line) => line.kind === "test"), kVermilion),
        {
          type: "scatter", mode: "lines", name: "as predicted", x: ends, y: ends,
          line: {color: kBlack, dash: "dash", width: 1.5}, hoverinfo: "skip",
        },
      ].filter((trace) => trace.x.length > 0),
      layout: {xaxis: axis("predicted return"), yaxis: axis("realised return")},
    };
  };
  return card("Predicted and realised return",
              "Below the dashed line more was promised than came.", plot(build));
}

function learnSection(result) {
  const training = episodesOf(list(result.training));
  const rollbacks = list(result.training).filter((line) => line.kind === "rollback");
  const made = element("div", {class: "cards"});
  made.append(wide(card("In short", "", facts([
    ["task", result.task ?? ""],
    ["preset", result.preset ?? ""],
    ["planner", result.planner ?? ""],
    ...(result.mistakes && result.mistakes !== "none"
        ? [["mistakes of the original, on purpose", result.mistakes]] : []),
    ["episodes", number(result.episodes)],
    ["calibrations", number(result.calibrations)],
    ["evaluations of the information", number(result.information_evaluations)],
    ["best return", number(result.best_return, 5)],
  ]))));
  if (training.length === 0) {
    const reason = emptyNote("No episode of the training was handed over.");
    made.append(wide(card("Training", "", reason)));
  } else {
    const terms = [...new Set(training.flatMap((line) => Object.keys(line.terms ?? {})))];
    made.append(
        wide(episodeCard(training, "Return of each episode",
                         "The sum of rewards. Tests are played without exploration.",
                         axis("return"), (line) => line.return)),
        meanLinesCard(training, "Terms of the reward",
                      "What the return is made of, as the mean of the last 20 episodes.",
                      axis("sum over an episode"), (line, name) => line.terms?.[name], terms),
        episodeCard(training, "Error at the end of each episode",
                    "Error of the calibration, relative to the true parameters.",
                    logAxis("relative error [1]"), (line) => line.final_relative_error),
        predictionCard(training));
    // Where a model is believed there are none.
    if (training.some((line) => isNumber(line.dynamics_loss) || isNumber(line.reward_loss))) {
      made.append(
          meanLinesCard(training, "Losses of both networks",
                        "As the mean of the last 20 episodes.", logAxis("loss"),
                        (line, name) => line[name], ["dynamics_loss", "reward_loss"]),
          meanLinesCard(training, "Errors of both networks' predictions",
                        "One step ahead, of the reward as it is and of the observation in " +
                        "standard deviations; root mean square over an episode, mean of the last 20.",
                        logAxis("error"), (line, name) => line[name],
                        ["reward_prediction_error", "observation_prediction_error"]));
    }
    if (training.some((line) => list(line.best_so_far).length > 1)) {
      made.append(convergenceCard(training));
    }
    made.append(
        episodeCard(training, "Path length of each episode",
                    "Length of the motion, with 1 m a rad.",
                    axis("path [m]", {rangemode: "tozero"}), (line) => line.path_length_m));
    if (rollbacks.length > 0) made.append(rollbackCard(rollbacks));
    if (training.some((line) => line.refused > 0)) {
      made.append(meanLinesCard(
          training, "Refused actions",
          "Out of the carrier's reach or limits; the mean of the last 20 episodes.",
          axis("actions an episode", {rangemode: "tozero"}), (line) => line.refused, ["refused"]));
    }
  }
  const motions = list(result.motion ? [result.motion].flat() : null)
      .map((motion) => ({policy: "learned", ...motion}));
  if (motions.length > 0) {
    made.append(wide(motionCard(motions, motions[0].board_outline_b, "The learned motion")));
    made.append(...playerCards(motions, motions[0].board_outline_b, "The learned motion, played"));
  }
  return [made];
}
