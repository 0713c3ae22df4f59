// The views that a camera calibration rests on: corners, residuals, lens, and where the board was.

const kNoViews = "No view could be used, so there is nothing to draw.";

/** Every corner of every view in one list. */
function cornersOf(views) {
  const corners = {u: [], v: [], du: [], dv: [], length: [], label: []};
  for (const view of views) {
    const residuals = list(view.residuals);
    for (const [i, [u, v]] of list(view.pixels).entries()) {
      const [du, dv] = residuals[i] ?? [null, null];
      corners.u.push(u);
      corners.v.push(v);
      corners.du.push(du);
      corners.dv.push(dv);
      corners.length.push(isNumber(du) && isNumber(dv) ? Math.hypot(du, dv) : null);
      corners.label.push(`${plotText(view.name ?? "view")}, corner ${i}<br>` +
                         `residual ${number(du, 3)}, ${number(dv, 3)} px`);
    }
  }
  return corners;
}

function cornerCard(corners, resolution) {
  const build = () => {
    if (corners.u.length === 0) return kNoViews;
    return {
      data: [{
        type: pointTraceType(corners.u.length), mode: "markers", x: corners.u, y: corners.v,
        text: corners.label,
        hovertemplate: "%{text}<br>at (%{x:.1f}, %{y:.1f})<extra></extra>",
        marker: {
          size: 5, color: corners.length, colorscale: "Cividis", cmin: 0, opacity: 0.8,
          showscale: !kNarrow, colorbar: colourBar("residual [px]"),
        },
      }],
      layout: imageLayout(resolution),
    };
  };
  return card("Corners over the image",
              "Every corner of every used view, brighter where the residual is larger. The lens " +
                  "is known only where there are corners.",
              plot(build, {aspect: imageAspect(resolution, !kNarrow)}));
}

/** 1, 2 or 5 times a power of ten, at most x. */
function roundFactor(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [5, 2, 1].find((step) => step * power <= x) * power;
}

function residualVectors(corners, factor) {
  const x = [];
  const y = [];
  for (let i = 0; i < corners.u.length; ++i) {
    if (corners.length[i] === null) continue;
    x.push(corners.u[i], corners.u[i] + factor * corners.du[i], null);
    y.push(corners.v[i], corners.v[i] + factor * corners.dv[i], null);
  }
  return {x, y};
}

function residualVectorCard(corners, resolution) {
  const lengths = corners.length.filter((x) => x !== null);
  const title = "Residual vectors";
  const note = "Predicted minus measured, from the measured corner. A pattern here is a lens " +
      "that the model does not fit, or a board that is not flat.";
  if (lengths.length === 0) return card(title, note, emptyNote("There are no residuals to draw."));
  const typical = lengths.reduce((sum, x) => sum + x, 0) / lengths.length;
  const start = typical > 0 ? roundFactor(Math.max(1, 0.025 * resolution[0] / typical)) : 1;

  const place = plot(() => {
    const fromDot = {
      type: pointTraceType(corners.u.length), mode: "markers", x: corners.u, y: corners.v,
      text: corners.label, hovertemplate: "%{text}<extra></extra>",
      marker: {size: 3, color: kGrey}, showlegend: false,
    };
    const vectors = {
      type: pointTraceType(corners.u.length), mode: "lines", ...residualVectors(corners, start),
      line: {color: kVermilion, width: 1.5}, hoverinfo: "skip", showlegend: false,
    };
    return {data: [fromDot, vectors], layout: imageLayout(resolution)};
  }, {aspect: imageAspect(resolution, false)});

  const slider = element("input", {type: "range", min: "0", max: "4", step: "0.02"});
  slider.value = String(Math.log10(start));
  const stated = element("output", {}, `${number(start)} times as long`);
  slider.addEventListener("input", () => {
    const factor = Number((10 ** Number(slider.value)).toPrecision(2));
    stated.textContent = `${number(factor)} times as long`;
    const {x, y} = residualVectors(corners, factor);
    Plotly.restyle(place, {x: [x], y: [y]}, [1]);
  });
  const label = element("label", {}, "Drawn");
  return card(title, `${note} At first drawn ${number(start)} times as long as they are.`,
              element("div", {class: "control"}, label, slider, stated), place);
}

