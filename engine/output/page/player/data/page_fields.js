// The fields of values at vertices, in the order in which page_stream.h packs them.
"use strict";

const fields = {
  speed: { name: "Speed", lower: "speed", format: (value, error) => text.si(value, "m/s", error) },
  stress: {
    name: "Von Mises stress", lower: "von Mises stress", format: (value, error) => text.si(value, "Pa", error),
  },
  strain: {
    name: "Equivalent strain", lower: "equivalent strain", format: (value, error) => text.percent(value, error),
  },
  error: {
    name: "Local error of the stress: refine where it is large", lower: "mesh error",
    format: (value, error) => text.percent(value, error),
  },
};
const field_names = Object.keys(fields);

// Values are squares of codes times a scale: half a code is this much.
const half_code = (value, scale) => Math.sqrt(value * scale) + scale / 4;
