// Pulls bodies with the pointer.
"use strict";

// link: page_link.js. The target of the pull moves in the plane that faces the camera and contains the grabbed point.
function make_pull(page, link) {
  let held = null;  // the grabbed point: {body, weights, vertices, plane, to, moved, force}

  function grab(x, y) {
    const { view, bodies } = page.scene, { origin, direction } = view.ray(x, y);
    const hit = link.is_open() ? pick_body(bodies.list, origin, direction) : null;
    if (!hit) return false;
    const facing = view.camera.getWorldDirection(new THREE.Vector3());
    held = { ...hit, plane: new THREE.Plane().setFromNormalAndCoplanarPoint(facing, hit.point), to: hit.point.clone(),
      moved: false, force: 0 };
    link.send({ do: "pull", body: hit.body, point: hit.point.toArray(), to: held.to.toArray() });
    page.scene.set_over(draw);
    return true;
  }
  function drag(x, y) {
    if (held && page.scene.view.ray(x, y).intersectPlane(held.plane, held.to)) held.moved = true;
  }
  function forget() {
    if (held) page.scene.set_over(null);
    held = null;
  }
  function drop() {
    if (held) link.send({ do: "release" });
    forget();
  }
  // pull: that of a new row, or null.
  const measured = (pull) => { if (held) held.force = pull ? pull.force : 0; };
  // Sends the last movement. The loop of the page calls it.
  function tick() {
    if (!held) return;
    if (!page.scene.bodies.list[held.body]) return drop();
    if (!held.moved) return;
    held.moved = false;
    link.send({ do: "move", to: held.to.toArray() });
    page.scene.set_over(draw);
  }

  // A line from the point of the body to the pointer, with the force.
  function draw(pen, ratio, { text: color, halo }) {
    const { view, bodies } = page.scene, body = bodies.list[held.body], { width, height } = pen.canvas;
    if (!body) return;
    const from = new THREE.Vector3();
    held.vertices.forEach((vertex, k) =>
      from.addScaledVector(new THREE.Vector3().fromArray(body.points, 3 * vertex), held.weights[k]));
    const [a, b] = [from, held.to.clone()].map((point) => {
      point.project(view.camera);
      return { x: (point.x + 1) / 2 * width / ratio, y: (1 - point.y) / 2 * height / ratio };
    });
    pen.save();
    pen.scale(ratio, ratio);
    pen.lineJoin = "round";
    pen.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
    const label = text.si(held.force, "N");
    for (const [style, wide] of [[halo, 5], [color, 2]]) {
      Object.assign(pen, { strokeStyle: style, fillStyle: style, lineWidth: wide });
      pen.beginPath();
      pen.moveTo(a.x, a.y);
      pen.lineTo(b.x, b.y);
      pen.moveTo(b.x + 5, b.y);
      pen.arc(b.x, b.y, 5, 0, 2 * Math.PI);
      pen.stroke();
      if (style === halo) pen.strokeText(label, b.x + 12, b.y - 8);
      else pen.fillText(label, b.x + 12, b.y - 8);
    }
    pen.restore();
  }
  return { grab, drag, drop, forget, measured, tick };
}
