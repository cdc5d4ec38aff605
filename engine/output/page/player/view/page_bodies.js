// The bodies: moved and coloured by frame.
"use strict";

// scales: page_scales.js. is_coarse: see make_view. redraw(): an image was loaded.
function make_bodies(scene, scales, is_coarse, redraw) {
  const bodies = [];  // by number, without those that were removed
  // `visual`: visual surface or undefined; `first`: the body in the first frame that has it.
  function add(number, shape, visual, first) {
    const draw = (...surface) => make_drawing(...surface, is_coarse, redraw);
    bodies[number] = make_body(scene, shape, visual, number, first, draw);
  }
  function remove(number) {
    const { group, boundary, visual } = bodies[number];
    scene.remove(group);
    boundary.dispose();
    if (visual) visual.dispose();
    delete bodies[number];
  }

  // Shows `frame`, moved towards the next frame by `blend` in [0, 1). `visual`: draw visual surfaces.
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
        if (drawing) drawing.mesh.visible = drawing === body.drawn;
      body.drawn.place(positions_at(body.shape, parts, body.points));
      if (color === "body") body.drawn.paint_plain(body.own_color);
      else body.drawn.paint(color, values_by_vertex(parts, color, body.values), scales[color].top);
    });
    return count;
  }
  function style({ flat, wire, xray }) {
    bodies.forEach(({ drawn, boundary, visual }) => {
      const { mesh, materials } = drawn;
      for (const { material, opacity } of materials) {
        const transparent = xray || opacity < 1;
        if (material.flatShading !== flat || material.transparent !== transparent) material.needsUpdate = true;
        material.flatShading = flat;
        material.transparent = transparent;
        material.opacity = (xray ? 0.32 : 1) * opacity;
        material.depthWrite = !transparent;
      }
      mesh.castShadow = !xray;
      boundary.show_edges(wire && drawn === boundary);
      if (visual) visual.show_edges(wire && drawn === visual);
    });
  }
  // Values at a point of a triangle: {field: {value, error}}.
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
      out[field] = { value: value < 1e-9 * scales[field].max ? 0 : value, error };  // less is a rounding error
    }
    return out;
  }
  return { add, remove, show, style, values_at, list: bodies };
}

// `first` is the body in the first frame that has it. draw(group, surface, points, nodes): see make_drawing.
function make_body(scene, shape, visual, number, first, draw) {
  const group = new THREE.Group();
  scene.add(group);
  const points = positions_at(shape, [{ body: first, share: 1 }], new Float64Array(3 * shape.vertices));
  const boundary = draw(group, shape, points, plain_nodes);
  const body = { group, shape, points, values: new Float32Array(shape.vertices), parts: [], boundary,
    drawn: boundary, name: shape.name || "body " + number, own_color: colors.linear(colors.of_body(number)) };
  if (visual) {
    const nodes = make_followers(visual, shape);
    body.visual = draw(group, visual, nodes.positions(points), nodes);
  }
  return body;
}

// Positions of the vertices, in `out`. parts: states of the body in one frame or two, with shares that add up to one.
function positions_at({ step }, parts, out) {
  out.fill(0);
  for (const { body: { lower, offset }, share } of parts)
    for (let axis = 0; axis < 3; ++axis) {
      const start = share * lower[axis], scale = share * step;
      for (let i = axis; i < out.length; i += 3) out[i] += start + scale * offset[i];
    }
  return out;
}
function values_by_vertex(parts, field, out) {
  out.fill(0);
  for (const { frame, body, share } of parts) {
    const scale = share * frame.scale[field], codes = body[field];
    for (let i = 0; i < out.length; ++i) out[i] += scale * codes[i] * codes[i];
  }
  return out;
}