function residualHistogramCard(corners, sigma) {
  const build = () => {
    const du = corners.du.filter(isNumber);
    const dv = corners.dv.filter(isNumber);
    if (du.length === 0) return "There are no residuals to draw.";
    const known = isNumber(sigma) && sigma > 0;
    const bins = known ? {xbins: {start: -6 * sigma, end: 6 * sigma, size: 0.25 * sigma}} : {};
    const bars = (name, x, colour) => ({
      type: "histogram", name, x, histnorm: "probability density", opacity: 0.55,
      marker: {color: colour}, ...bins,
      hovertemplate: `${name} %{x} px: %{y:.3g} per px<extra></extra>`,
    });
    const data = [bars("du", du, kBlue), bars("dv", dv, kOrange)];
    if (known) {
      const x = Array.from({length: 121}, (_, i) => sigma * (i - 60) / 12);
      const y = x.map((e) => Math.exp(-0.5 * (e / sigma) ** 2) / (sigma * Math.sqrt(2 * Math.PI)));
      data.push({
        type: "scatter", mode: "lines", name: `normal, sigma ${number(sigma, 3)} px`, x, y,
        line: {color: kBlack, width: 2}, hoverinfo: "skip",
      });
    }
    return {
      data,
      layout: {
        barmode: "overlay",
        xaxis: axis("residual [px]", known ? {range: [-5.2 * sigma, 5.2 * sigma]} : {}),
        yaxis: axis("density [1/px]"),
      },
    };
  };
  return card("Distribution of the residuals",
              "The curve is the normal density of the stated noise; heavy tails are bad corners.",
              plot(build));
}

function viewRmsCard(views, rms) {
  const build = () => {
    if (views.length === 0) return kNoViews;
    const numbers = views.map((_, i) => i);
    const names = views.map((view, i) => plotText(view.name ?? `view ${i}`));
    const data = [{
      type: "bar", name: "each view", x: numbers, y: views.map((view) => view.rms_px),
      text: names, textposition: "none", marker: {color: kBlue},
      hovertemplate: "%{text}: %{y:.3f} px<extra></extra>",
    }];
    if (isNumber(rms)) {
      data.push({
        type: "scatter", mode: "lines", name: `all views, ${number(rms, 3)} px`,
        x: [-0.5, views.length - 0.5], y: [rms, rms], hoverinfo: "skip",
        line: {color: kVermilion, width: 2, dash: "dash"},
      });
    }
    const few = views.length <= 30 && !kNarrow;
    const ticks = few
        ? {tickvals: numbers, ticktext: names, tickangle: -60, tickfont: {size: 11}} : {};
    return {
      data,
      layout: {
        xaxis: axis(few ? "" : "view number", {showgrid: false, ...ticks}),
        yaxis: axis("root mean square [px]", {rangemode: "tozero"}),
        bargap: 0.15,
      },
    };
  };
  return card("Reprojection error of each view",
              "A view far above the others is worth looking at.", plot(build));
}

function distortionCard(curve) {
  const build = () => {
    if (list(curve?.radius_px).length === 0) {
      return "No distortion curve was handed over.";
    }
    return {
      data: [{
        type: "scatter", mode: "lines", x: curve.radius_px, y: curve.shift_px,
        line: {color: kBlue, width: 2.5},
        hovertemplate: "at %{x:.0f} px: moved by %{y:.2f} px<extra></extra>",
      }],
      layout: {
        xaxis: axis("distance from the principal point [px]"),
        yaxis: axis("outward shift [px]"),
      },
    };
  };
  return card("Distortion of the lens",
              "How far the lens moves a point outwards (negative: inwards).", plot(build));
}

/** Camera frame (z forward, x right, y down) to axes that look upright. */
function upright([x, y, z]) {
  return [x, z, -y];
}

function transformed(T_a_b, [x, y, z]) {
  return T_a_b.slice(0, 3).map((row) => row[0] * x + row[1] * y + row[2] * z + row[3]);
}

