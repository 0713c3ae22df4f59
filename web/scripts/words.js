// Numbers in the words of people.

const kNothing = "–";

function isNumber(x) {
  return typeof x === "number" && Number.isFinite(x);
}

/** With so many significant digits; a dash for what does not exist. */
function number(x, digits = 4) {
  if (!isNumber(x)) return kNothing;
  if (Number.isInteger(x) && Math.abs(x) < 1e9) return String(x);
  if (Math.abs(x) >= 1e7) return x.toExponential(digits - 1);
  return String(Number(x.toPrecision(digits)));
}

/** With exactly so many significant digits, zeros as well: what stands below each other lines up. */
function measured(x, digits = 3) {
  if (!isNumber(x)) return kNothing;
  if (x === 0) return "0";
  // Of what is left after rounding: 999.6 has four digits before the point.
  const power = Math.floor(Math.log10(Math.abs(Number(x.toPrecision(digits)))));
  if (power >= 7 || power < -6) return x.toExponential(digits - 1);
  return power >= digits ? x.toFixed(0) : x.toPrecision(digits);
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
  return `${measured(pair[0], digits)} to ${measured(pair[1], digits)}`;
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
