// The bodies: one mesh each, moved and coloured by frame.
"use strict";

// legend_top, largest: by field.
function make_bodies(scene, list, frames, legend_top, largest) {
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
      const parts = [{ frame, body: now, share: then ? 1 - blend : 1 }];
      if (then) parts.push({ frame: next, body: then, share: blend });
      place(body, parts);
      paint(body, parts, color, legend_top);
      body.parts = parts;
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
  // What is at a point of a triangle: {field: {value, error}}.
  function values_at({ body, vertices, weights }) {
    const out = {};
    for (const field of field_names) {
      let value = 0, error = 0;
      for (const { frame, body: shown, share } of bodies[body].parts)
        vertices.forEach((vertex, k) => {
          const code = shown[field][vertex], one = code * code * frame.scale[field];
          value += share * weights[k] * one;
          error = Math.max(error, half_code(one, frame.scale[field]));
        });
      out[field] = { value: value < 1e-9 * largest[field] ? 0 : value, error };  // below it is rounding of the run
    }
    return out;
  }
  return { show, style, values_at, list: bodies };
}

// `shape` is the body in the first frame that has it.
function make_body(scene, body, number, shape) {
  const geometry = new THREE.BufferGeometry();
  const { index, source } = split_creases(body.triangles, shape);
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
  return { group, mesh, geometry, material, edges, source, shape: body, parts: [], name: body.name || "body " + number,
    own_color: colors.linear(colors.of_body(number)), painted: "" };
}

// Vertices once for each smooth patch around them: where faces meet at more than 55 degrees (a box, not a coarse ball),
// shading breaks. index: triangles of the split vertices; source: the vertex that each of them was.
function split_creases(index, shape) {
  const smooth = Math.cos(55 * Math.PI / 180);
  const at = (vertex) => new THREE.Vector3().fromArray(shape.offset, 3 * vertex);
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

// parts: what is shown of one frame or two, with shares that add up to one.
function place(body, parts) {
  const attribute = body.geometry.getAttribute("position"), out = attribute.array, { step } = body.shape;
  const [now, then = { share: 0, body: parts[0].body }] = parts;
  for (let axis = 0; axis < 3; ++axis) {
    const start = now.share * now.body.lower[axis] + then.share * then.body.lower[axis];
    const scale = now.share * step, scale_then = then.share * step;
    const codes = now.body.offset, codes_then = then.body.offset;
    for (let i = axis, row = 0; i < out.length; i += 3, ++row) {
      const from = 3 * body.source[row] + axis;
      out[i] = start + scale * codes[from] + scale_then * codes_then[from];
    }
  }
  attribute.needsUpdate = true;
  body.box = null;  // page_pick.js
  body.geometry.computeVertexNormals();
}

function paint(body, parts, color, legend_top) {
  const attribute = body.geometry.getAttribute("color"), out = attribute.array;
  if (color === "body") {
    if (body.painted === "body") return;
    for (let i = 0; i < out.length; i += 3) out.set(body.own_color, i);
  } else {
    const table = colors.tables[color], [now, then = { share: 0, ...parts[0] }] = parts;
    const scale = (part) => 255 / legend_top[color] * part.share * part.frame.scale[color];
    const scale_now = scale(now), scale_then = parts.length > 1 ? scale(then) : 0;
    const codes = now.body[color], codes_then = then.body[color];
    for (let i = 0; i < body.source.length; ++i) {
      const a = codes[body.source[i]], b = codes_then[body.source[i]];
      const row = 3 * Math.min(255, Math.round(a * a * scale_now + b * b * scale_then));
      out[3 * i] = table[row];
      out[3 * i + 1] = table[row + 1];
      out[3 * i + 2] = table[row + 2];
    }
  }
  body.painted = color;
  attribute.needsUpdate = true;
}
