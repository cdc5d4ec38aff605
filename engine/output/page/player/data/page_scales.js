// Upper ends of the scales of colours, arrows and tubes.
"use strict";

const scale_names = [...field_names, "force", "line_force"];

// Scales of a recorded run, whose values are all known: by name the end of the scale, and the largest value
// of the frames shown and of the run.
const recorded_scales = (run) => Object.fromEntries(scale_names.map((name) => {
  const { usual, max } = run[name];
  return [name, { top: fields[name] ? text.round_up(usual) : usual || 1, max, peak: max }];
}));

// Scales of a run that goes on. They widen at once and narrow slowly, so that legends do not flicker: `patience` after
// the last value above half of a scale [s]. Values far below the largest of the run are rounding and do not count.
function make_live_scales(patience = 3, smallest_share = 1e-3) {
  const scales = Object.fromEntries(scale_names.map((name) => [name, {}]));
  const clear = () => Object.values(scales).forEach((scale) =>
    Object.assign(scale, { top: 1, max: 0, peak: 0, largest: 0, since: 0 }));
  // largest: by name the largest value of a frame; now: time of the clock on the wall [s].
  function widen(largest, now) {
    for (const name of scale_names) {
      const scale = scales[name], value = Math.max(largest[name] || 0, smallest_share * scale.peak);
      if (!(value > 0) || !isFinite(value)) continue;
      scale.max = largest[name];
      scale.peak = Math.max(scale.peak, value);
      const is_first = scale.largest === 0;
      if (is_first || value > scale.top / 2) Object.assign(scale, { largest: 0, since: now });
      scale.largest = Math.max(scale.largest, value);
      if (!is_first && value <= scale.top && now - scale.since < patience) continue;
      scale.top = text.round_up(scale.largest);
      Object.assign(scale, { largest: value, since: now });
    }
  }
  clear();
  return { scales, clear, widen };
}
