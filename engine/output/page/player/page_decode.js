// Reads what page_data.h packed.
"use strict";

const decode = (() => {
  function bytes(base64) {
    const text = atob(base64);
    const out = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) out[i] = text.charCodeAt(i);
    return out;
  }

  const words = (base64) => new Uint32Array(bytes(base64).buffer);
  const floats = (base64) => new Float32Array(bytes(base64).buffer);

  // Takes blocks off the front of a frame, in place. Every block ends at a multiple of 4.
  function reader(buffer) {
    let at = 0;
    return (Type, count) => {
      const block = new Type(buffer, at, count);
      at += Math.ceil(block.byteLength / 4) * 4;
      return block;
    };
  }

  function frame(base64, bodies) {
    const take = reader(bytes(base64).buffer);
    const [body_count, collider_count, contact_count] = take(Uint32Array, 3);
    const out = { bodies: new Map(), colliders: new Map() };
    for (let i = 0; i < body_count; ++i) {
      const [number] = take(Uint32Array, 1);
      const vertices = bodies[number].vertices;
      const [top_speed, top_stress] = take(Float32Array, 2);
      out.bodies.set(number, {
        top: { speed: top_speed, stress: top_stress },
        lower: take(Float32Array, 3), extent: take(Float32Array, 3), position: take(Uint16Array, 3 * vertices),
        speed: take(Uint8Array, vertices), stress: take(Uint8Array, vertices),
      });
    }
    for (let i = 0; i < collider_count; ++i) {
      const [number] = take(Uint32Array, 1);
      out.colliders.set(number, { position: take(Float32Array, 3), rotation: take(Float32Array, 3) });
    }
    out.contacts = {
      count: contact_count, unit: take(Float32Array, 1)[0],
      lower: take(Float32Array, 3), extent: take(Float32Array, 3), point: take(Uint16Array, 3 * contact_count),
      force: take(Int16Array, 3 * contact_count), region: take(Uint16Array, contact_count),
      state: take(Uint8Array, contact_count),
    };
    return out;
  }

  return { words, floats, frame };
})();
