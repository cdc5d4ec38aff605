// What the run was, in words and numbers.
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
    ["Largest penetration", text.si(r.max_penetration, "m")],
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
  for (const [name, value] of items) add(name, value);
  const code = document.createElement("code");
  code.textContent = r.state_hash;
  add("State hash", code).className = "wide";
}
