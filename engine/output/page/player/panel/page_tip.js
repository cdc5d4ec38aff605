// The values under the pointer.
"use strict";

// hit: result of pick_body; contact: of make_contacts.at(); joining: of make_lines.at(). Each may be null. place: in
// pixels of the host. fields: names of the fields that have values.
function show_tip(tip, host, place, { hit, fields: known, values, body, color, contact, joining, name_of }) {
  tip.hidden = !hit && !contact && !joining;
  if (tip.hidden) return;
  tip.replaceChildren();
  const line = (content, strong) => {
    const made = document.createElement(strong ? "b" : "div");
    made.textContent = content;
    tip.append(made);
  };
  if (joining) {
    const { kind, name, force, error } = joining;
    line(kind[0].toUpperCase() + kind.slice(1) + ": " + name, true);
    const quantity = { cable: "tension", tie: "force on the node" }[kind] || "force";
    line(quantity + " " + text.si(force, "N", error));
  }
  if (contact) {
    const { first, second, collider, strength, normal, friction, error, motion, region } = contact;
    const sides = [first >= 0 && name_of.body(first), second >= 0 && name_of.body(second),
      collider >= 0 && name_of.collider(collider)].filter(Boolean);
    line("Contact: " + sides.join(" \u2013 "), true);
    line("force " + text.si(strength, "N", error) + ", normal " + text.si(normal, "N", error) + ", friction "
      + text.si(friction, "N", error));
    line(motion + (region >= 0 ? ", region " + region : ""));
  }
  if (hit) {
    const nearest = hit.weights.indexOf(Math.max(...hit.weights));
    line(body.name, true);
    const shown = [...known].sort((a, b) => (b === color) - (a === color));
    for (const field of shown)
      line(fields[field].lower + " " + fields[field].format(values[field].value, values[field].error));
    line((body.drawn.is_visual ? "visual triangle " : "triangle ") + hit.triangle + ", node "
      + body.shape.node[hit.vertices[nearest]]);
    line("at " + hit.point.toArray().map((x) => +x.toPrecision(4)).join(", ") + " m");
  }
  // Beside the pointer, on the side where there is room.
  const { clientWidth: width, clientHeight: height } = host, { offsetWidth: wide, offsetHeight: tall } = tip;
  tip.style.left = Math.max(place.x + 16 + wide < width ? place.x + 16 : place.x - wide - 12, 4) + "px";
  tip.style.top = Math.max(place.y + 16 + tall < height ? place.y + 16 : place.y - tall - 12, 4) + "px";
}
