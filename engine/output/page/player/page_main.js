// Puts the page together: state, controls, and the loop that plays.
"use strict";

(async () => {
  const find = (id) => document.getElementById(id);
  const root = document.documentElement;

  function notice(message) {
    find("notice").textContent = message;
    find("notice").hidden = !message;
  }
  // A check of the page reads these marks: data-ready after the first picture, data-error after a failure.
  function fail(mark, message) {
    root.dataset.error = mark;
    notice(message);
  }
  window.addEventListener("error", (event) => fail(event.message, "This page failed: " + event.message));
  window.addEventListener("unhandledrejection", (event) => {
    const message = (event.reason && event.reason.message) || String(event.reason);
    fail(message, "This page failed: " + message);
  });
  document.addEventListener("securitypolicyviolation", (event) => {
    root.dataset.error = "blocked " + event.blockedURI;
  });

  const run = JSON.parse(find("run").textContent);
  show_summary(find, run);
  show_stages(find("stages"), run.report);
  const unpacked = { bodies: [], visuals: [], frames: [] };
  if (typeof DecompressionStream === "undefined") {
    fail("no DecompressionStream", "This browser cannot show the frames of this page, because it lacks "
      + "DecompressionStream. Use Chrome or Edge 80, Firefox 113, Safari 16.4, or a later version. The plots work "
      + "without the frames.");
  } else {
    notice("Unpacking \u2026");
    const library = document.createElement("script");
    library.textContent = new TextDecoder().decode(await decode.inflate(find("three").textContent));
    document.head.append(library);
    Object.assign(unpacked, decode.frames(await decode.inflate(find("frames").textContent), run.bodies, field_names));
    unpacked.visuals = decode.visuals(await decode.inflate(find("visuals").textContent));
    unpacked.visuals.forEach((visual, i) => { visual.materials = run.visuals[i]; });
    notice(unpacked.frames.length ? "" : "No frames were recorded.");
  }
  find("three").remove();
  find("frames").remove();
  find("visuals").remove();

  const { bodies: shapes, frames } = unpacked;
  const times = run.rows.time;
  const last = times.length - 1;
  const legend_top = Object.fromEntries(field_names.map((field) => [field, text.round_up(run[field].usual)]));
  const modes = { color: [...field_names, "body"], contacts: ["off", "motion", "region"] };
  const switches = ["wire", "flat", "xray", "visual", "colliders", "lines", "labels", "follow", "light", "panel"];
  const state = {
    frame: 0, time: 0, playing: false, rate: 1, color: "speed", contacts: "motion", wire: false, flat: false,
    xray: false, visual: true, colliders: true, lines: true, labels: false, follow: true, light: false, panel: true,
    recording: false,
  };

  let scene = null;
  if (!document.createElement("canvas").getContext("webgl"))
    fail("no WebGL", "The three-dimensional view needs WebGL, which is not available in this browser. Enable hardware "
      + "acceleration or use another browser. The plots work without WebGL.");
  else if (!root.dataset.error)
    scene = make_scene(find, run, unpacked, state, legend_top, (follow) => {
      if (state.follow !== follow) set_pressed("follow", follow);
    });
  root.classList.toggle("plain", !scene);

  const rows = run.rows;
  const floor = Math.min(...rows.potential.filter((value) => value !== null), Infinity);
  const potential = rows.potential.map((value) => (value === null ? null : value - floor));
  const total = rows.kinetic.map((kinetic, i) => kinetic + rows.elastic[i] + potential[i]);
  const plots = [
    make_plot(find("energy_plot"), times, [
      { name: "total", color: "var(--text)", values: total },
      { name: "kinetic", color: "var(--kinetic)", values: rows.kinetic },
      { name: "potential", color: "var(--potential)", values: potential },
      { name: "elastic", color: "var(--elastic)", values: rows.elastic },
      { name: "dissipated", color: "var(--dissipated)", values: rows.dissipated },
    ], (value) => text.si(value, "J"), go_to),
    make_plot(find("contact_plot"), times, [
      { name: "contacts", color: "var(--text)", values: rows.contacts },
      { name: "stick", color: "var(--stick)", values: rows.stick },
      { name: "slide", color: "var(--slide)", values: rows.slide },
      { name: "regions", color: "var(--potential)", values: rows.regions },
    ], (value) => String(+value.toFixed(2)), go_to),
  ];

  const clock_text = () => (times.length ? state.time.toFixed(3) + " s" : "");
  // Draws what is between the frame and the next, and says where that is.
  function show() {
    const next = Math.min(state.frame + 1, last), width = times[next] - times[state.frame];
    const blend = width > 0 ? Math.min(Math.max((state.time - times[state.frame]) / width, 0), 0.9999) : 0;
    if (frames.length > 0 && scene) scene.show(state.frame, blend);
    find("scrub").value = state.frame + blend;
    if (shown.frame !== state.frame || shown.time !== state.time) {
      if (shown.frame !== state.frame) plots.forEach((plot) => plot.show(state.frame));
      const time = document.createElement("b");
      time.textContent = clock_text();
      find("clock").replaceChildren(time, times.length ? "  frame " + state.frame + " of " + last : "no frames");
      find("scrub").setAttribute("aria-valuetext", clock_text());
      Object.assign(shown, { frame: state.frame, time: state.time });
    }
    root.dataset.frame = state.frame;
    root.dataset.color = state.color;
  }
  const shown = { frame: -1, time: NaN };

  // `place` in frames, between two of them what is between.
  function go_to(place) {
    set_playing(false);
    const kept = Math.min(Math.max(Number(place) || 0, 0), Math.max(last, 0));
    state.frame = Math.floor(kept);
    const next = Math.min(state.frame + 1, last);
    state.time = times.length ? times[state.frame] + (kept - state.frame) * (times[next] - times[state.frame]) : 0;
    show();
  }
  function go_to_time(time) {
    state.time = Math.min(Math.max(time, times[0]), times[last]);
    if (times[state.frame] > state.time) state.frame = 0;
    while (state.frame < last && times[state.frame + 1] <= state.time) ++state.frame;
    show();
  }
  function set_playing(on) {
    state.playing = on && last > 0 && !state.recording;
    if (state.playing && state.time >= times[last]) go_to_start();
    find("play").querySelector("path").setAttribute("d",
      state.playing ? "M6 5h4v14H6zM14 5h4v14h-4z" : "M8 5v14l11-7z");
  }
  function go_to_start() {
    state.frame = 0;
    state.time = times[0];
  }
  function set_mode(name, value) {
    if (!modes[name].includes(value)) return;
    state[name] = value;
    for (const button of find(name).querySelectorAll("button")) {
      button.setAttribute("role", "radio");
      button.setAttribute("aria-checked", button.dataset.value === value);
    }
    show_color_legend(find("color_legend"), state.color, run, shapes, legend_top);
    show_contact_legend(find("contact_legend"), state.contacts, run);
    show();
  }
  function set_pressed(name, on) {
    state[name] = on;
    document.querySelector('[data-switch="' + name + '"]').setAttribute("aria-pressed", on);
  }
  function set_switch(name, on) {
    set_pressed(name, on);
    if (name === "panel") root.classList.toggle("bare", !on);
    if (name === "light") {
      root.classList.toggle("light", on);
      if (scene) scene.set_light(on);
      plots.forEach((plot) => plot.draw());
    }
    if (name === "follow" && scene) scene.view.follow(on);
    if (name === "lines") show_line_legend(find("line_legend"), on, run);
    show();
  }
  function set_rate(rate) {
    const select = find("rate").querySelector("select");
    if (![...select.options].some((option) => option.value === String(rate))) return;
    select.value = String(rate);
    state.rate = rate;
  }

  const file_name = () => (run.title || "run").replace(/[^\p{L}\p{N}_-]+/gu, "_");
  function save_picture() {
    if (!scene) return;
    show();
    scene.view.render();
    scene.picture.compose();
    scene.picture.canvas.toBlob((blob) => {
      save(blob, file_name() + "_" + state.time.toFixed(3) + "s.png");
      root.dataset.picture = blob.size;
    });
  }
  // All of the run, at the pace that is set, 30 pictures a second; a second click gives up.
  async function record_run() {
    if (state.recording) {
      state.recording = false;
      return;
    }
    if (!scene || last < 1) return;
    if (!video_type()) {
      notice("This browser cannot record videos: it lacks MediaRecorder or a supported video format. "
        + "Use another browser.");
      return;
    }
    const button = find("record"), label = button.textContent, place = state.frame, pictures_a_second = 30;
    set_playing(false);
    state.recording = true;
    button.setAttribute("aria-pressed", true);
    try {
      const count = Math.round((times[last] - times[0]) / state.rate * pictures_a_second) + 1;
      const blob = await record(scene.picture.canvas, count, pictures_a_second, (i) => {
        go_to_time(times[0] + i * state.rate / pictures_a_second);
        scene.view.render();
        scene.picture.compose();
      }, (share) => {
        button.textContent = Math.floor(100 * share) + "\u202f% \u2013 stop";
        return state.recording;
      });
      if (blob) {
        save(blob, file_name() + (blob.type.endsWith("mp4") ? ".mp4" : ".webm"));
        root.dataset.video = blob.size;
        root.dataset.pictures = count;
      }
    } finally {
      state.recording = false;
      button.textContent = label;
      button.setAttribute("aria-pressed", false);
      go_to(place);
    }
  }

  // #frame=30&color=stress&contacts=region&wire=1&flat=1&xray=1&visual=0&colliders=0&lines=0&labels=1&light=1&panel=0
  // &play=1&rate=0.5&view=turn,lift,distance; in place of a frame, time=0.5 [s]
  function read_hash() {
    const asked = new URLSearchParams(location.hash.slice(1));
    for (const name in modes) if (asked.has(name)) set_mode(name, asked.get(name));
    for (const name of switches) if (asked.has(name)) set_switch(name, asked.get(name) !== "0");
    if (asked.has("rate")) set_rate(Number(asked.get("rate")));
    if (asked.has("view") && scene) {
      const numbers = asked.get("view").split(",").map(Number);
      if (numbers.length === 3 && numbers.every(isFinite)) scene.view.look(...numbers);
    }
    if (asked.has("frame")) go_to(asked.get("frame"));
    if (asked.has("time") && times.length) {
      set_playing(false);
      go_to_time(Number(asked.get("time")) || 0);
    }
    if (asked.has("play")) set_playing(asked.get("play") !== "0");
    return ["frame", "time", "play"].some((name) => asked.has(name));
  }

  const flip = (name) => () => set_switch(name, !state[name]);
  const move = (action) => () => { if (scene) action(scene.view); };
  const frame_by = (step) => () => go_to(Math.round(state.frame) + step);
  listen_to_keys(find, [
    [[" "], "play or pause", () => { set_playing(!state.playing); show(); }],
    [["ArrowLeft"], "one frame back; with Shift: ten frames", (shift) => frame_by(shift ? -10 : -1)()],
    [["ArrowRight"], "one frame forward; with Shift: ten frames", (shift) => frame_by(shift ? 10 : 1)()],
    [["Home"], "to the start", () => go_to(0)],
    [["End"], "to the end", () => go_to(last)],
    ...modes.color.map((name, i) => [[String(i + 1)], "colour by "
      + (fields[name] ? fields[name].lower : "body"), () => set_mode("color", name)]),
    [["c"], "contacts: off, stick or slide, regions", () =>
      set_mode("contacts", modes.contacts[(modes.contacts.indexOf(state.contacts) + 1) % 3])],
    [["n"], "show or hide the names of bodies", flip("labels")],
    [["x"], "transparent bodies", flip("xray")],
    [["w"], "show or hide the edges of surfaces", flip("wire")],
    [["f"], "flat shading", flip("flat")],
    [["s"], "visual surfaces, or the simulated surfaces", flip("visual")],
    [["o"], "show or hide colliders", flip("colliders")],
    [["j"], "show or hide joints, ties, cables and springs", flip("lines")],
    [["v"], "initial view, which follows the bodies", () => set_switch("follow", true)],
    [["[", "]"], "turn the view; with Shift: up and down", (shift, key) =>
      move((to) => (/[[\]]/.test(key) ? to.turn(key === "[" ? 20 : -20, 0) : to.turn(0, key === "{" ? 20 : -20)))()],
    [["+", "-"], "zoom in or out", (shift, key) => move((to) => to.zoom(key === "+" || key === "=" ? 0.85 : 1.18))()],
    [["h"], "show or hide the panel and the controls", flip("panel")],
    [["l"], "light or dark colours", flip("light")],
    [["p"], "save a picture (PNG)", save_picture],
    [["r"], "record the run as a video at this playback speed (keep the page visible); again: stop", record_run],
  ]);
  for (const name in modes)
    for (const button of find(name).querySelectorAll("button"))
      button.addEventListener("click", () => set_mode(name, button.dataset.value));
  for (const button of document.querySelectorAll("[data-switch]"))
    button.addEventListener("click", flip(button.dataset.switch));
  find("play").addEventListener("click", () => { set_playing(!state.playing); show(); });
  find("picture").addEventListener("click", save_picture);
  find("record").addEventListener("click", record_run);
  find("scrub").addEventListener("input", () => go_to(find("scrub").value));
  find("rate").querySelector("select").addEventListener("change", (event) => set_rate(Number(event.target.value)));
  window.addEventListener("hashchange", read_hash);

  // At the end the picture stands for a moment, then begins again.
  const pause = 0.8;  // s
  let then = null, rested = 0;
  function tick(now) {
    const passed = then === null ? 0 : Math.min((now - then) / 1000, 0.25);
    then = now;
    if (state.playing) {
      if (state.time < times[last]) {
        rested = 0;
        go_to_time(state.time + passed * state.rate);
      } else if ((rested += passed) > pause) {
        go_to_start();
        show();
      }
    }
    if (scene) {
      scene.render();
      if (!root.dataset.ready) {
        root.dataset.frames = frames.length;
        root.dataset.ready = "true";
      }
    }
    requestAnimationFrame(tick);
  }

  find("scrub").max = Math.max(last, 0);
  document.querySelector('[data-switch="visual"]').hidden = run.visuals.length === 0;
  document.querySelector('[data-switch="lines"]').hidden = run.lines.length === 0;
  for (const name in modes) set_mode(name, state[name]);
  for (const name of switches) set_switch(name, state[name]);
  go_to(0);
  if (!read_hash()) set_playing(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  requestAnimationFrame(tick);
})();
