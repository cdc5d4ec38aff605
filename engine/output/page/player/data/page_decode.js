// Reads the streams that page_stream.h and visual_stream.h write.
"use strict";

const decode = (() => {
  const last_code = 2047, lowest_exponent = -255;  // limits of a value scale

  function bytes(base64) {
    const text = atob(base64);
    const out = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) out[i] = text.charCodeAt(i);
    return out;
  }
  const words = (base64) => new Uint32Array(bytes(base64).buffer);
  const floats = (base64) => new Float32Array(bytes(base64).buffer);

  async function inflate(base64, format = "deflate") {
    const packed = new Blob([bytes(base64)]).stream();
    return new Uint8Array(await new Response(packed.pipeThrough(new DecompressionStream(format))).arrayBuffer());
  }

  // Takes numbers off the front.
  function reader(data) {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    let at = 0;
    const count = () => {
      if (data[at] < 128) return data[at++];
      let value = 0, scale = 1;
      for (;;) {
        const byte = data[at++];
        value += (byte & 127) * scale;
        if (!(byte & 128)) return value;  // also behind the end of the data, where `byte` is undefined
        scale *= 128;
      }
    };
    const signed = (zigzag) => (zigzag % 2 ? -(zigzag + 1) / 2 : zigzag / 2);
    const float = (size) => () => {
      at += size;
      return size === 4 ? view.getFloat32(at - 4, true) : view.getFloat64(at - 8, true);
    };
    return { count, signed, change: () => signed(count()), f32: float(4), f64: float(8), u8: () => data[at++],
      ended: () => at >= data.length };
  }
  const times = (number, take) => Array.from({ length: number }, take);
  // Converts a code on an earlier scale to a code on a later one.
  const shifted = (code, exponent_prev, exponent) => code >> Math.min(exponent - exponent_prev, 31);
  const no_lattice = { origin: [0, 0, 0], step: 1e-6, now: [] };  // lattice of contacts without a body
  const value_of = (code, top) => Math.sign(code) * top * (code / last_code) * (code / last_code);

  function shape(take, name, fields) {
    const vertices = take.count(), corners = 3 * take.count();
    const origin = times(3, take.f64), step = take.f64();
    let last = 0;
    const next = () => (last += take.change());
    const node = Uint32Array.from(times(vertices, next));
    last = 0;
    const triangles = Uint32Array.from(times(corners, next));
    return {
      name, vertices, node, triangles, origin, step, frames: 0, now: new Float64Array(3 * vertices),
      before: new Float64Array(3 * vertices), stress_change: new Int32Array(vertices),
      values: times(fields, () => ({ exponent: lowest_exponent, code: new Int32Array(vertices), sum: 0 })),
    };
  }

  // Visual surfaces as visual_stream.h packs them, with node numbers of the bodies. No texture: index -1.
  function visuals(data) {
    const take = reader(data), out = [], weight_steps = 65536;
    const list = (Type, count) => {
      let last = 0;
      return Type.from({ length: count }, () => (last += take.change()));
    };
    while (!take.ended()) {
      const [nodes, triangles, points, materials] = times(4, take.count), step = take.f64();
      const follows = times(4, () => list(Uint32Array, nodes)), weights = times(3, () => list(Int32Array, nodes));
      const offsets = times(3, () => list(Int32Array, nodes)), visual = { nodes, gradients: [] };
      visual.node = new Uint32Array(4 * nodes);
      visual.weight = new Float32Array(4 * nodes);
      visual.offset = new Float32Array(3 * nodes);
      for (let i = 0; i < nodes; ++i) {
        let rest = weight_steps;
        for (let k = 0; k < 4; ++k) {
          const weight = k < 3 ? weights[k][i] : rest;
          rest -= weight;
          visual.node[4 * i + k] = follows[k][i];
          visual.weight[4 * i + k] = weight / weight_steps;
        }
        for (let axis = 0; axis < 3; ++axis) visual.offset[3 * i + axis] = step * offsets[axis][i];
      }
      let node = 0;
      for (let count = take.count(); count > 0; --count) {
        node += take.change();
        let term = node;
        visual.gradients.push({ node, terms: times(take.count(), () =>
          ({ node: (term += take.change()), gradient: times(3, take.f32) })) });
      }
      visual.triangles = list(Uint32Array, 3 * triangles);
      if (points > 0) {
        visual.texture_points = times(2, () => Float32Array.from(list(Int32Array, points), (x) => x / weight_steps));
        visual.texture_corners = list(Int32Array, 3 * triangles);
      }
      if (materials > 0) visual.material = list(Int32Array, triangles);
      out.push(visual);
    }
    return out;
  }

  // An array of an earlier frame if it can be used again, otherwise a new one.
  const room = (Type, length, old) => (old instanceof Type && old.length === length ? old : new Type(length));

  // Reads the positions of a body. Returns the least coordinates [m], the extent of the body [m], and `offset`: codes
  // of the vertices above the least code of each axis. `old.offset` is overwritten if it has the right size.
  function positions(take, body, old) {
    const { vertices, now, before } = body, base = [0, 0, 0], top = [0, 0, 0], continues = body.frames > 1;
    for (let axis = 0; axis < 3; ++axis) {
      let rest = 0, low = Infinity, high = -Infinity;
      for (let i = axis; i < 3 * vertices; i += 3) {
        rest += take.change();
        const last = now[i], code = last + rest + (continues ? last - before[i] : 0);
        now[i] = code;
        before[i] = last;
        if (code < low) low = code;
        if (code > high) high = code;
      }
      base[axis] = vertices ? low : 0;
      top[axis] = vertices ? high - low : 0;
    }
    ++body.frames;
    const offset = room(Math.max(...top) < 65536 ? Uint16Array : Float64Array, 3 * vertices, old.offset);
    for (let axis = 0; axis < 3; ++axis)
      for (let i = axis; i < 3 * vertices; i += 3) offset[i] = now[i] - base[axis];
    const lower = base.map((code, axis) => body.origin[axis] + body.step * code);
    return { lower, extent: top.map((code) => code * body.step), offset };
  }

  function values(take, body, exponents, old) {
    const stress_change = body.stress_change, stress_sum = body.values[1].sum;
    return body.values.map((last, field) => {
      const follows = field === 2 && stress_sum > 0, share = follows ? last.sum / stress_sum : 0;
      const code = room(Uint16Array, body.vertices, old[field]), older = last.code;
      const shift = Math.min(exponents[field] - last.exponent, 31);
      let rest = 0, sum = 0;
      for (let i = 0; i < code.length; ++i) {
        rest += take.change();
        const change = rest + (follows ? Math.floor(stress_change[i] * share + 0.5) : 0);
        if (field === 1) stress_change[i] = change;
        older[i] = code[i] = (older[i] >> shift) + change;
        sum += code[i];
      }
      last.sum = sum;
      last.exponent = exponents[field];
      return code;
    });
  }

  const numbers = 7;  // count of the numbers of a contact: point, force, normal part

  const contact_rows = (size) => ({
    size, prev: new Int32Array(size), next: new Int32Array(size), first: new Int32Array(size),
    second: new Int32Array(size), collider: new Int32Array(size), point: new Float32Array(3 * size),
    force: new Float32Array(3 * size), normal: new Float32Array(size), region: new Int32Array(size),
    state: new Uint8Array(size), code: new Float64Array(numbers * size),
  });

  // Reads `count` contacts into `rows`. last: rows of the previous frame.
  function contacts(take, count, bodies, last, exponent, rows) {
    const { prev, next, first, second, collider, point, force, normal, region, state, code } = rows;
    let expected = 0;
    for (let i = 0; i < count; ++i) {
      const mark = take.count();
      prev[i] = mark === 0 ? -1 : expected + take.signed(mark - 1);
      if (mark !== 0) expected = prev[i] + 1;
    }
    for (let i = 0; i < count; ++i) {
      first[i] = prev[i] >= 0 ? last.first[prev[i]] : take.count() - 1;
      second[i] = prev[i] >= 0 ? last.second[prev[i]] : take.count() - 1;
      collider[i] = prev[i] >= 0 ? last.collider[prev[i]] : take.count() - 1;
    }
    const lattice = (i) => bodies[first[i] >= 0 ? first[i] : second[i]] || no_lattice;
    for (let k = 0; k < numbers; ++k)
      for (let i = 0; i < count; ++i) {
        let base = k < 3 ? lattice(i).now[k] || 0 : 0;
        if (prev[i] >= 0) {
          base = last.code[numbers * prev[i] + k];
          if (k >= 3) base = shifted(base, last.exponent, exponent);
        } else if (i > 0 && first[i - 1] === first[i] && first[i] >= 0) {
          base = code[numbers * (i - 1) + k];
        }
        code[numbers * i + k] = base + take.change();
      }
    const top = Math.pow(4, exponent);
    let number = 0;
    for (let i = 0; i < count; ++i) {
      const { origin, step } = lattice(i);
      for (let axis = 0; axis < 3; ++axis) {
        point[3 * i + axis] = origin[axis] + step * code[numbers * i + axis];
        force[3 * i + axis] = value_of(code[numbers * i + 3 + axis], top);
      }
      normal[i] = value_of(code[numbers * i + 6], top);
      region[i] = number += take.change();
    }
    for (let i = 0; i < count; ++i) {
      state[i] = take.u8();
      // The row of the next frame with the same contact, for pictures between the frames.
      next[i] = -1;
      if (prev[i] >= 0) last.next[prev[i]] = i;
    }
    return Object.assign(rows, { count, exponent, top });
  }

  // Lines of a frame by number: points and forces. `prev`: lines of the previous frame, with all codes.
  function lines(take, lattice, prev) {
    const count = take.count(), out = { list: new Map(), exponent: prev.exponent, top: 0 };
    if (count === 0) return out;
    out.exponent = take.change();
    out.top = Math.pow(4, out.exponent);
    if (!lattice.step) Object.assign(lattice, { origin: times(3, take.f64), step: take.f64() });
    for (let i = 0; i < count; ++i) {
      const number = take.count(), points = take.count(), last = prev.list.get(number);
      const continues = last && last.force.length === points, code = new Float64Array(4 * points);
      for (let k = 0; k < 4; ++k)
        for (let p = 0; p < points; ++p) {
          let base = p > 0 ? code[4 * (p - 1) + k] : 0;
          if (continues) base = last.code[4 * p + k];
          if (continues && k === 3) base = shifted(base, prev.exponent, out.exponent);
          code[4 * p + k] = base + take.change();
        }
      const line = { point: new Float32Array(3 * points), force: new Float32Array(points), code };
      for (let p = 0; p < points; ++p) {
        for (let axis = 0; axis < 3; ++axis)
          line.point[3 * p + axis] = lattice.origin[axis] + lattice.step * code[4 * p + axis];
        line.force[p] = value_of(code[4 * p + 3], out.top);
      }
      out.list.set(number, line);
    }
    return out;
  }

  // Decodes frame after frame: add(data) returns the frames in `data`, the bytes of one or more whole frames. A frame:
  // bodies, colliders and lines by number, contacts, scale by field: value = scale * code^2. `names` of the bodies may
  // grow from frame to frame. recycle: arrays of a frame are overwritten by the next, its contacts by the next but one.
  function decoder(names, fields, recycle) {
    const bodies = [], lattice_of_lines = {};
    let last = null, spare = null, last_lines = { list: new Map(), exponent: lowest_exponent };

    function read_body(take, frame, exponents) {
      const number = take.count();
      if (number === bodies.length) bodies.push(shape(take, names[number], fields.length));
      const body = bodies[number], old = body.place || {}, place = positions(take, body, old);
      const codes = values(take, body, exponents, fields.map((field) => old[field]));
      fields.forEach((field, k) => { place[field] = codes[k]; });
      if (recycle) body.place = place;
      frame.bodies.set(number, place);
    }
    function read_contacts(take, count, exponent) {
      const rows = recycle && spare && spare.size >= count ? spare : contact_rows(recycle ? 2 * count : count);
      const out = contacts(take, count, bodies, last, exponent, rows);
      spare = last;
      if (last && !recycle) last.code = last.prev = null;  // needed by the next frame only
      return (last = out);
    }
    function read_frame(take) {
      const [body_count, collider_count, contact_count] = times(3, take.count);
      const exponents = times(fields.length, take.change), force_exponent = take.change();
      const frame = { bodies: new Map(), colliders: new Map(), scale: {} };
      fields.forEach((field, i) => {
        frame.scale[field] = Math.pow(4, exponents[i]) / (last_code * last_code);
      });
      for (let i = 0; i < body_count; ++i) read_body(take, frame, exponents);
      for (let i = 0; i < collider_count; ++i)
        frame.colliders.set(take.count(), { position: times(3, take.f32), rotation: times(3, take.f32) });
      frame.contacts = read_contacts(take, contact_count, force_exponent);
      frame.lines = last_lines = lines(take, lattice_of_lines, last_lines);
      return frame;
    }
    function add(data) {
      const take = reader(data), out = [];
      while (!take.ended()) out.push(read_frame(take));
      return out;
    }
    return { bodies, add };
  }

  return { words, floats, inflate, decoder, visuals };
})();
