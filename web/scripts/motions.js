// Motions of the camera in the arm's base frame, with the board and where the camera looks.

/**
 * Where the camera looks: [from, to] for each axis given. An axis of six numbers is a point and a
 * direction; axes of three numbers are directions at points spread evenly along the motion.
 */
function opticalAxes(motion, points, length) {
  const axes = list(motion.axis_b);
  return axes.map((numbers, i) => {
    const spread = axes.length > 1 ? i / (axes.length - 1) : 0;
    const from = numbers.length === 6 ? numbers.slice(0, 3)
                                      : points[Math.round(spread * (points.length - 1))];
    return [from, from.map((x, k) => x + length * numbers.slice(-3)[k])];
  });
}

function loopsOf(motion) {
  const loops = list(motion.loops).filter((loop) => list(loop).length > 0);
  if (loops.length > 0) return loops;
  return list(motion.xyz_b).length > 0 ? [motion.xyz_b] : [];
}

function extent(points) {
  const sizes = [0, 1, 2].map((k) => {
    const values = points.map((point) => point[k]);
    return Math.max(...values) - Math.min(...values);
  });
  return Math.max(...sizes);
}

function motionTraces(motion) {
  const loops = loopsOf(motion);
  const points = loops.flat();
  const colour = policyColour(motion.policy);
  const traces = loops.map((loop, i) => ({
    type: "scatter3d", mode: "lines", ...polylines([loop]), showlegend: false,
    line: {
      width: 5, color: shade(colour, loops.length > 1 ? 0.5 - 0.9 * i / (loops.length - 1) : 0),
    },
    hovertemplate: `${plotText(motion.policy)}, loop ${i + 1}<br>` +
        "x %{x:.3f}, y %{y:.3f}, z %{z:.3f} m<extra></extra>",
  }));
  const axes = opticalAxes(motion, points, 0.25 * extent(points));
  if (axes.length > 0) {
    traces.push({
      type: "scatter3d", mode: "lines", ...polylines(axes), showlegend: false,
      line: {width: 2, color: colour}, opacity: 0.6,
      hovertemplate: `${plotText(motion.policy)}: looks this way<extra></extra>`,
    });
  }
  return traces;
}

/** A box to tick: shows and hides these traces of a plot. */
function traceSwitch(place, label, shown, traces) {
  const box = element("input", {type: "checkbox"});
  box.checked = shown;
  box.addEventListener("change", () => {
    if (traces().length > 0) Plotly.restyle(place, {visible: box.checked}, traces());
  });
  return element("label", {}, box, ...label);
}

/** The same motion in another length has the same shape. */
function isShownAtFirst(motion) {
  return withoutPath(motion.policy) === motion.policy;
}

function motionCard(motions, outline_b, title) {
  const drawn = motions.filter((motion) => loopsOf(motion).length > 0);
  const note = "Path of the camera in the arm's base frame, each loop in a shade of its own; " +
      "thin lines show where the camera looks.";
  if (drawn.length === 0) return card(title, note, emptyNote("No motion was handed over."));

  const outline = list(outline_b);
  const traceIndices = new Map();
  const place = plot(() => {
    const data = [];
    for (const motion of drawn) {
      const traces = motionTraces(motion)
          .map((trace) => ({...trace, name: motion.policy, visible: isShownAtFirst(motion)}));
      traceIndices.set(motion, traces.map((_, i) => data.length + i));
      data.push(...traces);
    }
    if (outline.length > 0) {
      traceIndices.set("board", [data.length]);
      data.push({
        type: "scatter3d", mode: "lines", ...polylines([[...outline, outline[0]]]), visible: false,
        line: {width: 5, color: kBlack}, showlegend: false, hovertemplate: "board<extra></extra>",
      });
    }
    return {
      data,
      layout: {
        margin: {l: 0, r: 0, t: 0, b: 0},
        scene: scene(["x [m]", "y [m]", "z [m]"], [-1.2, -1.4, 0.8], data),
      },
    };
  }, {height: kNarrow ? "380px" : "560px"});

  const control = element("div", {class: "control"});
  for (const motion of drawn) {
    const swatch = element("span", {class: "swatch"});
    swatch.style.background = policyColour(motion.policy);
    const length = isNumber(motion.path_length_m) ? `, ${number(motion.path_length_m, 4)} m` : "";
    const seconds = isNumber(motion.motion_s) ? `, ${number(motion.motion_s, 3)} s` : "";
    control.append(traceSwitch(place, [swatch, `${motion.policy}${length}${seconds}`],
                               isShownAtFirst(motion), () => traceIndices.get(motion) ?? []));
  }
  // The board is so much farther away than the path is long that the path would be drawn small.
  if (outline.length > 0) {
    control.append(traceSwitch(place, ["board"], false, () => traceIndices.get("board") ?? []));
  }
  return card(title, note, control, place);
}
