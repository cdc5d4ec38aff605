// Legends of colours, arrows and tubes.
"use strict";

// The ends and the middle of a field's colours, as text.
function legend_ticks(field, scales) {
  const { format } = fields[field], { top, max } = scales[field];
  return ["0", format(top / 2), (max > top ? "\u2265\u202f" : "") + format(top)];
}

// A line of text after a spot of the colour, if there is one.
function legend_line(content, swatch) {
  const line = document.createElement("div");
  line.title = content;
  if (swatch) {
    const spot = document.createElement("i");
    spot.className = "swatch";
    spot.style.background = swatch;
    line.append(spot);
  }
  line.append(content);
  return line;
}

// bodies: {name} by number.
function show_color_legend(card, color, bodies, scales) {
  const [name, bar, ticks, list] = card.children, by_value = color !== "body", names = [];
  if (!by_value) bodies.forEach((body, i) => names.push([i, body.name || "body " + i]));
  const content = JSON.stringify(by_value ? [color, legend_ticks(color, scales)] : names);
  if (card.dataset.content === content) return;  // it is called often, and the list of bodies may be scrolled
  card.dataset.content = content;
  bar.hidden = ticks.hidden = !by_value;
  list.hidden = by_value;
  if (!by_value) {
    name.textContent = count_of(names.length, "body", "bodies");
    list.replaceChildren(...names.map(([i, shown]) => legend_line(shown, colors.css(colors.of_body(i)))));
    return;
  }
  name.textContent = fields[color].name;
  const pen = bar.getContext("2d");
  for (let i = 0; i < 256; ++i) {
    pen.fillStyle = colors.css(colors.at(color, i / 255));
    pen.fillRect(i, 0, 1, 1);
  }
  ticks.replaceChildren(...legend_ticks(color, scales).map((tick) => {
    const label = document.createElement("span");
    label.textContent = tick;
    return label;
  }));
}

function show_line_legend(card, on, run, scales) {
  const kinds = Object.keys(colors.line).filter((kind) => run.lines.some((line) => line.kind === kind));
  card.hidden = !on || kinds.length === 0;
  card.replaceChildren(...kinds.map((kind) => legend_line(kind, colors.line[kind])),
    legend_line("thickness: square root of the force"),
    legend_line(scales.line_force.about + " " + text.si(scales.line_force.max, "N")));
}

function show_contact_legend(card, mode, scales) {
  card.hidden = mode === "off" || scales.force.peak === 0;
  card.replaceChildren();
  if (mode === "motion")
    card.append(...["stick", "slide", "open"].map((name) => legend_line(name, colors.motion[name])));
  else
    card.append(legend_line("one colour per contact region"));
  card.append(legend_line("arrow length: square root of the force"),
    legend_line(scales.force.about + " " + text.si(scales.force.max, "N")));
}
