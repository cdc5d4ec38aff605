// Draws many dots and shafts, such as the arrows of all contacts.
"use strict";

// Each copy has a colour and two shapes with a place each: a dot, and a shaft, which goes from 0 to 1 along its y axis.
// More than `most_solid` copies would be slow and hide each other, so they are drawn as points and lines.
function make_instances(scene, dot, shaft) {
  const most_solid = 1000;
  let capacity = 0, sets = [];

  function grow(size, is_solid) {
    for (const { meshes } of sets) {
      scene.remove(...meshes);
      meshes[0].geometry.dispose();
    }
    capacity = size;
    sets = is_solid ? [dot, shaft].map((shape) => solid_set(scene, shape, size))
      : [vertex_set(scene, THREE.Points, THREE.PointsMaterial, size, 1),
        vertex_set(scene, THREE.LineSegments, THREE.LineBasicMaterial, size, 2)];
  }
  // Shows the first `count` copies. After it, set_color() and set_place() set each copy, and upload() ends the update.
  function show(count) {
    if (count > capacity) {
      const is_solid = count <= most_solid;
      grow(is_solid ? most_solid : 2 * count, is_solid);
    }
    for (const { meshes, limit } of sets) {
      limit(count);
      for (const mesh of meshes) mesh.visible = count > 0;  // three.js draws all instances if their count is 0
    }
  }
  const set_color = (i, rgb) => sets.forEach((set) => set.color(i, rgb));
  const set_place = (shape, i, matrix) => sets[shape].place(i, matrix);
  const upload = (count) => sets.forEach((set) => set.attributes.forEach((attribute) => {
    attribute.updateRange.count = attribute.itemSize * (set.width || 1) * count;
    attribute.needsUpdate = true;
  }));
  return { show, set_color, set_place, upload };
}

// Two meshes of the same shape: one for visible parts, and a faint one for parts behind bodies.
function drawn_twice(scene, Material, make) {
  const faint = { transparent: true, opacity: 0.5, depthFunc: THREE.GreaterDepth, depthWrite: false };
  return [{}, faint].map((look, pass) => {
    const mesh = make(new Material({ vertexColors: THREE.VertexColors, ...look }));
    mesh.frustumCulled = false;
    mesh.renderOrder = 5 * pass;
    scene.add(mesh);
    return mesh;
  });
}

function solid_set(scene, shape, size) {
  const color = dynamic(new THREE.InstancedBufferAttribute(new Float32Array(3 * size), 3));
  shape.setAttribute("color", color);
  const meshes = drawn_twice(scene, THREE.MeshBasicMaterial,
    (material) => new THREE.InstancedMesh(shape, material, size));
  const matrices = meshes[1].instanceMatrix = dynamic(meshes[0].instanceMatrix);
  return {
    meshes, attributes: [color, matrices],
    limit: (count) => meshes.forEach((mesh) => { mesh.count = count; }),
    color: (i, rgb) => color.array.set(rgb, 3 * i),
    place: (i, matrix) => matrix.toArray(matrices.array, 16 * i),
  };
}

// width: number of vertices of a copy: one point, or the two ends of a line.
function vertex_set(scene, Type, Material, size, width) {
  const geometry = new THREE.BufferGeometry();
  const [position, color] = ["position", "color"].map((name) => {
    const attribute = dynamic(new THREE.BufferAttribute(new Float32Array(3 * width * size), 3));
    geometry.setAttribute(name, attribute);
    return attribute;
  });
  const meshes = drawn_twice(scene, Material, (material) => new Type(geometry, material));
  return {
    meshes, width, attributes: [position, color],
    limit: (count) => geometry.setDrawRange(0, width * count),
    color: (i, rgb) => { for (let k = 0; k < width; ++k) color.array.set(rgb, 3 * (width * i + k)); },
    place: (i, { elements: m }) => {
      for (let k = 0; k < width; ++k)
        for (let axis = 0; axis < 3; ++axis)
          position.array[3 * (width * i + k) + axis] = m[12 + axis] + k * m[4 + axis];
      if (i === 0) for (const { material } of meshes) material.size = 6 * m[0];  // pixels of a diameter of 2 m[0]
    },
  };
}

// An attribute that changes with every frame.
const dynamic = (attribute) => attribute.setUsage(THREE.DynamicDrawUsage);
