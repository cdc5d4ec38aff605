// Drawn surfaces of bodies: the boundary of a body, or its visual surface.
"use strict";

// Functions for the nodes of a drawn surface: their positions and values, given those of the vertices of the body, and
// the vertices, with weights, on which the values at a node depend. Nodes of the boundary are the vertices themselves.
const plain_nodes = {
  positions: (points) => points, values: (values) => values, support: (node) => [{ vertex: node, weight: 1 }],
};

// Nodes of a visual surface; see bound_visual.h.
function make_followers(visual, shape) {
  const vertex_of = new Map([...shape.node].map((node, vertex) => [node, vertex]));
  const vertex = visual.node.map((node) => vertex_of.get(node)), { nodes, weight, offset } = visual;
  const row_of = new Map(visual.gradients.map(({ node }, row) => [node, row]));
  const gradient = Int32Array.from(visual.node, (node) => (row_of.has(node) ? row_of.get(node) : -1));
  const terms = visual.gradients.map((row) =>
    row.terms.map((term) => ({ vertex: vertex_of.get(term.node), gradient: term.gradient })));

  // Results are in memory that the next call overwrites.
  const F = new Float64Array(9 * terms.length), out = new Float64Array(3 * nodes), value = new Float32Array(nodes);

  // Deformation gradients by row of visual.gradients, row-major.
  function find_gradients(points) {
    F.fill(0);
    terms.forEach((list, row) => {
      for (const { vertex: from, gradient: g } of list)
        for (let i = 0; i < 3; ++i)
          for (let j = 0; j < 3; ++j) F[9 * row + 3 * i + j] += points[3 * from + i] * g[j];
    });
  }
  function positions(points) {
    find_gradients(points);
    out.fill(0);
    for (let n = 0; n < nodes; ++n) {
      const x = offset[3 * n], y = offset[3 * n + 1], z = offset[3 * n + 2], is_outside = x || y || z;
      for (let k = 4 * n; k < 4 * n + 4; ++k) {
        const from = 3 * vertex[k], w = weight[k], f = 9 * gradient[k];
        for (let axis = 0; axis < 3; ++axis) {
          let place = points[from + axis];
          if (is_outside && f >= 0) place += F[f + 3 * axis] * x + F[f + 3 * axis + 1] * y + F[f + 3 * axis + 2] * z;
          out[3 * n + axis] += w * place;
        }
      }
    }
    return out;
  }
  function values(of_vertices) {
    value.fill(0);
    for (let k = 0; k < weight.length; ++k) value[k >> 2] += weight[k] * of_vertices[vertex[k]];
    return value;
  }
  const support = (node) => [0, 1, 2, 3].map((k) => ({ vertex: vertex[4 * node + k], weight: weight[4 * node + k] }));
  return { positions, values, support };
}

