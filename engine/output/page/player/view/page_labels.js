// Names of bodies and colliders over the picture.
"use strict";

// Draws each name above its body, beginning with the nearest body. A name that would cover another name is left out. A
// name that a card of the page would cover is moved to below the card. covered: rectangles of the cards. Sizes are in
// pixels of the page; ratio: pixels of the pen per pixel of the page.
function draw_labels(pen, named, camera, { width, height, covered }, ratio, style) {
  const point = new THREE.Vector3(), places = [];
  for (const { name, box } of named) {
    point.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, (box.min.z + box.max.z) / 2);
    const distance = point.distanceTo(camera.position);
    // The middle of the upper edge of the box as the camera sees it.
    let left = Infinity, right = -Infinity, top = Infinity, behind = false;
    for (let corner = 0; corner < 8; ++corner) {
      point.set(...["x", "y", "z"].map((axis, k) => (corner >> k & 1 ? box.max : box.min)[axis])).project(camera);
      behind = behind || Math.abs(point.z) > 1;
      left = Math.min(left, point.x);
      right = Math.max(right, point.x);
      top = Math.min(top, 1 - point.y);
    }
    if (!behind) places.push({ name, distance, x: ((left + right) / 2 + 1) / 2 * width, y: top / 2 * height - 4 });
  }
  places.sort((a, b) => a.distance - b.distance);
  pen.save();
  pen.scale(ratio, ratio);
  pen.font = "12px system-ui, 'DejaVu Sans', sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  pen.lineJoin = "round";
  const taken = [];
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  for (const { name, x, y: wanted } of places) {
    const half = pen.measureText(name).width / 2 + 3;
    const place = { left: x - half, right: x + half, top: wanted - 15, bottom: wanted };
    if (place.right < 0 || place.left > width || wanted < 0 || wanted > height + 15) continue;
    for (const card of covered)
      if (overlap(place, card)) Object.assign(place, { top: card.bottom + 3, bottom: card.bottom + 18 });
    if ([...taken, ...covered].some((other) => overlap(place, other))) continue;
    const y = place.bottom;
    taken.push(place);
    pen.lineWidth = 3;
    pen.strokeStyle = style.halo;
    pen.strokeText(name, x, y);
    pen.fillStyle = style.text;
    pen.fillText(name, x, y);
  }
  pen.restore();
  return taken.length;
}
