// A motion before it is made: the arm in space, and what its joints take of their limits. What it is
// given: calibrato/evaluation/joint_drawing.h and motion_drawing.h.

function percentText(share) {
  return isNumber(share) ? `${number(100 * share, 3)} %` : kNothing;
}

function dryRunSummary(result) {
  const quantities = list(result.joints?.quantities);
  const beyond = quantities.filter((each) => !(each.largest_share <= 1.001));
  const judged = quantities.map((each) => each.name).join(", ");
  const scaled = isNumber(result.scale) && result.scale < 1
      ? [`It was made smaller to fit the arm: ${percentText(result.scale)} of what was planned.`] : [];
  return {
    verdict: beyond.length > 0 || judged === "" ? "fail" : "pass",
    tag: beyond.length > 0 ? "beyond a limit" : judged === "" ? "not judged" : "within its limits",
    line: beyond.length > 0
        ? `Beyond the limit of ${beyond.map((each) => each.name).join(", ")}.`
        : judged === "" ? "Nothing is known of its joints."
        : `${capitalised(counted(list(result.motion?.loops).length, "loop", "loops"))} in ` +
            `${number(result.motion_s, 4)} s, within the limits of ${result.arm ?? "the arm"} in ` +
            `${judged}.`,
    also: scaled,
    details: "Let it run slowly at first, with a hand on the stop.",
  };
}

function largestSharesCard(joints) {
  const names = list(joints.names);
  const rows = list(joints.quantities).map((each) => [
    each.name, percentText(each.largest_share), names[each.joint - 1] ?? kNothing,
  ]);
  return card("Nearest to its limits",
              "Over all samples of the controller. Of positions: 0 % in the middle between the " +
                  "limits, 100 % at one of them.",
              table(["quantity", "largest share", "joint"], rows));
}

function jointCard(joints, quantity) {
  const build = () => {
    const times = list(quantity.t_s);
    const data = list(joints.names).map((name, i) => ({
      type: "scatter", mode: "lines", name: plotText(name), x: times, y: quantity.shares[i].map((x) => 100 * x),
      customdata: quantity.values[i], line: {width: 1.5, color: kPalette[i % kPalette.length]},
      hovertemplate: `${plotText(name)}, %{x:.2f} s: %{customdata:.4g} ${quantity.unit} ` +
          "(%{y:.1f} %)<extra></extra>",
    }));
    const end = times[times.length - 1];
    const highest = 110 * Math.max(1, quantity.largest_share);
    data.push({
      type: "scatter", mode: "lines", name: "limit", x: [0, end, null, 0, end],
      y: [100, 100, null, -100, -100], line: {width: 1.5, color: "#444444", dash: "dash"},
      hoverinfo: "skip",
    });
    return {
      data,
      layout: {
        xaxis: axis("time [s]", {range: [0, end]}),
        yaxis: axis("share of the limit [%]", {range: [-highest, highest]}),
        hovermode: "closest",
      },
    };
  };
  return card(capitalised(`${quantity.name} [${quantity.unit}]`), "", plot(build, {height: "300px"}));
}

function dryRunSection(result) {
  const motions = result.motion ? [result.motion] : [];
  const joints = result.joints ?? {};
  const made = element("div", {class: "cards"});
  made.append(...playerCards(motions, result.board_outline_b, "The arm"), largestSharesCard(joints),
              ...list(joints.quantities).map((each) => jointCard(joints, each)));
  return [made];
}