// `surface` has triangles, and may have texture and materials. `points`: positions of its nodes when it first appears.
// is_coarse: see make_view.
function make_drawing(group, surface, points, nodes, is_coarse, redraw) {
  const geometry = new THREE.BufferGeometry(), order = order_by_material(surface, geometry);
  const { index, source, texture } = split_creases(order(surface.triangles), points,
    surface.texture_corners && order(surface.texture_corners));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  for (const name of ["position", "normal", "color"])
    geometry.setAttribute(name, dynamic(new THREE.BufferAttribute(new Float32Array(3 * source.length), 3)));
  if (surface.texture_corners) geometry.setAttribute("uv", new THREE.BufferAttribute(texture_at(surface, texture), 2));
  const look = { roughness: 0.62, metalness: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    side: surface.gradients ? THREE.DoubleSide : THREE.FrontSide };
  const plain = is_coarse ? make_coarse_material(look)
    : new THREE.MeshStandardMaterial({ ...look, vertexColors: THREE.VertexColors });
  const of_surface = surface.material ? [...surface.materials, no_material] : [];
  const own = of_surface.map((material) => make_material(material, look, redraw));
  const materials = [{ material: plain, opacity: 1 }, ...own];
  const mesh = new THREE.Mesh(geometry, plain);
  mesh.castShadow = mesh.receiveShadow = true;
  mesh.frustumCulled = false;  // its bounds change with every frame
  group.add(mesh);

  let edges = null;
  function make_edges() {
    const lines = new THREE.BufferGeometry();
    lines.setIndex(new THREE.BufferAttribute(edges_of(index, source, points.length / 3), 1));
    lines.setAttribute("position", geometry.getAttribute("position"));
    edges = new THREE.LineSegments(lines,
      new THREE.LineBasicMaterial({ color: 0x05080b, transparent: true, opacity: 0.38 }));
    edges.frustumCulled = false;
    group.add(edges);
  }

  const drawing = { mesh, geometry, materials, source, support: (row) => nodes.support(source[row]),
    is_visual: nodes !== plain_nodes, box: null };  // box: page_pick.js
  drawing.show_edges = (on) => {
    if (on && !edges) make_edges();
    if (edges) edges.visible = on;
  };
  drawing.dispose = () => {
    geometry.dispose();
    if (edges) edges.geometry.dispose();
    for (const { material } of materials) {
      if (material.map) material.map.dispose();
      material.dispose();
    }
  };
  let is_plain = false;  // true if the surface has the colour of the body, or its materials
  drawing.place = (of_vertices) => {
    const attribute = geometry.getAttribute("position"), out = attribute.array, at = nodes.positions(of_vertices);
    for (let row = 0; row < source.length; ++row) {
      const from = 3 * source[row];
      out[3 * row] = at[from];
      out[3 * row + 1] = at[from + 1];
      out[3 * row + 2] = at[from + 2];
    }
    attribute.needsUpdate = true;
    drawing.box = null;
    set_normals(geometry.getAttribute("normal"), out, index);
  };
  // values: by vertex. `top`: value at the upper end of the colours.
  drawing.paint = (color, of_vertices, top) => {
    const attribute = geometry.getAttribute("color"), out = attribute.array, table = colors.tables[color];
    const values = nodes.values(of_vertices), scale = 255 / top;
    mesh.material = plain;
    for (let row = 0; row < source.length; ++row) {
      const entry = 3 * Math.min(255, Math.max(0, Math.round(scale * values[source[row]])));
      out[3 * row] = table[entry];
      out[3 * row + 1] = table[entry + 1];
      out[3 * row + 2] = table[entry + 2];
    }
    is_plain = false;
    attribute.needsUpdate = true;
  };
  drawing.paint_plain = (own_color) => {
    if (is_plain) return;
    const attribute = geometry.getAttribute("color"), out = attribute.array;
    if (own.length > 0) mesh.material = own.map(({ material }) => material);
    for (let i = 0; i < out.length; i += 3) out.set(own_color, i);
    is_plain = attribute.needsUpdate = true;
  };
  return drawing;
}

