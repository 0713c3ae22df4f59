// Numbers in the words of people.

const kNothing = "–";

function isNumber(x) {
  return typeof x === "number" && Number.isFinite(x);
}

/** With so many significant digits; a dash for what does not exist. */
function number(x, digits = 4) {
  if (!isNumber(x)) return kNothing;
  if (Number.isInteger(x) && Math.abs(x) < 1e9) return String(x);
  return String(Number(x.toPrecision(digits)));
}

/** A value with as many decimals as its sigma can bear: two digits of the sigma. */
function withSigma(value, sigma) {
  if (!isNumber(value)) return kNothing;
  if (!isNumber(sigma) || !(sigma > 0)) return number(value, 7);
  const decimals = Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
  return value.toFixed(decimals);
}

function interval(pair, digits = 3) {
  if (!Array.isArray(pair) || !pair.every(isNumber)) return "";
  return `${number(pair[0], digits)} to ${number(pair[1], digits)}`;
}

function counted(n, one, many) {
  return `${number(n)} ${n === 1 ? one : many}`;
}

function capitalised(text) {
  return text === "" ? "" : text[0].toUpperCase() + text.slice(1);
}

/** Of anything that may be missing or no array at all. */
function list(x) {
  return Array.isArray(x) ? x : [];
}
