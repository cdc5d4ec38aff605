// The contacts: a dot each, and an arrow that grows with the root of the force, because impacts are a hundred times
// stronger than what lies at rest. Drawn twice: plainly where they are in sight, faintly where a body hides them,
// because contacts lie between bodies.
"use strict";

// A force of `full_force` (N) gets an arrow about as long as half a body is thick; dots leave room between vertices.
function make_contacts(scene, capacity, { size, spacing }, full_force) {
  const dot_radius = 0.2 * spacing, arrow_length = 0.75 * size, arrow_width = Math.min(1.1 * spacing, 0.2 * size);
  const color = new THREE.InstancedBufferAttribute(new Float32Array(3 * Math.max(capacity, 1)), 3);
  const dots = layers(new THREE.IcosahedronBufferGeometry(1, 1));
  const arrows = layers(arrow_geometry());
  const fixed = { open: 0, stick: 1, slide: 2 };
  const motion_colors = [];
  for (const name in fixed) motion_colors[fixed[name]] = colors.linear(colors.parse(colors.motion[name]));

  function layers(geometry) {
    geometry.setAttribute("color", color);
    const make = (settings) => {
      const material = new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, ...settings });
      const mesh = new THREE.InstancedMesh(geometry, material, Math.max(capacity, 1));
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

  const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), scale = new THREE.Vector3();
  const point = new THREE.Vector3(), force = new THREE.Vector3(), along = new THREE.Vector3(0, 1, 0);

  function show(contacts, mode) {
    const count = mode === "off" ? 0 : contacts.count;
    for (const mesh of [...dots, ...arrows]) {
      mesh.count = count;
      mesh.visible = count > 0;  // an instance count of zero would mean "not instanced"
    }
    for (let i = 0; i < count; ++i) {
      point.fromArray(contacts.point, 3 * i);
      for (const axis of ["x", "y", "z"]) {
        const k = axis === "x" ? 0 : axis === "y" ? 1 : 2;
        point[axis] = contacts.lower[k] + contacts.extent[k] * point[axis] / 65535;
      }
      force.fromArray(contacts.force, 3 * i).multiplyScalar(contacts.unit);
      const strength = force.length();
      const by_region = mode === "region" && contacts.region[i] !== 65535;
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
  return { show };
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