// Normals of the rows: means over their triangles, weighted by area.
function set_normals(attribute, place, index) {
  const normal = attribute.array;
  normal.fill(0);
  for (let t = 0; t < index.length; t += 3) {
    const a = 3 * index[t], b = 3 * index[t + 1], c = 3 * index[t + 2];
    const ux = place[b] - place[a], uy = place[b + 1] - place[a + 1], uz = place[b + 2] - place[a + 2];
    const vx = place[c] - place[a], vy = place[c + 1] - place[a + 1], vz = place[c + 2] - place[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (let k = t; k < t + 3; ++k) {
      const row = 3 * index[k];
      normal[row] += x;
      normal[row + 1] += y;
      normal[row + 2] += z;
    }
  }
  for (let i = 0; i < normal.length; i += 3) {
    const x = normal[i], y = normal[i + 1], z = normal[i + 2], share = 1 / (Math.sqrt(x * x + y * y + z * z) || 1);
    normal[i] = x * share;
    normal[i + 1] = y * share;
    normal[i + 2] = z * share;
  }
  attribute.needsUpdate = true;
}

// Makes the triangles of each material consecutive, as a group of the geometry. Returns a function that puts a list
// with three entries per triangle into this order. The group of triangles without material comes last.
function order_by_material({ material, materials }, geometry) {
  if (!material) return (list) => list;
  const group_of = (triangle) => (material[triangle] < 0 ? materials.length : material[triangle]);
  const triangles = Array.from(material.keys()).sort((a, b) => group_of(a) - group_of(b) || a - b);
  let start = 0;
  for (let i = 1; i <= triangles.length; ++i) {
    if (i < triangles.length && group_of(triangles[i]) === group_of(triangles[start])) continue;
    geometry.addGroup(3 * start, 3 * (i - start), group_of(triangles[start]));
    start = i;
  }
  return (list) => list.constructor.from(list, (_, i) => list[3 * triangles[Math.floor(i / 3)] + i % 3]);
}

// A material for drawing without a GPU: a few sums at each pixel, where the standard material of three.js takes powers
// and a model of gloss. sqrt stands for the power 1/2.2 of the other materials.
function make_coarse_material({ roughness, metalness, ...look }) {
  const material = new THREE.MeshLambertMaterial({ ...look, vertexColors: THREE.VertexColors });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = `
      varying vec3 tint, form;  // form: normal; position for flat surfaces
      void main() {
        vec4 seen = modelViewMatrix * vec4(position, 1.0);
        gl_Position = projectionMatrix * seen;
        tint = color;
        #ifdef FLAT_SHADED
          form = seen.xyz;
        #else
          form = normalMatrix * normal;
        #endif
      }`;
    shader.fragmentShader = `
      #include <common>
      #include <lights_pars_begin>
      uniform float opacity;
      varying vec3 tint, form;
      void main() {
        #ifdef FLAT_SHADED
          vec3 normal = normalize(cross(dFdx(form), dFdy(form)));
        #else
          vec3 normal = normalize(form);
        #endif
        HemisphereLight sky = hemisphereLights[0];
        vec3 light = mix(sky.groundColor, sky.skyColor, 0.5 + 0.5 * dot(normal, sky.direction));
        for (int i = 0; i < NUM_DIR_LIGHTS; ++i)
          light += max(dot(normal, directionalLights[i].direction), 0.0) * directionalLights[i].color;
        gl_FragColor = vec4(sqrt(tint * light), opacity);
      }`;
  };
  return material;
}

const no_material = { color: [0.8, 0.8, 0.8], opacity: 1, image: "" };

function make_material({ color, opacity, image }, look, redraw) {
  const material = new THREE.MeshStandardMaterial(look);
  if (image) {
    material.map = new THREE.TextureLoader().load(image, redraw);
    material.map.encoding = THREE.sRGBEncoding;
    material.map.wrapS = material.map.wrapT = THREE.RepeatWrapping;
  } else {
    material.color.setRGB(...colors.linear(color));
  }
  return { material, opacity };
}

function texture_at({ texture_points: [u, v] }, texture) {
  const out = new Float32Array(2 * texture.length);
  texture.forEach((point, row) => { if (point >= 0) out.set([u[point], v[point]], 2 * row); });
  return out;
}

// Rows for each smooth patch around a node and for each of its texture points: where faces meet at more than 55 degrees
// (a box, not a coarse ball), shading breaks. index: triangles of the rows; source, texture: node and texture point.
function split_creases(index, points, texture_corners) {
  const smooth = Math.cos(55 * Math.PI / 180);
  const at = (node) => new THREE.Vector3().fromArray(points, 3 * node);
  const normals = [], patches = [], source = [], texture = [], out = new Uint32Array(index.length);
  for (let t = 0; t < index.length; t += 3) {
    const a = at(index[t]);
    normals.push(at(index[t + 1]).sub(a).cross(at(index[t + 2]).sub(a)).normalize());
  }
  index.forEach((node, corner) => {
    const normal = normals[Math.floor(corner / 3)], point = texture_corners ? texture_corners[corner] : -1;
    patches[node] = patches[node] || [];
    let patch = patches[node].find((other) =>
      other.point === point && other.members.some((member) => member.dot(normal) > smooth));
    if (!patch) {
      patch = { number: source.length, members: [], point };
      source.push(node);
      texture.push(point);
      patches[node].push(patch);
    }
    patch.members.push(normal);
    out[corner] = patch.number;
  });
  return { index: out, source: new Uint32Array(source), texture };
}

// Each edge once, although two triangles have it and creases double its ends.
function edges_of(index, source, nodes) {
  const seen = new Set(), out = [];
  for (let t = 0; t < index.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = index[t + k], b = index[t + (k + 1) % 3];
      const key = Math.min(source[a], source[b]) * nodes + Math.max(source[a], source[b]);
      if (seen.has(key)) continue;
      seen.add(key);
      out.push(a, b);
    }
  return new Uint32Array(out);
}
