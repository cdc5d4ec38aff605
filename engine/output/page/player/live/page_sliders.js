// Sliders of the scene, which move colliders, cables and other things.
"use strict";

// list: {name, unit, low, high, value}. move(number, value) is called when the user moves a slider. show(values) sets
// all sliders that the user is not moving.
function make_sliders(host, list, move) {
  const patience = 500;  // ms after the last movement
  const rows = list.map(({ name, unit, low, high, value: initial }, number) => {
    const label = document.createElement("label"), input = document.createElement("input");
    const about = document.createElement("span"), output = document.createElement("output");
    about.textContent = name;
    Object.assign(input, { id: "slider_" + number, type: "range", min: low, max: high, step: "any", value: initial,
      title: "Double-click or Delete: back to " + text.si(initial, unit) });
    label.append(about, output, input);
    const row = { label, moved: -Infinity };
    row.set = (value) => {
      input.value = value;
      output.textContent = text.si(value, unit);
      input.setAttribute("aria-valuetext", output.textContent);
    };
    const moved_to = (value) => {
      row.moved = performance.now();
      row.set(value);
      move(number, value);
    };
    input.addEventListener("input", () => moved_to(Number(input.value)));
    input.addEventListener("dblclick", () => moved_to(initial));
    input.addEventListener("keydown", ({ key }) => { if (key === "Delete") moved_to(initial); });
    row.set(initial);
    return row;
  });
  host.replaceChildren(...rows.map(({ label }) => label));
  const show = (values) => values.forEach((value, number) => {
    const row = rows[number];
    if (row && performance.now() - row.moved > patience) row.set(value);
  });
  return { show };
}