/** The corners of the points' bounding rectangle in the board's plane, closed. */
function boardOutline(points_g) {
  const xs = points_g.map((p) => p[0]);
  const ys = points_g.map((p) => p[1]);
  const [x0, x1] = [Math.min(...xs), Math.max(...xs)];
  const [y0, y1] = [Math.min(...ys), Math.max(...ys)];
  return [[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0], [x0, y0, 0]];
}

/** Lines in 3-D, one after the other in one trace, with gaps between them. */
function polylines(lines) {
  const made = {x: [], y: [], z: []};
  for (const line of lines) {
    for (const [x, y, z] of [...line, [null, null, null]]) {
      made.x.push(x);
      made.y.push(y);
      made.z.push(z);
    }
  }
  return made;
}

/** The pyramid that the image spans at this depth, as a pinhole camera would see it. */
function frustum(intrinsics, resolution, depth) {
  const [fu, fv, pu, pv] = list(intrinsics).slice(-4);
  if (!(fu > 0) || !(fv > 0)) return [];
  const ends = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([right, down]) => [
    depth * (right * resolution[0] - pu) / fu, depth * (down * resolution[1] - pv) / fv, depth,
  ]);
  return [...ends.map((end) => [[0, 0, 0], end]), [...ends, ends[0]]];
}

function boardPosesCard(plots, camera) {
  const views = list(plots.views).filter((view) => list(view.T_c_g).length >= 3);
  const build = () => {
    if (views.length === 0 || list(plots.board_points_g).length === 0) {
      return "No board pose was handed over.";
    }
    const outline = boardOutline(plots.board_points_g);
    const boards = views.map((view) => outline.map((p) => upright(transformed(view.T_c_g, p))));
    const perPoint = (value) => boards.flatMap((board, i) => {
      return Array(board.length + 1).fill(value(views[i], i));
    });
    const depths = views.map((view) => view.T_c_g[2][3]).sort((a, b) => a - b);
    const depth = 0.25 * depths[Math.floor(depths.length / 2)];
    const rays = frustum(camera.intrinsics, plots.resolution, depth);
    return {
      data: [{
        type: "scatter3d", mode: "lines", name: "board", ...polylines(boards), showlegend: false,
        text: perPoint((view, i) => `${plotText(view.name ?? `view ${i}`)}, ` +
                                    `${number(view.rms_px, 3)} px`),
        hovertemplate: "%{text}<extra></extra>",
        line: {
          width: 4, color: perPoint((view) => view.rms_px ?? 0), colorscale: "Cividis",
          colorbar: {...colourBar("error of the view [px]"), y: 1, yanchor: "top"},
        },
      }, {
        type: "scatter3d", mode: "lines", name: "camera", showlegend: false,
        ...polylines(rays.map((ray) => ray.map(upright))), line: {width: 5, color: kVermilion},
        hovertemplate: "camera<extra></extra>",
      }],
      layout: {
        margin: {l: 0, r: 0, t: 0, b: 0},
        scene: scene(["x, right [m]", "z, forward [m]", "-y, up [m]"], [1.6, -1.7, 0.7]),
      },
    };
  };
  return wide(card("Where the board was",
                   "Outlines of the board's corners as the camera (red) saw them. Different " +
                       "distances and tilts tell focal length and distortion apart.",
                   plot(build, {height: kNarrow ? "380px" : "560px"})));
}

function withoutBoardCard(names) {
  const made = card(`Images without a board: ${names.length}`,
                    "In these the whole board was not found; they were left out.");
  made.append(element("details", {}, element("summary", {}, "Names"),
                      element("p", {}, names.join(", "))));
  return wide(made);
}

function viewCards(plots, camera) {
  const views = list(plots.views);
  const resolution = plots.resolution ?? camera.resolution ?? [640, 480];
  const corners = cornersOf(views);
  return [
    cornerCard(corners, resolution),
    residualVectorCard(corners, resolution),
    residualHistogramCard(corners, plots.noise_stddev_px),
    viewRmsCard(views, camera.reprojection_rms_px),
    boardPosesCard({...plots, resolution}, camera),
    distortionCard(plots.distortion_curve),
  ];
}
