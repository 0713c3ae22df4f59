// A sheet of SVG that is drawn on as on a canvas: what paints a picture on the page also writes it.

function svgNumber(x) {
  return String(Math.round(100 * x) / 100);
}

/** The part of CanvasRenderingContext2D that pictures use. */
class SvgSheet {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.parts = [];
    this.path = [];
    this.kept = [];
    this.transform = "";
    this.numOpen = 0;  // Groups that clip all within them.
    this.numClips = 0;
    this.fillStyle = "#000";
    this.strokeStyle = "#000";
    this.lineWidth = 1;
    this.globalAlpha = 1;
    this.font = `12px ${kFont.family}`;
    this.textAlign = "start";
  }
  save() {
    const {transform, numOpen, globalAlpha} = this;
    this.kept.push({transform, numOpen, globalAlpha});
  }
  restore() {
    const kept = this.kept.pop();
    this.parts.push("</g>".repeat(this.numOpen - kept.numOpen));
    Object.assign(this, kept);
  }
  translate(x, y) {
    this.transform += `translate(${svgNumber(x)} ${svgNumber(y)}) `;
  }
  rotate(angle) {
    this.transform += `rotate(${svgNumber(180 / Math.PI * angle)}) `;
  }
  beginPath() {
    this.path = [];
  }
  moveTo(x, y) {
    this.path.push(`M${svgNumber(x)} ${svgNumber(y)}`);
  }
  lineTo(x, y) {
    this.path.push(`L${svgNumber(x)} ${svgNumber(y)}`);
  }
  rect(x, y, width, height) {
    this.path.push(`M${svgNumber(x)} ${svgNumber(y)}h${svgNumber(width)}v${svgNumber(height)}` +
                   `h${svgNumber(-width)}Z`);
  }
  clip() {
    const id = `clip${++this.numClips}`;
    // In the coordinates of the sheet, until what was kept is restored.
    this.parts.push(`<clipPath id="${id}"><path d="${this.path.join("")}"/></clipPath>`,
                    `<g clip-path="url(#${id})">`);
    ++this.numOpen;
  }
  stroke() {
    this.add("path", `d="${this.path.join("")}" fill="none" ${this.pencil()}`);
  }
  fillRect(x, y, width, height) {
    this.add("rect", `${this.box(x, y, width, height)} fill="${this.fillStyle}"`);
  }
  strokeRect(x, y, width, height) {
    this.add("rect", `${this.box(x, y, width, height)} fill="none" ${this.pencil()}`);
  }
  fillText(text, x, y) {
    const anchor = {center: "middle", right: "end"}[this.textAlign] ?? "start";
    const [size, family] = [parseFloat(this.font), this.font.replace(/^\S+ /, "")];
    this.add("text", `x="${svgNumber(x)}" y="${svgNumber(y)}" fill="${this.fillStyle}" ` +
                         `font-size="${size}" font-family="${family}" text-anchor="${anchor}"`,
             plotText(text));
  }
  text() {
    const [width, height] = [svgNumber(this.width), svgNumber(this.height)];
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" ` +
        `viewBox="0 0 ${width} ${height}">\n${this.parts.join("\n")}\n${"</g>".repeat(this.numOpen)}</svg>\n`;
  }

  box(x, y, width, height) {
    return `x="${svgNumber(x)}" y="${svgNumber(y)}" width="${svgNumber(width)}" ` +
        `height="${svgNumber(height)}"`;
  }
  pencil() {
    return `stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`;
  }
  add(tag, attributes, content = "") {
    const place = this.transform === "" ? "" : ` transform="${this.transform.trim()}"`;
    const alpha = this.globalAlpha === 1 ? "" : ` opacity="${this.globalAlpha}"`;
    this.parts.push(`<${tag} ${attributes}${place}${alpha}>${content}</${tag}>`);
  }
}
