// The bodies: one mesh each, moved and coloured by frame.
"use strict";

function make_bodies(scene, list, frames, legend_top) {
  const first_of = (number) => frames.find((frame) => frame.bodies.has(number)).bodies.get(number);
  const bodies = list.map((body, number) => make_body(scene, body, number, first_of(number)));

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

// `shape` is the body in the first frame that has it.
function make_body(scene, body, number, shape) {
  const geometry = new THREE.BufferGeometry();
  const { index, source } = split_creases(decode.words(body.triangles), shape);
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  for (const name of ["position", "normal", "color"])
    geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * source.length), 3));
  const material = new THREE.MeshStandardMaterial({
    vertexColors: THREE.VertexColors, roughness: 0.62, metalness: 0, polygonOffset: true, polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = true;
  mesh.frustumCulled = false;  // its bounds change with every frame

  const lines = new THREE.BufferGeometry();
  lines.setIndex(new THREE.BufferAttribute(edges_of(index, source, body.vertices), 1));
  lines.setAttribute("position", geometry.getAttribute("position"));
  const edges = new THREE.LineSegments(lines,
    new THREE.LineBasicMaterial({ color: 0x05080b, transparent: true, opacity: 0.38 }));
  edges.frustumCulled = false;

  const group = new THREE.Group();
  group.add(mesh, edges);
  scene.add(group);
  return { group, mesh, geometry, material, edges, source, own_color: colors.linear(colors.of_body(number)),
    painted: "" };
}

// Vertices once for each smooth patch around them: where faces meet at more than 55 degrees (a box, not a coarse ball),
// shading breaks. index: triangles of the split vertices; source: the vertex that each of them was.
function split_creases(index, shape) {
  const smooth = Math.cos(55 * Math.PI / 180);
  const at = (vertex) => new THREE.Vector3(...[0, 1, 2].map((k) => shape.position[3 * vertex + k] * shape.extent[k]));
  const normals = [], patches = [], source = [], out = new Uint32Array(index.length);
  for (let t = 0; t < index.length; t += 3) {
    const a = at(index[t]);
    normals.push(at(index[t + 1]).sub(a).cross(at(index[t + 2]).sub(a)).normalize());
  }
  index.forEach((vertex, corner) => {
    const normal = normals[Math.floor(corner / 3)];
    patches[vertex] = patches[vertex] || [];
    let patch = patches[vertex].find(({ members }) => members.some((other) => other.dot(normal) > smooth));
    if (!patch) {
      patch = { number: source.length, members: [] };
      source.push(vertex);
      patches[vertex].push(patch);
    }
    patch.members.push(normal);
    out[corner] = patch.number;
  });
  return { index: out, source: new Uint32Array(source) };
}

// Each edge once, although two triangles have it and creases double its ends.
function edges_of(index, source, vertices) {
  const seen = new Set(), out = [];
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = index[t + k], b = index[t + (k + 1) % 3];
      const key = Math.min(source[a], source[b]) * vertices + Math.max(source[a], source[b]);
      if (seen.has(key)) continue;
      seen.add(key);
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
    for (let i = axis, row = 0; i < out.length; i += 3, ++row) {
      const from = 3 * body.source[row] + axis;
      out[i] = start + scale * codes[from] + scale_then * codes_then[from];
    }
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
    for (let i = 0; i < body.source.length; ++i) {
      const row = 3 * Math.min(255, Math.round(codes[body.source[i]] * scale));
      out[3 * i] = table[row];
      out[3 * i + 1] = table[row + 1];
      out[3 * i + 2] = table[row + 2];
    }
  }
  body.painted = color;
  attribute.needsUpdate = true;
}
