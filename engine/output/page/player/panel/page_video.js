// Videos: encoded by the browser, and written as WebM (RFC 8794, RFC 9559).
"use strict";

const can_record = () => typeof VideoEncoder !== "undefined";

// Records `count` pictures of the canvas, which draw(i) composes, with `rate` pictures per second of the video. The
// video does not depend on the speed of the machine. progress(share) returns false to stop; then the result is null.
async function record(canvas, count, rate, draw, progress) {
  const chunks = [], turn = () => new Promise((resolve) => setTimeout(resolve, 0));
  let error = null;
  const encoder = new VideoEncoder({
    output: (chunk) => {
      const data = new Uint8Array(chunk.byteLength);
      chunk.copyTo(data);
      chunks.push({ data, time: Math.round(chunk.timestamp / 1000), is_key: chunk.type === "key" });
    },
    error: (reason) => { error = reason; },
  });
  draw(0);
  const { width, height } = canvas;
  encoder.configure({ codec: "vp8", width, height, bitrate: 8e6, framerate: rate });
  for (let i = 0; i < count && !error; ++i) {
    if (!progress(i / count)) {
      encoder.close();
      return null;
    }
    draw(i);
    const frame = new VideoFrame(canvas, { timestamp: 1e6 * i / rate, duration: 1e6 / rate });
    encoder.encode(frame, { keyFrame: i % 60 === 0 });
    frame.close();
    do await turn(); while (encoder.encodeQueueSize > 2 && !error);
  }
  if (!error) await encoder.flush();
  if (error) throw error;
  encoder.close();
  return webm(chunks, { width, height, milliseconds: 1000 * count / rate });
}

// A file with one video track. chunks: {data, time [ms], is_key} in the order of time, the first a key picture.
function webm(chunks, { width, height, milliseconds }) {
  const number = (size, method) => (value) => {
    const view = new DataView(new ArrayBuffer(size));
    view[method](0, value);
    return view;
  };
  const u8 = number(1, "setUint8"), u16 = number(2, "setUint16"), u32 = number(4, "setUint32");
  const i16 = number(2, "setInt16"), f64 = number(8, "setFloat64");
  const number_of_id = (id) => (id > 0xffffff ? u32(id) : id > 0xff ? new Uint8Array(u32(id).buffer).slice(
    id > 0xffff ? 1 : 2) : u8(id));
  // Sizes have four bytes, with a mark in their upper bits.
  const element = (id, ...content) => {
    const body = new Blob(content);
    return new Blob([number_of_id(id), u32(body.size + 0x10000000), body]);
  };
  const clusters = [];
  for (const { data, time, is_key } of chunks) {
    if (is_key) clusters.push({ time, blocks: [] });
    const { time: begin, blocks } = clusters[clusters.length - 1];
    blocks.push(element(0xa3, u8(0x81), i16(time - begin), u8(is_key ? 0x80 : 0), data));
  }
  const head = element(0x1a45dfa3, element(0x4286, u8(1)), element(0x42f7, u8(1)), element(0x42f2, u8(4)),
    element(0x42f3, u8(8)), element(0x4282, "webm"), element(0x4287, u8(2)), element(0x4285, u8(2)));
  const info = element(0x1549a966, element(0x2ad7b1, u32(1000000)), element(0x4489, f64(milliseconds)),
    element(0x4d80, "Skerry"), element(0x5741, "Skerry"));
  const tracks = element(0x1654ae6b, element(0xae, element(0xd7, u8(1)), element(0x73c5, u8(1)), element(0x83, u8(1)),
    element(0x86, "V_VP8"), element(0xe0, element(0xb0, u16(width)), element(0xba, u16(height)))));
  const segment = element(0x18538067, info, tracks, ...clusters.map(({ time, blocks }) =>
    element(0x1f43b675, element(0xe7, u32(time)), ...blocks)));
  return new Blob([head, segment], { type: "video/webm" });
}
