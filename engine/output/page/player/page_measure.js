// How large the scene is: what the camera shows, and how large arrows and dots are.
"use strict";

// center, radius (m): around nearly all of where bodies go. The few ends that stick out may be bodies that fell off.
// corners: of what the camera shows at first, with colliders that are not much larger. spacing (m): of surface
// vertices, usually.
function measure_scene(run, frames) {
  const lower = [[], [], []], upper = [[], [], []], spacing = [], sizes = [];
  for (const frame of frames)
    for (const [number, body] of frame.bodies) {
      for (let k = 0; k < 3; ++k) {
        lower[k].push(body.lower[k]);
        upper[k].push(body.lower[k] + body.extent[k]);
      }
      const size = Math.hypot(...body.extent) / Math.sqrt(12);  // half the edge of a cube with this diagonal
      sizes.push(size);
      // A sphere of that size has an area of 4 pi size^2, which its vertices share in cells of 0.87 spacing^2.
      spacing.push(size * 3.8 / Math.sqrt(Math.max(run.bodies[number].vertices, 4)));
    }
  if (spacing.length === 0) return { center: new THREE.Vector3(), radius: 1, corners: [], spacing: 0.1, size: 1 };
  const part = (list, share) => list.sort((a, b) => a - b)[Math.round(share * (list.length - 1))];
  const low = new THREE.Vector3(...lower.map((list) => part(list, 0.02)));
  const high = new THREE.Vector3(...upper.map((list) => part(list, 0.98)));
  const bodies = new THREE.Box3(low, high), shown = bodies.clone();
  const center = bodies.getCenter(new THREE.Vector3()), radius = Math.max(low.distanceTo(high) / 2, 1e-6);
  run.colliders.forEach((collider, number) => {
    const pose = frames[0].colliders.get(number);
    if (!pose || collider.kind === "plane") return;
    const box = box_of(collider, pose);
    const reach = Math.max(box.min.distanceTo(center), box.max.distanceTo(center));
    if (reach < 2.5 * radius) shown.union(box);
  });
  const corners = [];
  for (const x of [shown.min.x, shown.max.x])
    for (const y of [shown.min.y, shown.max.y])
      for (const z of [shown.min.z, shown.max.z]) corners.push(new THREE.Vector3(x, y, z));
  const middle = shown.getCenter(new THREE.Vector3());
  const around = Math.max(middle.distanceTo(corners[0]), 1e-6);
  return { center: middle, radius: around, corners, spacing: part(spacing, 0.5), size: part(sizes, 0.5) };
}

function box_of(collider, pose) {
  const points = decode.floats(collider.points), turn = new THREE.Quaternion(), box = new THREE.Box3(),
    point = new THREE.Vector3();
  turn_from(turn, pose.rotation);
  for (let i = 0; i < points.length; i += 3) {
    point.fromArray(points, i).applyQuaternion(turn);
    box.expandByPoint(point.add(new THREE.Vector3(...pose.position)));
  }
  return box;
}

// A rotation from axis times angle.
function turn_from(quaternion, rotation) {
  const axis = new THREE.Vector3(...rotation), angle = axis.length();
  return angle > 0 ? quaternion.setFromAxisAngle(axis.multiplyScalar(1 / angle), angle) : quaternion.set(0, 0, 0, 1);
}
