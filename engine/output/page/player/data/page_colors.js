// Numbers as text, values as colours.
"use strict";

const text = (() => {
  const prefixes = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "\u00b5"], [1e-9, "n"]];

  // Three significant digits with an SI prefix; fewer where an error is given, down to the one that it changes.
  // The unit "1" is that of plain numbers, which get neither a unit nor a prefix.
  function si(value, unit, error) {
    if (value === null || !isFinite(value)) return "\u2013";
    if (unit === "1") return unitless(value);
    if (Math.abs(value) < 5e-12) return "0 " + unit;
    const [factor, prefix] = prefixes.find(([f]) => Math.abs(value) >= f * 0.9995) || prefixes[prefixes.length - 1];
    const digits = digits_of(value, error);
    const number = digits === 3 ? plain(value / factor) : String(+(value / factor).toPrecision(digits));
    return number + "\u202f" + prefix + unit;
  }
  // A share of one.
  const percent = (value, error) => +(100 * value).toPrecision(digits_of(value, error)) + "\u202f%";
  const digits_of = (value, error) =>
    (error > 0 && value !== 0 ? Math.min(Math.max(Math.floor(Math.log10(Math.abs(value) / error)) + 1, 1), 3) : 3);
  function plain(value) {
    const size = Math.abs(value);
    return String(+value.toFixed(size >= 99.95 ? 0 : size >= 9.995 ? 1 : 2));
  }
  const count = (value) => Math.round(value).toLocaleString("en-US");
  // Three significant digits, and all digits before the point.
  const unitless = (value) => (Math.abs(value) >= 999.5 ? count(value) : String(+value.toPrecision(3)));
  const average = (value) => (value >= 100 ? count(value) : plain(value));

  // The next of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten.
  function round_up(value) {
    if (!(value > 0)) return 1;
    const power = Math.pow(10, Math.floor(Math.log10(value)));
    return power * [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((step) => step * power >= value * 0.999999);
  }
  // A step of 1, 2 or 5 times a power of ten that cuts a range into about `parts`.
  function tick(range, parts) {
    const power = Math.pow(10, Math.floor(Math.log10(range / parts)));
    return power * ([1, 2, 5].find((step) => step * power >= range / parts) || 10);
  }
  return { si, percent, count, unitless, average, round_up, tick };
})();

const colors = (() => {
  // From a colour of middle lightness, which is seen on a dark ground and on a light one, to a bright one (sRGB).
  const ramps = {
    speed: ["#7f93c9", "#5fa3cb", "#45b3b5", "#4cc08f", "#83cf66", "#c3d94c", "#f6e24b"],
    stress: ["#8f8ad6", "#b27cd0", "#cf72b8", "#e56d92", "#f27f67", "#f9a64a", "#f7dd53"],
    strain: ["#8794b8", "#a19fb3", "#bda99f", "#d6ae80", "#eaa05e", "#f4824f", "#f35f55"],
    error: ["#7aa68c", "#8fae80", "#aab374", "#c8b46a", "#e0a862", "#ee8f67", "#f2707a"],
  };
  const body_colors = ["#6fa8dc", "#e6a15c", "#7fbf7b", "#d98cb3", "#b8a6e0", "#d8c25f", "#6cc5c1", "#e07f72",
    "#a9b665", "#8f9fb8"];
  const line = { joint: "#b48cff", tie: "#ff6f91", cable: "#f2c14e", spring: "#6fd08c" };
  const motion = { open: "#8b97a6", stick: "#3fc8b4", slide: "#ff9d47" };

  const parse = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
  const linear = (rgb) => rgb.map((c) => Math.pow(c, 2.2));  // the renderer's gamma
  const css = (rgb) => "rgb(" + rgb.map((c) => Math.round(255 * c)).join(",") + ")";

  function at(name, t) {
    const corners = ramps[name], x = Math.min(Math.max(t, 0), 1) * (corners.length - 1);
    const i = Math.min(Math.floor(x), corners.length - 2);
    const a = parse(corners[i]), b = parse(corners[i + 1]);
    return a.map((c, k) => c + (b[k] - c) * (x - i));
  }
  // 256 colours of a ramp, for the renderer.
  function table(name) {
    const out = new Float32Array(3 * 256);
    for (let i = 0; i < 256; ++i) out.set(linear(at(name, i / 255)), 3 * i);
    return out;
  }
  // Any number of colours that differ from their neighbours: hues a golden angle apart.
  function of_number(number) {
    const hue = (number * 0.618034) % 1, light = 0.6 + 0.08 * (number % 3 - 1);
    const part = (k) => {
      const x = (k + hue * 12) % 12;
      return light - 0.7 * Math.min(light, 1 - light) * Math.max(-1, Math.min(x - 3, 9 - x, 1));
    };
    return [part(0), part(8), part(4)];
  }
  const of_body = (number) => (number < body_colors.length ? parse(body_colors[number]) : of_number(number));

  return { at, css, linear, parse, table, of_number, of_body,
    tables: Object.fromEntries(Object.keys(ramps).map((name) => [name, table(name)])), motion, line };
})();
