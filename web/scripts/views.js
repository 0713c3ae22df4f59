// The views that a camera calibration rests on: corners, residuals, lens, and where the board was.

const kNoViews = "No view could be used, so there is nothing to draw.";

/** Every corner of every view in one list. */
function cornersOf(views) {
  const corners = {pixels: [], residuals: [], length: [], label: [], name: []};
  for (const view of views) {
    const residuals = list(view.residuals);
    for (const [i, pixel] of list(view.pixels).entries()) {
      const [du, dv] = residuals[i] ?? [null, null];
      corners.pixels.push(pixel);
      corners.residuals.push([du, dv]);
      corners.length.push(isNumber(du) && isNumber(dv) ? Math.hypot(du, dv) : null);
      corners.name.push([view.name ?? "view", i]);
      corners.label.push(`${view.name ?? "view"}, corner ${i}\n` +
                         `residual ${number(du, 3)}, ${number(dv, 3)} px`);
    }
  }
  return corners;
}

/** The value below which this share of the numbers lies. */
function quantile(numbers, share) {
  const sorted = numbers.filter(isNumber).sort((a, b) => a - b);
  return sorted[Math.floor(share * (sorted.length - 1))];
}

function cornerCard(corners, resolution, rejected) {
  const left = rejected.filter((corner) => list(corner.pixel).length === 2);
  const leftNote = left.length > 0 ? " Crosses are corners that were left out as outliers." : "";
  const made = card("Corners over the image",
                    "Every corner of every used view, brighter where the residual is larger. The " +
                        `lens is known only where there are corners.${leftNote}`);
  if (corners.pixels.length === 0) {
    made.append(emptyNote(kNoViews));
    return made;
  }
  const largest = quantile(corners.length, 0.99) || 1;
  const colours = corners.length.map((length) => cividis((length ?? 0) / largest));
  const hover = {
    pixels: [...corners.pixels, ...left.map((corner) => corner.pixel)],
    textOf: (i) => corners.label[i] ?? rejectedText(left[i - corners.label.length]),
  };
  const radius = corners.pixels.length > 5000 ? 1.2 : 2;
  made.append(colourScale("residual [px]", 0, largest), picture(resolution, (pen) => {
    pen.dots(corners.pixels, radius, (i) => colours[i]);
    const arm = 4 / pen.scale;
    pen.lines(left.flatMap(({pixel: [u, v]}) => [[[u - arm, v - arm], [u + arm, v + arm]],
                                                 [[u - arm, v + arm], [u + arm, v - arm]]]),
              kVermilion, 1.5);
  }, () => [
    kCornerColumns, ...cornerRows(corners),
    ...left.map(({view, pixel, residual}) => [view, "", ...pixel, ...(residual ?? ["", ""]), 1]),
  ], {hover}));
  return made;
}

const kCornerColumns = ["view", "corner", "u [px]", "v [px]", "du [px]", "dv [px]", "left out"];

function cornerRows(corners) {
  return corners.pixels.map((pixel, i) => [...corners.name[i], ...pixel, ...corners.residuals[i], 0]);
}

function rejectedText(corner) {
  const [du, dv] = list(corner.residual);
  return `${corner.view ?? "view"}: left out\nresidual ${number(du, 3)}, ${number(dv, 3)} px`;
}

/** Means of residuals over the cells of a grid: [cell's middle, mean], of cells that have any. */
function fieldVectors(field, [width, height]) {
  const rows = list(field?.mean_u_px);
  return rows.flatMap((row, r) => row.map((u, c) => [
    [(c + 0.5) / row.length * width - 0.5, (r + 0.5) / rows.length * height - 0.5],
    [u, list(field.mean_v_px)[r]?.[c]],
  ])).filter(([, mean]) => mean.every(isNumber));
}

