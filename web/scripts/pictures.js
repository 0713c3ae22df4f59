// Pictures in the pixels of an image, on a canvas: thousands of corners are drawn in an instant,
// and printed as they are seen.

const kPictureMargin = {left: 44, right: 10, top: 8, bottom: 38};

// Cividis (Nunez, Anderton, Renslow 2018): as bright as it is large, to any eye.
const kCividis = ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74",
                  "#c3b369", "#e1cc55", "#fee838"];

function rgb(colour) {
  return [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
}

/** The colour of a share in [0, 1]. */
function cividis(share) {
  const at = Math.min(1, Math.max(0, share)) * (kCividis.length - 1);
  const low = Math.min(Math.floor(at), kCividis.length - 2);
  const [a, b] = [rgb(kCividis[low]), rgb(kCividis[low + 1])];
  return `rgb(${a.map((x, i) => Math.round(x + (b[i] - x) * (at - low))).join(", ")})`;
}

/** 1, 2 or 5 times a power of ten, at most x. */
function roundFactor(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [5, 2, 1].find((step) => step * power <= x * (1 + 1e-12)) * power;
}

/** What a painter is given: the canvas's context, and where a pixel of the image lies on it. */
class Pen {
  constructor(context, scale) {
    this.context = context;
    this.scale = scale;
  }
  at([u, v]) {
    const {left, top} = kPictureMargin;
    return [left + this.scale * (u + 0.5), top + this.scale * (v + 0.5)];
  }
  dots(pixels, radius, colourOf) {
    for (const [i, pixel] of pixels.entries()) {
      const [x, y] = this.at(pixel);
      this.context.fillStyle = colourOf(i);
      this.context.fillRect(x - radius, y - radius, 2 * radius, 2 * radius);
    }
  }
  lines(lines, colour, width) {
    this.context.strokeStyle = colour;
    this.context.lineWidth = width;
    this.context.beginPath();
    for (const line of lines) {
      for (const [i, pixel] of line.entries()) {
        this.context[i === 0 ? "moveTo" : "lineTo"](...this.at(pixel));
      }
    }
    this.context.stroke();
  }
}

function paintAxes(pen, [width, height]) {
  const {context} = pen;
  const [left, top] = pen.at([-0.5, -0.5]);
  const [right, bottom] = pen.at([width - 0.5, height - 0.5]);
  context.fillStyle = "#fafbfc";
  context.fillRect(left, top, right - left, bottom - top);
  context.strokeStyle = kGrey;
  context.lineWidth = 1;
  context.strokeRect(left, top, right - left, bottom - top);

  context.fillStyle = kBlack;
  context.font = `12px ${kFont.family}`;
  const step = 2 * roundFactor(45 / pen.scale);
  context.textAlign = "center";
  for (let u = 0; u < width; u += step) context.fillText(u, pen.at([u, 0])[0], bottom + 15);
  context.fillText("u [px]", 0.5 * (left + right), bottom + 32);
  context.textAlign = "right";
  for (let v = 0; v < height; v += step) context.fillText(v, left - 5, pen.at([0, v])[1] + 4);
  context.save();
  context.translate(11, 0.5 * (top + bottom));
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillText("v [px]", 0, 0);
  context.restore();
}

/** Shows, where the pointer is, the text of the nearest pixel within 10 px of the canvas. */
function addHover(place, canvas, currentPen, {pixels, textOf}) {
  const tip = element("output", {class: "picture-tip"});
  place.append(tip);
  const hide = () => {
    tip.style.display = "none";
  };
  hide();
  canvas.addEventListener("pointerleave", hide);
  canvas.addEventListener("pointermove", (event) => {
    const pen = currentPen();
    if (!pen) return;
    let [nearest, least] = [-1, 10];
    for (const [i, pixel] of pixels.entries()) {
      const [x, y] = pen.at(pixel);
      const distance = Math.hypot(x - event.offsetX, y - event.offsetY);
      if (distance < least) [nearest, least] = [i, distance];
    }
    if (nearest < 0) return hide();
    tip.replaceChildren(...textOf(nearest).split("\n").map((line) => element("div", {}, line)));
    tip.style.display = "block";
    tip.style.top = `${event.offsetY + 14}px`;
    tip.style.left = `${Math.max(0, Math.min(event.offsetX + 14,
                                             canvas.clientWidth - tip.offsetWidth))}px`;
  });
}

/**
 * A picture of the image plane, painted when its turn comes and again when its size changes.
 * @param paint  (pen) draws in the image, of which what lies outside is cut off.
 * @param rowsOf  () -> what it shows as rows of cells, the first one of titles.
 * @param more  {hover: {pixels, textOf: index -> text of lines}, name: its own, of several in a card}
 * @return the place; place.repaint() paints it anew.
 */
function picture([width, height], paint, rowsOf, {hover, name = ""} = {}) {
  const canvas = element("canvas", {});
  const place = element("div", {class: "picture"}, canvas);
  const {left, right, top, bottom} = kPictureMargin;
  let pen = null;
  const paintAll = (made) => {
    const {context, scale} = made;
    paintAxes(made, [width, height]);
    context.save();
    context.beginPath();
    context.rect(left, top, scale * width, scale * height);
    context.clip();
    paint(made);
    context.restore();
  };
  const repaint = () => {
    const across = place.clientWidth;
    if (across <= left + right) return;
    const scale = (across - left - right) / width;
    const down = Math.round(scale * height + top + bottom);
    const fine = window.devicePixelRatio || 1;
    canvas.width = Math.round(fine * across);
    canvas.height = Math.round(fine * down);
    canvas.style.aspectRatio = `${across} / ${down}`;
    const context = canvas.getContext("2d");
    context.scale(fine, fine);
    pen = new Pen(context, scale);
    paintAll(pen);
  };
  const svgOf = () => {
    const sheet = new SvgSheet(pen.scale * width + left + right, pen.scale * height + top + bottom);
    paintAll(new Pen(sheet, pen.scale));
    return sheet.text();
  };
  place.repaint = repaint;
  if (hover && kHover) addHover(place, canvas, () => pen, hover);
  whenItsTurnComes(place, () => {
    repaint();
    place.after(saveButtons(place, name, rowsOf, svgOf));
    let painted = place.clientWidth;
    new ResizeObserver(() => {
      if (place.clientWidth !== painted) repaint();
      painted = place.clientWidth;
    }).observe(place);
  });
  return place;
}

/** What colours mean, from the least to the largest value and, perhaps, beyond. */
function colourScale(title, least, largest, beyond = "") {
  const bar = element("span", {class: "colour-scale-bar"});
  bar.style.background = `linear-gradient(to right, ${kCividis.join(", ")})`;
  return element("div", {class: "colour-scale"}, title, element("span", {}, number(least, 3)), bar,
                 element("span", {}, number(largest, 3) + beyond));
}
