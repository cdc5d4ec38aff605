// The contacts: a dot each, and an arrow that grows with the root of the force, because impacts are a hundred times
// stronger than what lies at rest. Drawn twice: plainly where they are in sight, faintly where a body hides them,
// because contacts lie between bodies.
"use strict";

// A force of `full_force` (N) gets an arrow about as long as half a body is thick; dots leave room between vertices.
function make_contacts(scene, capacity, { size, spacing }, full_force) {
  const dot_radius = 0.2 * spacing, arrow_length = 0.75 * size, arrow_width = Math.min(1.1 * spacing, 0.2 * size);
  const color = new THREE.InstancedBufferAttribute(new Float32Array(3 * Math.max(capacity, 1)), 3);
  const dots = make_instances(scene, new THREE.IcosahedronBufferGeometry(1, 1), color);
  const arrows = make_instances(scene, arrow_geometry(), color);
  const fixed = { open: 0, stick: 1, slide: 2 };
  const motion_colors = [];
  for (const name in fixed) motion_colors[fixed[name]] = colors.linear(colors.parse(colors.motion[name]));

  const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), scale = new THREE.Vector3();
  const point = new THREE.Vector3(), force = new THREE.Vector3(), along = new THREE.Vector3(0, 1, 0);

  const shown = { list: null, count: 0, point: new Float32Array(3 * capacity), force: new Float32Array(3 * capacity),
    normal: new Float32Array(capacity) };

  // What is between a frame and the next: contacts that both have move from one to the other, others stay until they
  // are gone.
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
    show_instances([...dots, ...arrows], count);
    shown.count = 0;
    if (count === 0) return;
    blend_rows(contacts, next, blend);
    for (let i = 0; i < count; ++i) {
      point.fromArray(shown.point, 3 * i);
      force.fromArray(shown.force, 3 * i);
      const strength = force.length();
      const by_region = mode === "region" && contacts.region[i] >= 0;
      const rgb = by_region ? colors.linear(colors.of_number(contacts.region[i])) : motion_colors[contacts.state[i]];
      color.array.set(rgb, 3 * i);
      const radius = strength > 0 ? dot_radius : 0.7 * dot_radius;
      dots[0].setMatrixAt(i, matrix.compose(point, turn.set(0, 0, 0, 1), scale.setScalar(radius)));
      if (strength > 0) turn.setFromUnitVectors(along, force.multiplyScalar(1 / strength));
      const length = Math.sqrt(strength / full_force) * arrow_length, width = Math.min(arrow_width, length / 3);
      arrows[0].setMatrixAt(i, matrix.compose(point, turn, scale.set(width, length, width)));
    }
    color.needsUpdate = true;
    dots[0].instanceMatrix.needsUpdate = arrows[0].instanceMatrix.needsUpdate = true;
  }
  // The contact at row i as it is shown.
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

// Two meshes of many copies of a shape: one where they are in sight, and a faint one where a body hides them. `color`
// has a row for each copy.
function make_instances(scene, geometry, color) {
  geometry.setAttribute("color", color);
  const make = (settings) => {
    const material = new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, ...settings });
    const mesh = new THREE.InstancedMesh(geometry, material, color.count);
    mesh.frustumCulled = false;
    scene.add(mesh);
    return mesh;
  };
  const plain = make({});
  const faint = make({ transparent: true, opacity: 0.5, depthFunc: THREE.GreaterDepth, depthWrite: false });
  faint.renderOrder = 5;
  faint.instanceMatrix = plain.instanceMatrix;
  return [plain, faint];
}

function show_instances(meshes, count) {
  for (const mesh of meshes) {
    mesh.count = count;
    mesh.visible = count > 0;  // an instance count of zero would mean "not instanced"
  }
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
