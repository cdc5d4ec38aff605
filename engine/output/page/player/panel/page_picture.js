// Pictures of the view with its names, legend and time.
"use strict";

// draw(pen, width, height, ratio) draws over the scene. Width and height are even, as video formats require.
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