function residualVectorCard(corners, resolution, field) {
  const lengths = corners.length.filter((x) => x !== null);
  const title = "Residual vectors";
  const note = "Predicted minus measured, from the measured corner. A pattern here is a lens " +
      "that the model does not fit, or a board that is not flat.";
  if (lengths.length === 0) return card(title, note, emptyNote("There are no residuals to draw."));
  const typical = lengths.reduce((sum, x) => sum + x, 0) / lengths.length;
  let factor = typical > 0 ? roundFactor(Math.max(1, 0.025 * resolution[0] / typical)) : 1;
  const means = fieldVectors(field, resolution);
  const stretched = ([u, v], [du, dv]) => [[u, v], [u + factor * du, v + factor * dv]];

  const place = picture(resolution, (pen) => {
    pen.context.globalAlpha = corners.pixels.length > 3000 ? 0.35 : 0.8;
    pen.lines(corners.pixels.map((pixel, i) => stretched(pixel, corners.residuals[i])), kVermilion,
              1);
    pen.dots(corners.pixels, 0.8, () => kGrey);
    pen.context.globalAlpha = 1;
    pen.lines(means.map((vector) => stretched(...vector)), kBlue, 3);
    pen.dots(means.map(([middle]) => middle), 1.5, () => kBlue);
  }, () => [kCornerColumns, ...cornerRows(corners)], {
    hover: {pixels: corners.pixels, textOf: (i) => corners.label[i]},
  });

  const slider = element("input", {type: "range", min: "0", max: "4", step: "0.02"});
  slider.value = String(Math.log10(factor));
  const stated = element("output", {}, `${number(factor)} times as long`);
  slider.addEventListener("input", () => {
    factor = Number((10 ** Number(slider.value)).toPrecision(2));
    stated.textContent = `${number(factor)} times as long`;
    place.repaint();
  });
  const label = element("label", {}, "Drawn");
  const made = card(title, note, element("div", {class: "control"}, label, slider, stated), place);
  if (means.length > 0) {
    const systematic = isNumber(field.systematic_rms_px)
        ? `: ${number(field.systematic_rms_px, 2)} px of the residuals depend on the place` : "";
    made.append(element("p", {class: "note"}, "Thick: means over parts of the image, which are " +
                                                  `noise where the model fits${systematic}.`));
  }
  return made;
}

