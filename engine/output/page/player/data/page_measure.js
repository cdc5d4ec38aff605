// Size of the scene, from which follow the camera, and the sizes of arrows and dots.
"use strict";

// center, radius (m): of a sphere around the bodies of all frames, without the outermost 2 %, which may be bodies that
// fell off, and around colliders that are not much larger. course: by frame the box that the camera shows, the same in
// all frames if the bodies stay about where they begin. spacing (m): median distance of neighbouring surface vertices.
// size (m): half the edge of the median body.
function measure_scene(run, bodies, frames) {
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
      spacing.push(size * 3.8 / Math.sqrt(Math.max(bodies[number].vertices, 4)));
    }
  const unit = new THREE.Box3(new THREE.Vector3(-0.5, -0.5, -0.5), new THREE.Vector3(0.5, 0.5, 0.5));
  if (spacing.length === 0)
    return { center: new THREE.Vector3(), radius: 1, course: [unit], spacing: 0.1, size: 1 };
  const low = new THREE.Vector3(...lower.map((list) => share_of(list, 0.02)));
  const high = new THREE.Vector3(...upper.map((list) => share_of(list, 0.98)));
  const bodies_box = new THREE.Box3(low, high), boxes = frames.map(box_of_frame);
  const whole = bodies_box.clone().union(box_of_others(bodies_box, run.colliders, frames[0]));
  const nearby = box_of_others(boxes.find((box) => box !== null), run.colliders, frames[0]);
  const course = smooth_course(boxes, Math.max(2, Math.round(0.06 * frames.length))).map((box) => box.union(nearby));
  const still = radius_of(whole) < 1.5 * radius_of(course[0]);
  return {
    center: whole.getCenter(new THREE.Vector3()), radius: Math.max(radius_of(whole), 1e-6),
    course: still ? [whole] : course, spacing: share_of(spacing, 0.5), size: share_of(sizes, 0.5),
  };
}

// Returns a function from a frame of a live run to the box that the camera shows: the union of all frames so far, or
// the present frame if the union is much larger than the first frame. The box moves smoothly. If it
// is large enough, it contains the bodies. first: box of the first frame. seconds: wall time of the call [s].
function make_aim(first, time_constant = 0.3) {
  const whole = first.clone(), shown = first.clone();
  let last = -Infinity;
  return (frame, seconds) => {
    const now = box_of_frame(frame) || whole;
    whole.union(now);
    const wanted = radius_of(whole) < 1.5 * radius_of(first) ? whole : now;
    const share = 1 - Math.exp(-Math.max(seconds - last, 0) / time_constant);
    last = seconds;
    shown.min.lerp(wanted.min, share);
    shown.max.lerp(wanted.max, share);
    return shown.translate(shift_over(shown, now));
  };
}

// Smallest movement of `box` after which along each axis the smaller one of `box` and `other` is inside the larger one.
function shift_over(box, other) {
  const low = other.min.clone().sub(box.min), high = other.max.clone().sub(box.max);
  return new THREE.Vector3().clamp(low.clone().min(high), high.clone().max(low));
}

const share_of = (list, share) => list.sort((a, b) => a - b)[Math.round(share * (list.length - 1))];
const radius_of = (box) => box.min.distanceTo(box.max) / 2;

// Box around the points of lines that are near, and the colliders that are not much larger than `box`; the others are
// scenery. Empty if there are none.
function box_of_others(box, colliders, frame) {
  const center = box.getCenter(new THREE.Vector3()), reach = 2.5 * radius_of(box), out = new THREE.Box3();
  colliders.forEach((collider, number) => {
    const pose = frame.colliders.get(number);
    if (!pose || collider.kind === "plane") return;
    const other = box_of(collider, pose);
    if (Math.max(other.min.distanceTo(center), other.max.distanceTo(center)) < reach) out.union(other);
  });
  for (const { point } of frame.lines.list.values())
    for (let i = 0; i < point.length; i += 3) {
      const place = new THREE.Vector3().fromArray(point, i);
      if (place.distanceTo(center) < reach) out.expandByPoint(place);
    }
  return out;
}

// Box around the bodies of a frame, without those that are far from the others; null without bodies.
function box_of_frame(frame) {
  const boxes = [...frame.bodies.values()].map(({ lower, extent }) =>
    new THREE.Box3(new THREE.Vector3(...lower), new THREE.Vector3(...lower).add(new THREE.Vector3(...extent))));
  if (boxes.length === 0) return null;
  const centers = boxes.map((box) => box.getCenter(new THREE.Vector3()));
  const middle = new THREE.Vector3(...["x", "y", "z"].map((axis) => share_of(centers.map((c) => c[axis]), 0.5)));
  const usual = share_of(centers.map((center) => center.distanceTo(middle)), 0.75);
  const out = new THREE.Box3();
  boxes.forEach((box, i) => {
    if (centers[i].distanceTo(middle) <= 6 * usual + 2 * radius_of(box)) out.union(box);
  });
  return out;
}

// Boxes that contain those of the `wide` frames before and after, and change smoothly: corners are means of extremes.
function smooth_course(boxes, wide) {
  let last = boxes.find((box) => box !== null);
  const filled = boxes.map((box) => (last = box || last));
  const around = (list, i) => list.slice(Math.max(i - wide, 0), i + wide + 1);
  const extreme = filled.map((box, i) => around(filled, i).reduce((sum, other) => sum.union(other), new THREE.Box3()));
  return filled.map((box, i) => {
    const near = around(extreme, i), out = new THREE.Box3(new THREE.Vector3(), new THREE.Vector3());
    for (const other of near) {
      out.min.addScaledVector(other.min, 1 / near.length);
      out.max.addScaledVector(other.max, 1 / near.length);
    }
    return out;
  });
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
