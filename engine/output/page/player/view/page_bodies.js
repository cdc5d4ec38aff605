// The bodies: moved and coloured by frame.
"use strict";

// visuals: the visual surface of each body, or undefined. legend_top, largest: by field. redraw(): an image was loaded.
function make_bodies(scene, list, visuals, frames, legend_top, largest, redraw) {
  const first_of = (number) => frames.find((frame) => frame.bodies.has(number)).bodies.get(number);
  const bodies = list.map((body, number) => make_body(scene, body, visuals[number], number, first_of(number), redraw));

  // What `frame` shows, moved towards the next frame by `blend` in [0, 1). `visual`: draw visual surfaces.
  function show(frame, next, blend, color, visual) {
    let count = 0;
    bodies.forEach((body, number) => {
      const now = frame.bodies.get(number);
      body.group.visible = now !== undefined;
      if (!now) return;
      ++count;
      const then = blend > 0 && next ? next.bodies.get(number) : undefined;
      const parts = [{ frame, body: now, share: then ? 1 - blend : 1 }];
      if (then) parts.push({ frame: next, body: then, share: blend });
      body.parts = parts;
      body.drawn = visual && body.visual ? body.visual : body.boundary;
      for (const drawing of [body.boundary, body.visual])
        if (drawing) drawing.mesh.visible = drawing.edges.visible = drawing === body.drawn;
      body.drawn.place(positions_at(body.shape, parts));
      body.drawn.paint(color, body.own_color, (field) => values_by_vertex(body.shape, parts, field), legend_top[color]);
    });
    return count;
  }
  function style({ flat, wire, xray }) {
    for (const { drawn: { mesh, materials, edges } } of bodies) {
      for (const { material, opacity } of materials) {
        const transparent = xray || opacity < 1;
        if (material.flatShading !== flat || material.transparent !== transparent) material.needsUpdate = true;
        material.flatShading = flat;
        material.transparent = transparent;
        material.opacity = (xray ? 0.32 : 1) * opacity;
        material.depthWrite = !transparent;
      }
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

// `first` is the body in the first frame that has it.
function make_body(scene, shape, visual, number, first, redraw) {
  const group = new THREE.Group();
  scene.add(group);
  const points = positions_at(shape, [{ body: first, share: 1 }]);
  const boundary = make_drawing(group, shape, points, plain_nodes, redraw);
  const body = { group, shape, parts: [], name: shape.name || "body " + number, boundary, drawn: boundary,
    own_color: colors.linear(colors.of_body(number)) };
  if (visual) {
    const nodes = make_followers(visual, shape);
    body.visual = make_drawing(group, visual, nodes.positions(points), nodes, redraw);
  }
  return body;
}

// Positions of the vertices. parts: what is shown of one frame or two, with shares that add up to one.
function positions_at({ vertices, step }, parts) {
  const out = new Float64Array(3 * vertices);
  for (const { body, share } of parts)
    for (let axis = 0; axis < 3; ++axis) {
      const start = share * body.lower[axis], scale = share * step;
      for (let i = axis; i < out.length; i += 3) out[i] += start + scale * body.offset[i];
    }
  return out;
}
function values_by_vertex({ vertices }, parts, field) {
  const out = new Float32Array(vertices);
  for (const { frame, body, share } of parts) {
    const scale = share * frame.scale[field], codes = body[field];
    for (let i = 0; i < vertices; ++i) out[i] += scale * codes[i] * codes[i];
  }
  return out;
}
