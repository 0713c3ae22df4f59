// Calibrations of several recordings in one: the merged values, and how well the recordings repeat.

function mergeSummary(result) {
  const n = list(result.results).length;
  if (n === 0) return {verdict: "unknown", line: "This page carries no merged calibration."};
  const scattered = list(result.groups).filter((group) => group.sigma_scale > 1);
  return {
    verdict: result.verdict ?? "unknown",
    line: scattered.length === 0
      ? `${counted(n, "recording", "recordings")} agree within what their covariances say.`
      : `${counted(n, "recording", "recordings")} lie further apart than their covariances say.`,
    details: scattered.map((group) => `${capitalised(group.name)}: sigmas times ` +
                                      `${number(group.sigma_scale, 3)}.`).join(" "),
    findings: list(result.findings),
  };
}

// Each recording's deviation from the merged value, in its own sigmas.
function deviationsPlot(group, names) {
  return plot(() => ({
    data: list(group.parameters).map((parameter) => ({
      type: "scatter", mode: "markers", name: parameter.name,
      x: names,
      y: list(parameter.deviations).map((d, i) => {
        const sigma = list(parameter.sigmas)[i];
        return sigma > 0 ? d / sigma : null;
      }),
    })),
    layout: {
      xaxis: axis("recording", {type: "category"}),
      yaxis: axis("deviation from the merged value [its own sigmas]"),
    },
  }));
}

function mergeGroupCards(group, names) {
  const rows = list(group.parameters).map((parameter) => [
    parameter.name ?? "", isNumber(parameter.value) ? number(parameter.value, 7) : "",
    number(parameter.sigma, 3), number(parameter.repeatability, 3), number(parameter.stated_sigma, 3),
  ]);
  const title = capitalised(group.name ?? "parameters");
  return [
    wide(card(title,
              `As scattered by chance: ${chanceText(group.probability)}; sigmas times ` +
                  `${number(group.sigma_scale, 3)}.`,
              table(["parameter [px, rad, m, s]", "merged", "its sigma", "repeats to",
                     "one recording states"], rows))),
    card(`${title}, recording by recording`, "Within 2, most of the time, where sigmas tell the truth.",
         deviationsPlot(group, names)),
  ];
}

function mergeSection(result) {
  const names = list(result.results).map((name, i) => `${i + 1}: ${name}`);
  if (list(result.groups).length === 0) return [emptyNote("Nothing was merged.")];
  return [
    element("div", {class: "cards"},
            ...list(result.groups).flatMap((group) => mergeGroupCards(group, names))),
    element("p", {}, "What all recordings have in common, the board or a lens that all were given, " +
                     "no scatter shows."),
  ];
}
