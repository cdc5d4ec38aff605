// Sliders of the scene, which move colliders, cables and other things.
"use strict";

// list: {name, unit, low, high, value}. move(number, value) is called when the user moves a slider. show(values,
// number) sets the sliders to the values in the row with that number. A slider that the user has moved keeps its place
// until `patience` is over and a row has its value or `stale` more rows have come.
function make_sliders(host, list, move) {
  const patience = 500;  // ms after the last movement
  const stale = 3;       // rows that may come after a movement with values from before it
  let newest = 0;        // number of the last row
  const rows = list.map(({ name, unit, low, high, value: initial }, number) => {
    const label = document.createElement("label"), input = document.createElement("input");
    const about = document.createElement("span"), output = document.createElement("output");
    about.textContent = name;
    Object.assign(input, { id: "slider_" + number, type: "range", min: low, max: high, step: "any", value: initial,
      title: "Double-click or Delete: back to " + text.si(initial, unit) });
    label.append(about, output, input);
    const row = { label, range: high - low, moved: 0, last: 0, wanted: null };
    row.set = (value) => {
      input.disabled = value === null;  // its object was removed
      input.value = value;
      output.textContent = text.si(value, unit);
      input.setAttribute("aria-valuetext", output.textContent);
    };
    const moved_to = (value) => {
      Object.assign(row, { moved: performance.now(), last: newest + stale, wanted: value });
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
  const is_known = ({ wanted, last, moved, range }, value) => wanted === null
    || (performance.now() - moved > patience && (newest > last || Math.abs(value - wanted) <= 1e-9 * range));
  const show = (values, row_number) => {
    newest = row_number;
    values.forEach((value, number) => {
      const row = rows[number];
      if (!row || !is_known(row, value)) return;
      row.wanted = null;
      row.set(value);
    });
  };
  return { show };
}
