// Numbers and units as people read them.

// Four significant digits; powers of ten only where plain notation is long.
export function short(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    return `${trim(mantissa)}·10${superscript(Number(power))}`;
  }
  return trim(value.toPrecision(digits)).replace("-", "−");
}

function trim(text) {
  const plain = text.includes("e") ? String(Number(text)) : text;
  return (plain.includes(".") ? plain.replace(/\.?0+$/, "") : plain).replace("-", "−");
}

export function superscript(number) {
  return [...String(number)].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("");
}

// Thousands apart, by a space that does not break.
export function count(number) {
  return String(number).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

export function percent(share) {
  if (share > 0 && share < 0.001) return "< 0.1 %";
  return `${(100 * share).toFixed(1)} %`;
}

// The unit of a quantity of a dimension (a power of length), such as 1/mm².
export function unitOf(dimension, length) {
  const unit = length ?? "unit";
  if (dimension === 0) return "";
  if (dimension > 0) return unit + (dimension === 1 ? "" : superscript(dimension));
  return `1/${unit}${dimension === -1 ? "" : superscript(-dimension)}`;
}

// Values for the marks of an axis: about so many, at round numbers.
export function ticks(low, high, about) {
  const rough = (high - low) / about;
  if (!(rough > 0) || !Number.isFinite(rough)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((s) => s * power >= rough * 0.999);
  const marks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) marks.push(i * step);
  return marks;
}
