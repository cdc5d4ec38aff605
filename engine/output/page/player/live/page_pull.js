// Pulls bodies with the pointer or with keys.
"use strict";

// link: page_link.js. The target of the pull moves in the plane that faces the camera and contains the grabbed point.
function make_pull(page, link) {
  let held = null;  // the grabbed point: {body, weights, vertices, plane, to, moved, force}

  function grab(x, y) {
    drop();
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
  // Grabs the body in the middle of the view, or the one whose middle is drawn nearest to it. Returns false if none is
  // hit.
  function grab_middle() {
    const { canvas } = page.scene.view, x = canvas.clientWidth / 2, y = canvas.clientHeight / 2;
    const places = page.scene.bodies.list.filter((body) => body.group.visible)
      .map((body) => on_screen(box_of_body(body).getCenter(new THREE.Vector3())))
      .sort((a, b) => Math.hypot(a.x - x, a.y - y) - Math.hypot(b.x - x, b.y - y));
    return [{ x, y }, ...places].some((place) => grab(place.x, place.y));
  }
  // Moves the target in the plane of the pull, by shares of the height of the view. Returns false if nothing is pulled.
  function shift(right, up) {
    if (!held) return false;
    const { camera } = page.scene.view, depth = -held.to.clone().applyMatrix4(camera.matrixWorldInverse).z;
    const height = 2 * depth * Math.tan(THREE.Math.degToRad(camera.fov / 2));
    [right, up].forEach((share, axis) =>
      held.to.addScaledVector(new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, axis), share * height));
    held.moved = true;
    return true;
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

  // Place in the picture [pixels].
  function on_screen(point) {
    const { camera, canvas } = page.scene.view, { x, y } = point.clone().project(camera);
    return { x: (x + 1) / 2 * canvas.clientWidth, y: (1 - y) / 2 * canvas.clientHeight };
  }
  // A line from the point of the body to the target, with the force.
  function draw(pen, ratio, { text: color, halo }) {
    const body = page.scene.bodies.list[held.body];
    if (!body) return;
    const from = new THREE.Vector3();
    held.vertices.forEach((vertex, k) =>
      from.addScaledVector(new THREE.Vector3().fromArray(body.points, 3 * vertex), held.weights[k]));
    const [a, b] = [from, held.to].map(on_screen);
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
  return { grab, grab_middle, drag, shift, drop, forget, measured, tick, is_held: () => held !== null };
}
