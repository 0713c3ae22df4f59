// Quantities over an image: maps of pixels, on a grid from its first pixel to its last.

/**
 * A picture of one of several maps, with the same colours for all, and a choice if there are more
 * than one.
 * @param maps  [{name, values_px: rows, median_px, worst_px}], at least one.
 */
function imageMap(maps, resolution) {
  let shown = maps[0];
  // A few cells at the rim are often far above the rest, which would be drawn all alike.
  const largest = Math.max(...maps.map((map) => Math.min(map.worst_px, 4 * map.median_px)));
  const [rows, columns] = [shown.values_px.length, shown.values_px[0].length];
  const size = [resolution[0] / (columns - 1), resolution[1] / (rows - 1)];
  const cells = shown.values_px.flatMap((row, r) => row.map((_, c) => [r, c]));
  const pixelOf = ([row, column]) => [
    column / (columns - 1) * (resolution[0] - 1), row / (rows - 1) * (resolution[1] - 1),
  ];
  const place = picture(resolution, (pen) => {
    for (const cell of cells) {
      const value = shown.values_px[cell[0]][cell[1]];
      if (!isNumber(value)) continue;
      const [u, v] = pixelOf(cell);
      const [x, y] = pen.at([u - 0.5 * size[0], v - 0.5 * size[1]]);
      pen.context.fillStyle = cividis(value / largest);
      // A little larger than it is: no seams.
      pen.context.fillRect(x, y, pen.scale * size[0] + 0.7, pen.scale * size[1] + 0.7);
    }
  }, () => [
    ["map", "u [px]", "v [px]", "value [px]"],
    ...maps.flatMap((map) => cells.map(
        ([r, c]) => [map.name, ...pixelOf([r, c]), map.values_px[r][c]])),
  ], {
    hover: {
      pixels: cells.map(pixelOf),
      textOf: (i) => {
        const value = shown.values_px[cells[i][0]][cells[i][1]];
        return isNumber(value) ? `${number(value, 3)} px` : "not seen";
      },
    },
  });
  const stated = element("p", {class: "note"});
  const show = (map) => {
    shown = map;
    const name = map.name ? `${map.name}: ` : "";
    stated.textContent = capitalised(`${name}median ${number(map.median_px, 3)} px, worst ` +
                                     `${number(map.worst_px, 3)} px.`);
  };
  show(shown);
  const scaleNote = maps.some((map) => map.worst_px > largest) ? " or more" : "";
  const parts = [colourScale("[px]", 0, largest, scaleNote), place, stated];
  if (maps.length > 1) {
    parts.unshift(choice(maps.map((map) => map.name), (i) => {
      show(maps[i]);
      place.repaint();
    }));
  }
  return parts;
}

let numChoices = 0;

/** Buttons of which one is pressed; the first at the beginning. */
function choice(names, onChoice) {
  const group = `choice-${++numChoices}`;
  return element("div", {class: "control"}, ...names.map((name, i) => {
    const button = element("input", {type: "radio", name: group});
    button.checked = i === 0;
    button.addEventListener("change", () => onChoice(i));
    return element("label", {}, button, name);
  }));
}

/** How many pixels a point is off, over the image: at the boards' distance and at infinity. */
function projectionUncertaintyCard(uncertainty, resolution) {
  const title = "Where a point may be seen";
  const note = "By how many pixels a point fixed to the camera's housing may be off, one sigma, " +
      "in the worst direction. It is least where there were corners, at the board's distance.";
  const maps = [
    {...uncertainty?.at_distance, name: `at ${number(uncertainty?.distance_m, 2)} m`},
    {...uncertainty?.at_infinity, name: "at infinity"},
  ].filter((map) => list(map.values_px).length > 1);
  if (maps.length === 0) {
    const reason = "No projection uncertainty was handed over: there is no covariance.";
    return card(title, note, emptyNote(reason));
  }
  return card(title, note, ...imageMap(maps, resolution));
}