function residualHistogramCard(corners, sigma) {
  const build = () => {
    const du = corners.residuals.map((residual) => residual[0]).filter(isNumber);
    const dv = corners.residuals.map((residual) => residual[1]).filter(isNumber);
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

function shiftCard(curve) {
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

/** Beyond this angle off the axis a lens is drawn by angles: a pinhole's image has no end. */
const kWideLens = 1.0;  // [rad]

function angleCard({angle_rad: angles, radius_px: radii}) {
  const degrees = angles.map((angle) => 180 / Math.PI * angle);
  // Of a lens that bends nothing, and of one that is true to angles, with this one's focal length.
  const focal = radii[1] / Math.tan(angles[1]);
  const highest = 1.1 * Math.max(...radii);
  const reference = (name, radiusOf, dash) => ({
    type: "scatter", mode: "lines", name, x: degrees,
    y: angles.map(radiusOf).map((r, i) => angles[i] < Math.PI / 2 && r < highest ? r : null),
    line: {color: kGrey, width: 1.5, dash}, hoverinfo: "skip",
  });
  const build = () => ({
    data: [
      reference("pinhole", (angle) => focal * Math.tan(angle), "dot"),
      reference("true to angles", (angle) => focal * angle, "dash"),
      {
        type: "scatter", mode: "lines", name: "this lens", x: degrees, y: radii,
        line: {color: kBlue, width: 2.5},
        hovertemplate: "%{x:.1f} degrees off the axis: at %{y:.1f} px<extra></extra>",
      },
    ],
    layout: {
      xaxis: axis("angle off the optical axis [degrees]"),
      yaxis: axis("distance from the principal point [px]", {range: [0, highest]}),
    },
  });
  return card("What the lens does to angles",
              "How far from the principal point a direction is seen, towards the farthest corner " +
                  "of the image.",
              plot(build));
}

function distortionCard(plots) {
  const angles = list(plots.lens_curve?.angle_rad);
  return angles.length > 1 && angles.at(-1) > kWideLens ? angleCard(plots.lens_curve)
                                                        : shiftCard(plots.distortion_curve);
}

/** One view as the lens saw it and as a lens without distortion would have. */
function straightenedCard(view, resolution) {
  const made = card("A view with the distortion taken out",
                    "What is straight on the board is straight on the right if the lens is known.");
  if (!view) {
    made.append(emptyNote("No view was handed over for it."));
    return made;
  }
  const row = element("div", {class: "plot-row"});
  const side = (name, content) => row.append(element("div", {}, name, content));
  if (view.image) {
    side("as seen", element("img", {src: view.image, alt: "A view as the lens saw it"}));
    side("straightened", element("img", {src: view.straightened_image, alt: "The same, straight"}));
  } else {
    for (const [name, pixels] of [["as seen", view.pixels], ["straightened", view.straightened]]) {
      side(name, picture(resolution, (pen) => {
        pen.lines(list(view.lines).map((line) => line.map((i) => pixels[i])), kSkyBlue, 1.5);
        pen.dots(pixels, 2, () => kBlue);
      }, () => [["u [px]", "v [px]"], ...pixels], {name}));
    }
  }
  made.append(row, element("p", {class: "note"}, view.name ?? ""));
  return made;
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
    const data = [{
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
    }];
    return {
      data,
      layout: {
        margin: {l: 0, r: 0, t: 0, b: 0},
        scene: scene(["x, right [m]", "z, forward [m]", "-y, up [m]"], [1.6, -1.7, 0.7], data),
      },
    };
  };
  return wide(card("Where the board was",
                   "Outlines of the board's corners as the camera (red) saw them. Different " +
                       "distances and tilts tell focal length and distortion apart.",
                   plot(build, {height: kNarrow ? "380px" : "560px"})));
}

const kNotDetected = {
  corners_near_border: "corners too near to the image's border",
  corners_of_bad_fit: "corners too small, too faint or covered",
  tags_not_on_board: "tags with numbers that the board has not",
  tags_of_another_family: "tags of another family",
  tags_seen_twice: "tags seen twice in one image",
  images_with_two_boards: "images with two boards alike",
  images_with_mirrored_board: "images with a mirrored board",
};

/** What was not used, and why: [what, how many, names or ""]. */
function leftOutRows(rejected, plots) {
  const rows = [];
  const without = list(plots.images_without_board);
  if (without.length > 0) rows.push(["images without a board", without.length, without.join(", ")]);
  for (const [key, what] of Object.entries(kNotDetected)) {
    const count = rejected.detection?.[key];
    if (count > 0) rows.push([what, count, ""]);
  }
  const byReason = new Map();
  for (const view of list(rejected.views)) {
    const reason = view.reason ?? "left out";
    if (!byReason.has(reason)) byReason.set(reason, []);
    byReason.get(reason).push(isNumber(view.rms_px) ? `${view.name} (${number(view.rms_px, 2)} px)`
                                                    : view.name);
  }
  for (const [reason, names] of byReason) {
    rows.push([`views: ${reason}`, names.length, names.join(", ")]);
  }
  const corners = list(rejected.corners);
  if (corners.length > 0) {
    const views = [...new Set(corners.map((corner) => corner.view))];
    rows.push(["corners that do not fit the rest", corners.length, `in ${views.join(", ")}`]);
  }
  return rows;
}

function leftOutCard(rejected, plots) {
  const rows = leftOutRows(rejected, plots);
  if (rows.length === 0) return card("What was left out", "", emptyNote("Nothing was left out."));
  return card("What was left out", "And why.", table(["what", "how many", "which"], rows.map(
      ([what, count, names]) => [
        what, number(count),
        names === "" ? kNothing
                     : element("details", {class: "names"}, element("summary", {}, "names"), names),
      ])));
}

function viewCards(plots, camera) {
  const views = list(plots.views);
  const resolution = plots.resolution ?? camera.resolution ?? [640, 480];
  const corners = cornersOf(views);
  return [
    cornerCard(corners, resolution, list(plots.rejected_corners)),
    projectionUncertaintyCard(camera.projection_uncertainty, resolution),
    residualVectorCard(corners, resolution, camera.checks?.residual_field),
    residualHistogramCard(corners, plots.noise_stddev_px),
    viewRmsCard(views, camera.reprojection_rms_px),
    distortionCard(plots),
    boardPosesCard({...plots, resolution}, camera),
    wide(straightenedCard(plots.straightened_view, resolution)),
    wide(leftOutCard(camera.rejected ?? {}, plots)),
  ];
}
