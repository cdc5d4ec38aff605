// Curves over time with a cursor, and the bars of the stages.
"use strict";

// series: [{name, color, values}], one value by time; times and values may change before update(). format(value) is
// text. pick(frame), if there is one, is called when somebody points at a time.
function make_plot(host, times, series, format, pick) {
  const keys = document.createElement("div");
  keys.className = "keys";
  const labels = series.map(({ name, color }) => {
    const key = document.createElement("span"), swatch = document.createElement("i"),
      value = document.createElement("b");
    swatch.className = "swatch";
    swatch.style.background = color;
    key.append(swatch, name + " ", value);
    keys.append(key);
    return value;
  });
  const canvas = document.createElement("canvas");
  host.append(keys, canvas);
  const pen = canvas.getContext("2d", { willReadFrequently: true });  // drawn in memory: fast without a GPU, too
  // Names of colours stand for different values in light and dark pages.
  const style = getComputedStyle(document.documentElement);
  const resolved = (color) => (color.startsWith("var(") ? style.getPropertyValue(color.slice(4, -1)).trim() : color);
  const margin = { left: 52, right: 6, top: 6, bottom: 20 };
  let frame = 0, ends, first, span, size = { width: 0, height: 0 };  // size of the canvas [pixels]
  function measure() {
    ends = range_of(series);
    first = times[0] || 0;
    span = Math.max((times[times.length - 1] || 0) - first, 1e-12);
  }
  const width = () => size.width - margin.left - margin.right;
  const x_of = (time) => margin.left + (time - first) / span * width();
  const y_of = (value) => size.height - margin.bottom
      - (value - ends.low) / (ends.high - ends.low) * (size.height - margin.top - margin.bottom);

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    size = { width: canvas.clientWidth, height: canvas.clientHeight };
    canvas.width = Math.round(size.width * ratio);
    canvas.height = Math.round(size.height * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const ticks = ticks_of(ends).map((value) => ({ value, label: format(value) }));
    margin.left = Math.max(52, ...ticks.map(({ label }) => Math.ceil(pen.measureText(label).width) + 9));
    draw_axes(ticks);
    pen.lineJoin = "round";
    pen.lineWidth = 1.6;
    for (const { color, values } of series) {
      pen.strokeStyle = resolved(color);
      pen.beginPath();
      let down = false;
      values.forEach((value, i) => {
        if (value === null) { down = false; return; }
        if (down) pen.lineTo(x_of(times[i]), y_of(value));
        else pen.moveTo(x_of(times[i]), y_of(value));
        down = true;
      });
      pen.stroke();
    }
    if (times.length === 0) return;
    pen.strokeStyle = resolved("var(--text)");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x_of(times[frame]), margin.top);
    pen.lineTo(x_of(times[frame]), size.height - margin.bottom);
    pen.stroke();
    for (const { color, values } of series) {
      if (values[frame] === null) continue;
      pen.fillStyle = resolved(color);
      pen.beginPath();
      pen.arc(x_of(times[frame]), y_of(values[frame]), 3, 0, 2 * Math.PI);
      pen.fill();
    }
  }
  function draw_axes(ticks) {
    pen.strokeStyle = resolved("var(--line)");
    pen.fillStyle = resolved("var(--muted)");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const { value, label } of ticks) {
      const y = Math.round(y_of(value)) + 0.5;
      pen.moveTo(margin.left, y);
      pen.lineTo(size.width - margin.right, y);
      pen.fillText(label, margin.left - 7, y);
    }
    pen.stroke();
    if (times.length < 2) return;
    const step = text.tick(span, 4);
    pen.textBaseline = "top";
    pen.textAlign = "left";
    let free = 0, before = "";  // left end of the space for the next label, and the label before it
    for (let i = Math.ceil(first / step); i * step <= first + span * 1.000001; ++i) {
      const label = text.si(i * step, "s"), wide = pen.measureText(label).width;
      const left = Math.min(x_of(i * step) - wide / 2, size.width - 1 - wide);
      if (left < free || label === before) continue;
      pen.fillText(label, left, size.height - margin.bottom + 6);
      free = left + wide + 6;
      before = label;
    }
  }
  function show(number) {
    frame = number;
    labels.forEach((label, i) => { label.textContent = times.length ? format(series[i].values[frame]) : ""; });
    draw();
  }
  function update() {
    measure();
    show(Math.max(times.length - 1, 0));
  }
  const point_at = (event) => {
    const time = first + (event.offsetX - margin.left) / width() * span;
    let best = 0;
    times.forEach((t, i) => { if (Math.abs(t - time) < Math.abs(times[best] - time)) best = i; });
    pick(best);
  };
  if (pick) {
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); point_at(event); });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) point_at(event); });
  }
  measure();
  new ResizeObserver(draw).observe(canvas);
  return { show, draw, update };
}

