// Summary of the run, in words and numbers.
"use strict";

const count_of = (number, one, more) => text.count(number) + " " + (number === 1 ? one : more);

function show_summary(find, run) {
  const r = run.report;
  find("title").textContent = run.title || "Run";
  find("subtitle").textContent = count_of(r.bodies, "body", "bodies") + ", "
    + count_of(r.elements, "element", "elements") + ", " + text.si(r.time, "s") + " in "
    + count_of(r.steps, "step", "steps");
  const items = [
    ["Bodies", text.count(r.bodies)], ["Elements", text.count(r.elements)],
    ["Nodes", text.count(r.nodes)], ["Steps", text.count(r.steps)],
    ["Simulated time", text.si(r.time, "s")], ["Mean step", r.steps ? text.si(r.time / r.steps, "s") : "\u2013"],
    ["Contacts, mean and maximum", text.average(r.mean_contacts) + ", " + text.count(r.max_contacts)],
    ["Regions, mean and maximum", text.average(r.mean_regions) + ", " + text.count(r.max_regions)],
    ["Largest region", count_of(r.largest_region, "contact", "contacts")],
    ["Iterations per solved region", text.average(r.mean_iterations)],
    ["Regions not converged", text.count(r.unconverged) + " of " + text.count(r.solved)],
    ["Largest penetration", r.max_penetration > 0 ? text.si(r.max_penetration, "m") : "none in any contact"],
  ];
  const add = (name, value) => {
    const item = document.createElement("div"), term = document.createElement("dt"),
      about = document.createElement("dd");
    term.textContent = name;
    about.append(value);
    item.append(term, about);
    find("summary").append(item);
    return item;
  };
  const add_wide = (name, value, ...look) => add(name, value).classList.add("wide", ...look);
  if (r.distrust) {
    const mark = document.createElement("b");
    mark.className = "warning";
    mark.textContent = " \u2013 not to be trusted";
    mark.title = r.distrust;
    find("subtitle").append(mark);
    add_wide("Not to be trusted", r.distrust, "warning");
  }
  for (const [name, value] of items) add(name, value);
  if (r.self_crossings.length === 0) add("Self-crossings", "none found");
  const left_out = new Set(run.visuals.flat().map((material) => material.left_out).filter(Boolean));
  for (const file of left_out) add_wide("Texture that is not part of the page", file);
  for (const message of r.self_crossings) add_wide("Self-crossing", message, "warning");
  const code = document.createElement("code");
  code.textContent = r.state_hash;
  add_wide("State hash", code);
}
