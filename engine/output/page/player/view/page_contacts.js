// The contacts: a dot each, and an arrow that grows with the root of the force, because impacts are a hundred times
// stronger than what lies at rest.
"use strict";

// A force of scales.force.top gets an arrow about as long as half a body is thick; the longest arrows are three times
// as long. Dots at neighbouring vertices do not touch.
function make_contacts(scene, { size, spacing }, scales) {
  const dot_radius = 0.2 * spacing, arrow_length = 0.75 * size, arrow_width = Math.min(1.1 * spacing, 0.2 * size);
  const copies = make_instances(scene, new THREE.IcosahedronBufferGeometry(1, 1), arrow_geometry());
  const fixed = { open: 0, stick: 1, slide: 2 };
  const motion_colors = [], region_colors = [];
  for (const name in fixed) motion_colors[fixed[name]] = colors.linear(colors.parse(colors.motion[name]));
  const color_of_region = (number) =>
    (region_colors[number] = region_colors[number] || colors.linear(colors.of_number(number)));

  const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), scale = new THREE.Vector3();
  const point = new THREE.Vector3(), force = new THREE.Vector3(), along = new THREE.Vector3(0, 1, 0);

  const shown = { list: null, count: 0, point: new Float32Array(0), force: new Float32Array(0),
    normal: new Float32Array(0) };
  function reserve(count) {
    if (count <= shown.normal.length) return;
    for (const [name, width] of [["point", 3], ["force", 3], ["normal", 1]])
      shown[name] = new Float32Array(2 * width * count);
  }

  // Rows between a frame and the next. Contacts of both frames are interpolated, the others are those of the frame.
  function blend_rows(contacts, next, blend) {
    Object.assign(shown, { list: contacts, count: contacts.count });
    for (let i = 0; i < contacts.count; ++i) {
      const row = blend > 0 && next ? contacts.next[i] : -1, share = row >= 0 ? blend : 0, j = Math.max(row, 0);
      const mix = (from, to, k, l) => (share > 0 ? (1 - share) * from[k] + share * to[l] : from[k]);
      for (let axis = 0; axis < 3; ++axis) {
        shown.point[3 * i + axis] = mix(contacts.point, next && next.point, 3 * i + axis, 3 * j + axis);
        shown.force[3 * i + axis] = mix(contacts.force, next && next.force, 3 * i + axis, 3 * j + axis);
      }
      shown.normal[i] = mix(contacts.normal, next && next.normal, i, j);
    }
  }
  function show(contacts, next, blend, mode) {
    const count = mode === "off" ? 0 : contacts.count;
    copies.show(count);
    shown.count = 0;
    if (count === 0) return;
    reserve(count);
    blend_rows(contacts, next, blend);
    for (let i = 0; i < count; ++i) {
      point.fromArray(shown.point, 3 * i);
      force.fromArray(shown.force, 3 * i);
      const strength = force.length();
      const by_region = mode === "region" && contacts.region[i] >= 0;
      const rgb = by_region ? color_of_region(contacts.region[i]) : motion_colors[contacts.state[i]];
      copies.set_color(i, rgb);
      const radius = strength > 0 ? dot_radius : 0.7 * dot_radius;
      copies.set_place(0, i, matrix.compose(point, turn.set(0, 0, 0, 1), scale.setScalar(radius)));
      if (strength > 0) turn.setFromUnitVectors(along, force.multiplyScalar(1 / strength));
      const length = Math.min(Math.sqrt(strength / scales.force.top), 3) * arrow_length;
      const width = Math.min(arrow_width, length / 3);
      copies.set_place(1, i, matrix.compose(point, turn, scale.set(width, length, width)));
    }
    copies.upload(count);
  }
  // The contact that is shown at row i.
  function at(i) {
    const { list } = shown, strength = Math.hypot(...shown.force.subarray(3 * i, 3 * i + 3));
    const normal = shown.normal[i];
    return { strength, normal, friction: Math.sqrt(Math.max(strength * strength - normal * normal, 0)),
      error: half_code(strength, list.top / (2047 * 2047)), region: list.region[i],
      motion: Object.keys(fixed)[list.state[i]], first: list.first[i], second: list.second[i],
      collider: list.collider[i] };
  }
  return { show, shown, at, dot_radius };
}

// An arrow along y from 0 to 1: a shaft and a head, without caps that nobody sees.
function arrow_geometry() {
  const shaft = new THREE.CylinderBufferGeometry(0.07, 0.07, 0.76, 8, 1, true);
  shaft.translate(0, 0.38, 0);
  const head = new THREE.CylinderBufferGeometry(0, 0.22, 0.28, 12, 1);
  head.translate(0, 0.86, 0);
  const geometry = new THREE.BufferGeometry();
  const points = [shaft, head].flatMap((part) => [...part.getAttribute("position").array]);
  const first_of_head = shaft.getAttribute("position").count;
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  geometry.setIndex([...shaft.index.array, ...[...head.index.array].map((i) => i + first_of_head)]);
  return geometry;
}
