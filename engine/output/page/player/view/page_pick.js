// Objects under the pointer.
"use strict";

// Returns the nearest triangle of the shown bodies on a ray (origin, unit direction): {distance, point, body, triangle,
// vertices, weights}, or null. Values at the point are means of the values at these vertices with these weights.
function pick_body(bodies, origin, direction) {
  const ray = new THREE.Ray(origin, direction), hit = new THREE.Vector3();
  const corners = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  let best = null;
  bodies.forEach((body, number) => {
    if (!body.group.visible) return;
    const { geometry, support } = body.drawn;
    const position = geometry.getAttribute("position"), index = geometry.getIndex().array;
    if (!ray.intersectsBox(box_of_body(body))) return;
    for (let t = 0; t < index.length; t += 3) {
      corners.forEach((corner, k) => corner.fromArray(position.array, 3 * index[t + k]));
      if (!ray.intersectTriangle(...corners, false, hit)) continue;
      const distance = hit.distanceTo(origin);
      if (best && best.distance <= distance) continue;
      const weights = new THREE.Vector3();
      THREE.Triangle.getBarycoord(hit, ...corners, weights);
      const depends = weights.toArray().flatMap((share, k) =>
        support(index[t + k]).map(({ vertex, weight }) => ({ vertex, weight: share * weight })));
      best = { distance, point: hit.clone(), body: number, triangle: t / 3,
        weights: depends.map(({ weight }) => weight), vertices: depends.map(({ vertex }) => vertex) };
    }
  });
  return best;
}

// Box around the drawn surface of a body.
function box_of_body({ drawn }) {
  drawn.box = drawn.box || new THREE.Box3().setFromArray(drawn.geometry.getAttribute("position").array);
  return drawn.box;
}

// The row of make_lines().shown whose segment is nearest to a position in the picture (pixels), within `reach` of it;
// -1 if there is none.
function pick_line(shown, camera, { width, height }, { x, y }, reach) {
  const on_screen = (list, i) => {
    const point = new THREE.Vector3().fromArray(list, 3 * i).project(camera);
    return Math.abs(point.z) > 1 ? null
      : new THREE.Vector2((point.x + 1) / 2 * width - x, (1 - point.y) / 2 * height - y);
  };
  let best = -1, nearest = reach;
  for (let i = 0; i < shown.count; ++i) {
    const from = on_screen(shown.point, i), to = on_screen(shown.next, i);
    if (!from || !to) continue;
    const way = to.clone().sub(from), square = way.lengthSq();
    const share = square > 0 ? Math.min(Math.max(-from.dot(way) / square, 0), 1) : 0;
    const distance = from.addScaledVector(way, share).length();
    if (distance >= nearest) continue;
    nearest = distance;
    best = i;
  }
  return best;
}

// The contact whose dot is nearest to a position in the picture (pixels), within `reach` of it; -1 if there is none.
// Contacts behind bodies are included, because their dots show through the bodies.
function pick_contact(shown, camera, { width, height }, { x, y }, reach) {
  const point = new THREE.Vector3();
  let best = -1, nearest = reach;
  for (let i = 0; i < shown.count; ++i) {
    point.fromArray(shown.point, 3 * i).project(camera);
    if (Math.abs(point.z) > 1) continue;
    const distance = Math.hypot((point.x + 1) / 2 * width - x, (1 - point.y) / 2 * height - y);
    if (distance >= nearest) continue;
    nearest = distance;
    best = i;
  }
  return best;
}