// The plots of all runs. rows: columns by name.
function make_run_plots(find, rows, pick) {
  const potential = [], total = [];
  // Potential energy counts from its least value.
  function add_up() {
    const floor = rows.potential.reduce((least, value) => (value === null ? least : Math.min(least, value)), Infinity);
    potential.length = total.length = 0;
    rows.potential.forEach((value, i) => {
      potential.push(value === null ? null : value - floor);
      total.push(rows.kinetic[i] + rows.elastic[i] + potential[i]);
    });
  }
  add_up();
  const energy = make_plot(find("energy_plot"), rows.time, [
    { name: "total", color: "var(--text)", values: total },
    { name: "kinetic", color: "var(--kinetic)", values: rows.kinetic },
    { name: "potential", color: "var(--potential)", values: potential },
    { name: "elastic", color: "var(--elastic)", values: rows.elastic },
    { name: "dissipated", color: "var(--dissipated)", values: rows.dissipated },
  ], (value) => text.si(value, "J"), pick);
  const contact = make_plot(find("contact_plot"), rows.time, [
    { name: "contacts", color: "var(--text)", values: rows.contacts },
    { name: "stick", color: "var(--stick)", values: rows.stick },
    { name: "slide", color: "var(--slide)", values: rows.slide },
    { name: "regions", color: "var(--potential)", values: rows.regions },
  ], (value) => String(+value.toFixed(2)), pick);
  const update = () => {
    add_up();
    energy.update();
  };
  return [{ ...energy, update }, contact];
}

// Values at the lines across a plot; ends: see range_of.
function ticks_of({ low, high, step }) {
  const count = Math.round((high - low) / step) + 1;
  return Array.from({ length: count }, (_, i) => Math.round(low / step + i) * step);
}

// Ends at ticks around all finite values and zero.
function range_of(series) {
  let low = 0, high = 0;
  for (const { values } of series)
    for (const value of values)
      if (value !== null) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
  if (high === low) high = low + 1;
  const step = text.tick(high - low, 4);
  return { low: Math.floor(low / step + 1e-9) * step, high: Math.ceil(high / step - 1e-9) * step, step };
}

// Mean time of each stage per step, with its share of the sum over all stages. Stages with less than half a percent are
// added up.
function show_stages(host, report) {
  const element = (name, content) => {
    const made = document.createElement("div");
    made.className = name;
    if (content !== undefined) made.textContent = content;
    return made;
  };
  const steps = Math.max(report.steps, 1);
  const total = report.stages.reduce((sum, stage) => sum + stage.seconds, 0);
  const smallest = 0.005 * total, minor = report.stages.filter((stage) => stage.seconds < smallest);
  const shown = report.stages.filter((stage) => stage.seconds >= smallest);
  if (minor.length > 0)
    shown.push({ name: "others (" + minor.length + ")", seconds: minor.reduce((sum, stage) => sum + stage.seconds, 0),
      title: minor.map((stage) => stage.name + " " + text.si(stage.seconds / steps, "s")).join("\n") });
  const longest = Math.max(...shown.map((stage) => stage.seconds), 1e-300);
  for (const stage of shown) {
    const row = element("stage"), value = element("value"), time = document.createElement("b"), bar = element("bar");
    const fill = document.createElement("i");
    row.title = stage.title || text.count(stage.runs) + " runs, skipped " + text.count(stage.skipped) + " times";
    time.textContent = text.si(stage.seconds / steps, "s");
    value.append(time, "  " + (total > 0 ? (100 * stage.seconds / total).toFixed(1) : "0") + "\u202f%");
    fill.style.width = 100 * stage.seconds / longest + "%";
    bar.append(fill);
    row.append(element("name", stage.name), value, bar);
    host.append(row);
  }
  host.append(element("note", report.stages.length
    ? "Mean of " + text.count(report.steps) + " steps, " + text.si(total / steps, "s")
      + " in total over all stages; stages may run concurrently."
    : "No step was made."));
}
