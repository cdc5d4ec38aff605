// The view as a still and as a video: the scene with its names, legend and time.
"use strict";

// draw(pen, width, height, ratio) draws over the scene. Even sizes, which video formats ask for.
function make_picture(view, draw) {
  const canvas = document.createElement("canvas"), pen = canvas.getContext("2d", { alpha: false });
  return {
    canvas,
    compose: () => {
      const width = view.canvas.width & ~1, height = view.canvas.height & ~1;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      const ratio = view.canvas.width / view.canvas.clientWidth;
      const style = getComputedStyle(document.documentElement);
      const ground = pen.createRadialGradient(width / 2, 0.62 * height, 0, width / 2, 0.62 * height,
        Math.hypot(width, height) * 0.62);
      ["--ground-near", "--ground-middle", "--ground-far"].forEach((name, i) =>
        ground.addColorStop([0, 0.52, 1][i], style.getPropertyValue(name).trim()));
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.fillStyle = ground;
      pen.fillRect(0, 0, width, height);
      pen.drawImage(view.canvas, 0, 0);
      draw(pen, width, height, ratio);
    },
  };
}

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// Title, time, and colours with their values, as the page shows them beside the scene.
function draw_caption(pen, width, height, ratio, { title, clock, name, ticks, color, style }) {
  pen.save();
  pen.scale(ratio, ratio);
  const wide = width / ratio, tall = height / ratio;
  pen.textBaseline = "alphabetic";
  const write = (content, x, y, font, align) => {
    pen.font = font + " system-ui, 'DejaVu Sans', sans-serif";
    pen.textAlign = align;
    pen.fillStyle = style.text;
    pen.fillText(content, x, y, wide - 40);
  };
  write(title, 20, 32, "600 17px", "left");
  write(clock, wide - 20, tall - 22, "500 15px", "right");
  if (ticks) {
    write(name, 20, tall - 52, "13px", "left");
    for (let i = 0; i < 240; ++i) {
      pen.fillStyle = colors.css(colors.at(color, i / 239));
      pen.fillRect(20 + i, tall - 44, 1.5, 10);
    }
    ticks.forEach((tick, i) => write(tick, 20 + 120 * i, tall - 18, "12px", ["left", "center", "right"][i]));
  }
  pen.restore();
}

const video_types = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
const video_type = () => typeof MediaRecorder !== "undefined"
  && video_types.find((type) => MediaRecorder.isTypeSupported(type));

// Records pictures of the canvas that draw(i) composes, `count` of them, `rate` a second of the video. Each is drawn
// while the recorder is paused, so a slow machine records what a fast one does; it takes at least as long as the video
// does. progress(share) returns false to give up, and then the result is null.
async function record(canvas, count, rate, draw, progress) {
  const stream = canvas.captureStream(0), track = stream.getVideoTracks()[0], type = video_type();
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 8e6 }), parts = [];
  recorder.addEventListener("dataavailable", (event) => parts.push(event.data));
  const ended = new Promise((resolve, reject) => {
    recorder.addEventListener("stop", resolve);
    recorder.addEventListener("error", (event) => reject(event.error || new Error("the video recorder failed")));
  });
  const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  recorder.start();
  recorder.pause();
  let passed = 0, complete = true;  // s of the video
  // The last picture twice: Chrome's recorder leaves one out.
  for (let i = 0; i <= count; ++i) {
    if (!progress(i / (count + 1))) {
      complete = false;
      break;
    }
    draw(Math.min(i, count - 1));
    const begin = performance.now();
    recorder.resume();
    track.requestFrame();
    // Timers are late; what one picture got too much, the next gets less.
    await wait(Math.max(1000 * ((i + 1) / rate - passed), 1));
    recorder.pause();
    passed += (performance.now() - begin) / 1000;
  }
  recorder.stop();
  await ended;
  track.stop();
  return complete ? new Blob(parts, { type: type.split(";")[0] }) : null;
}
