// The page: its documents in their order, each with its verdict first.

const kKinds = {
  "camera": {title: "Camera calibration", summary: cameraSummary, section: cameraSection},
  "camera-imu": {
    title: "Camera-IMU calibration", summary: cameraImuSummary, section: cameraImuSection,
  },
  "check": {title: "Check of a recording", summary: checkSummary, section: checkSection},
  "diff": {title: "Two calibrations compared", summary: diffSummary, section: diffSection},
  "merge": {title: "Calibrations merged", summary: mergeSummary, section: mergeSection},
  "dry-run": {title: "Dry run", summary: dryRunSummary, section: dryRunSection},
  "noise": {title: "Noise of an IMU", summary: noiseSummary, section: noiseSection},
  "learn": {title: "Learning", summary: learnSummary, section: learnSection},
  "table1": {title: "Motions compared", summary: table1Summary, section: table1Section},
  "table6": {
    title: "Trained on reprojection error", summary: table1Summary, section: table1Section,
  },
  "evaluation": {
    title: "Tables and figures", summary: evaluationSummary, section: evaluationSection,
  },
  "figure4": {title: "Field of view", summary: evaluationSummary, section: evaluationSection},
  "figure5": {title: "Errors over rigs", summary: evaluationSummary, section: evaluationSection},
  "figure7": {
    title: "Residuals and biases", summary: evaluationSummary, section: evaluationSection,
  },
  "pareto": {
    title: "Error against budget", summary: evaluationSummary, section: evaluationSection,
  },
  "ablation": {
    title: "What each difference costs", summary: evaluationSummary, section: evaluationSection,
  },
  "planners": {
    title: "Planners compared", summary: evaluationSummary, section: evaluationSection,
  },
  "rows": {title: "Why learn at all", summary: evaluationSummary, section: evaluationSection},
  "rivals": {
    title: "Estimators compared", summary: evaluationSummary, section: evaluationSection,
  },
};

function unknownKind(kind) {
  return {
    title: `Result of kind ${kind}`,
    summary: () => ({
      verdict: "unknown", line: `This page cannot draw results of kind “${kind}”.`,
      details: "Its numbers stand below as they came.",
    }),
    section: (result) => [element("details", {}, element("summary", {}, "The numbers"),
                                  element("pre", {}, JSON.stringify(result, null, 2)))],
  };
}

/** Titles of kinds that occur more than once are numbered; tasks tell learn documents apart. */
function sectionTitles(documents, kinds) {
  const titles = documents.map((result, i) => {
    const task = result.kind === "learn" && result.task ? `: ${result.task}` : "";
    return `${kinds[i].title}${task}`;
  });
  return titles.map((title, i) => {
    if (titles.filter((other) => other === title).length === 1) return title;
    return `${title} ${titles.slice(0, i + 1).filter((other) => other === title).length}`;
  });
}

/** What throws is said in words: one broken document leaves the others readable. */
function orReason(make) {
  try {
    return make();
  } catch (error) {
    const reason = emptyNote(`This part could not be drawn: ${error.message}.`);
    reason.classList.add("plot-failed");
    return [reason];
  }
}

function writePage(documents) {
  const report = document.getElementById("report");
  const navigation = document.getElementById("navigation");
  if (documents.length === 0) report.append(emptyNote("There is no result to report."));

  const kinds = documents.map((result) => {
    return Object.hasOwn(kKinds, result.kind) ? kKinds[result.kind] : unknownKind(result.kind);
  });
  const titles = sectionTitles(documents, kinds);
  const overview = element("div", {class: "overview"});
  if (documents.length > 1) report.append(overview);
  for (const [i, result] of documents.entries()) {
    // A title for what follows, which the page has already.
    if (result.kind === "evaluation" && documents.length > 1) continue;
    const id = `section-${i + 1}`;
    const section = element("section", {id});
    // The page's own title says it already where there is nothing else.
    const isTitle = documents.length === 1 && titles[i] === document.querySelector("h1").textContent;
    if (!isTitle) section.append(element("h2", {}, titles[i]));
    section.append(...orReason(() => {
      const summary = kinds[i].summary(result);
      if (documents.length > 1) {
        navigation.append(element("a", {href: `#${id}`}, titles[i]));
        const banner = verdictBanner({...summary, details: "", findings: []});
        banner.prepend(element("a", {href: `#${id}`}, titles[i]));
        overview.append(banner);
      }
      return [verdictBanner(summary)];
    }));
    section.append(...orReason(() => kinds[i].section(result)));
    report.append(section);
  }
}

writePage(JSON.parse(document.getElementById("documents").textContent));
drawAll().then(() => {
  document.documentElement.dataset.state = "drawn";
});
