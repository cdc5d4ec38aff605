// The bodies: one mesh each, moved and coloured by frame.
"use strict";

function make_bodies(scene, list, legend_top) {
  const bodies = list.map((body, number) => make_body(scene, body, number));

  // What `frame` shows, moved towards the next frame by `blend` in [0, 1).
  function show(frame, next, blend, color) {
    let count = 0;
    bodies.forEach((body, number) => {
      const now = frame.bodies.get(number);
      body.group.visible = now !== undefined;
      if (!now) return;
      ++count;
      const then = blend > 0 && next ? next.bodies.get(number) : undefined;
      place(body, now, then, then ? blend : 0);
      paint(body, now, color, legend_top);
    });
    return count;
  }
  function style({ flat, wire, xray }) {
    for (const { material, edges, mesh } of bodies) {
      if (material.flatShading !== flat || material.transparent !== xray) material.needsUpdate = true;
      material.flatShading = flat;
      material.transparent = xray;
      material.opacity = xray ? 0.32 : 1;
      material.depthWrite = !xray;
      mesh.castShadow = !xray;
      edges.visible = wire;
    }
  }
  return { show, style };
}

function make_body(scene, body, number) {
  const geometry = new THREE.BufferGeometry();
  const index = decode.words(body.triangles);
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  for (const name of ["position", "normal", "color"])
    geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * body.vertices), 3));
  const material = new THREE.MeshStandardMaterial({
    vertexColors: THREE.VertexColors, roughness: 0.62, metalness: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = true;
  mesh.frustumCulled = false;  // its bounds change with every frame

  const lines = new THREE.BufferGeometry();
  lines.setIndex(new THREE.BufferAttribute(edges_of(index, body.vertices), 1));
  lines.setAttribute("position", geometry.getAttribute("position"));
  const edges = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: 0x05080b, transparent: true, opacity: 0.38 }));
  edges.frustumCulled = false;

  const group = new THREE.Group();
  group.add(mesh, edges);
  scene.add(group);
  return { group, mesh, geometry, material, edges, own_color: colors.linear(colors.of_body(number)), painted: "" };
}

// Each edge once, although two triangles have it.
function edges_of(index, vertices) {
  const seen = new Set(), out = [];
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = Math.min(index[t + k], index[t + (k + 1) % 3]), b = Math.max(index[t + k], index[t + (k + 1) % 3]);
      if (seen.has(a * vertices + b)) continue;
      seen.add(a * vertices + b);
      out.push(a, b);
    }
  return new Uint32Array(out);
}

function place(body, now, then, blend) {
  const attribute = body.geometry.getAttribute("position"), out = attribute.array;
  for (let axis = 0; axis < 3; ++axis) {
    const scale = (1 - blend) * now.extent[axis] / 65535, scale_then = then ? blend * then.extent[axis] / 65535 : 0;
    const start = (1 - blend) * now.lower[axis] + (then ? blend * then.lower[axis] : 0);
    const codes = now.position, codes_then = then ? then.position : now.position;
    for (let i = axis; i < out.length; i += 3) out[i] = start + scale * codes[i] + scale_then * codes_then[i];
  }
  attribute.needsUpdate = true;
  body.geometry.computeVertexNormals();
}

function paint(body, now, color, legend_top) {
  const attribute = body.geometry.getAttribute("color"), out = attribute.array;
  if (color === "body") {
    if (body.painted === "body") return;
    for (let i = 0; i < out.length; i += 3) out.set(body.own_color, i);
  } else {
    const table = colors.tables[color], codes = now[color], scale = now.top[color] / legend_top[color];
    for (let i = 0; i < codes.length; ++i) {
      const row = 3 * Math.min(255, Math.round(codes[i] * scale));
      out[3 * i] = table[row];
      out[3 * i + 1] = table[row + 1];
      out[3 * i + 2] = table[row + 2];
    }
  }
  body.painted = color;
  attribute.needsUpdate = true;
}
