// Many copies of a few shapes, such as the arrows of all contacts.
"use strict";

// Each copy has one colour for all shapes, and a place for each. Everything is drawn twice: plainly where it is in
// sight, and faintly where a body hides it.
function make_instances(scene, shapes) {
  let capacity = 0, color = null, sets = [];

  function grow(size) {
    for (const { meshes } of sets) scene.remove(...meshes);
    for (const shape of shapes) shape.dispose();
    capacity = size;
    color = dynamic(new THREE.InstancedBufferAttribute(new Float32Array(3 * size), 3));
    sets = shapes.map((shape) => {
      shape.setAttribute("color", color);
      const plain = mesh_of(shape, {});
      const faint = mesh_of(shape,
        { transparent: true, opacity: 0.5, depthFunc: THREE.GreaterDepth, depthWrite: false });
      faint.renderOrder = 5;
      faint.instanceMatrix = dynamic(plain.instanceMatrix);
      return { meshes: [plain, faint], matrix: plain.instanceMatrix };
    });
  }
  function mesh_of(shape, settings) {
    const material = new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, ...settings });
    const mesh = new THREE.InstancedMesh(shape, material, capacity);
    mesh.frustumCulled = false;
    scene.add(mesh);
    return mesh;
  }
  // Shows the first `count` copies, which are then set, and after that uploaded.
  function show(count) {
    if (count > capacity) grow(Math.max(64, 2 * count));
    for (const { meshes } of sets)
      for (const mesh of meshes) {
        mesh.count = count;
        mesh.visible = count > 0;  // an instance count of zero would mean "not instanced"
      }
  }
  const set_color = (i, rgb) => color.array.set(rgb, 3 * i);
  const set_place = (shape, i, matrix) => matrix.toArray(sets[shape].matrix.array, 16 * i);
  function upload(count) {
    for (const [attribute, size] of [[color, 3], ...sets.map(({ matrix }) => [matrix, 16])]) {
      attribute.updateRange.count = size * count;
      attribute.needsUpdate = true;
    }
  }
  return { show, set_color, set_place, upload };
}

// An attribute that changes with every frame.
const dynamic = (attribute) => attribute.setUsage(THREE.DynamicDrawUsage);
