// Upper ends of the scales of colours, arrows and tubes.
"use strict";

const scale_names = [...field_names, "force", "line_force"];

// Scales of a recorded run by name. top: upper end of the scale; max, peak: largest value of the run; about: words that
// describe `max` in legends.
const recorded_scales = (run) => Object.fromEntries(scale_names.map((name) => {
  const { usual, max } = run[name];
  return [name, { top: fields[name] ? text.round_up(usual) : usual || 1, max, peak: max, about: "largest force" }];
}));

// Scales of a live run. They widen at once, and narrow `patience` [s] after the last value above half of a scale, so
// that legends do not flicker. Values below `smallest_share` of the largest value of the run are rounding errors.
function make_live_scales(patience = 3, smallest_share = 1e-3) {
  const scales = Object.fromEntries(scale_names.map((name) => [name, {}]));
  const clear = () => Object.values(scales).forEach((scale) =>
    Object.assign(scale, { top: 1, max: 0, peak: 0, largest: 0, since: 0, about: "99\u202f% of the forces below" }));
  // tops: by name the value below which 99 % of the values of a frame lie; now: wall time [s].
  function widen(tops, now) {
    for (const name of scale_names) {
      const scale = scales[name], value = Math.max(tops[name] || 0, smallest_share * scale.peak);
      if (!(value > 0) || !isFinite(value)) continue;
      const is_first = scale.peak === 0;
      scale.max = tops[name];
      scale.peak = Math.max(scale.peak, value);
      if (is_first || value > scale.top) scale.top = text.round_up(value);
      scale.largest = value > scale.top / 2 ? 0 : Math.max(scale.largest, value);
      if (scale.largest === 0) scale.since = now;
      if (now - scale.since < patience) continue;
      Object.assign(scale, { top: text.round_up(scale.largest), largest: 0, since: now });
    }
  }
  clear();
  return { scales, clear, widen };
}
