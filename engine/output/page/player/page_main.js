// Puts the page together: state, controls, and the loop that plays.
"use strict";

(() => {
  const find = (id) => document.getElementById(id);
  const root = document.documentElement;

  function notice(message) {
    find("notice").textContent = message;
    find("notice").hidden = false;
  }
  // A check of the page reads these marks: data-ready after the first picture, data-error after a failure.
  window.addEventListener("error", (event) => {
    root.dataset.error = event.message;
    notice("This page failed: " + event.message);
  });
  document.addEventListener("securitypolicyviolation", (event) => {
    root.dataset.error = "blocked " + event.blockedURI;
  });

  const run = JSON.parse(find("run").textContent);
  const frames = [...document.querySelectorAll("#frames > script")]
    .map((element) => decode.frame(element.textContent, run.bodies));
  find("frames").remove();
  const times = run.rows.time;
  const last = frames.length - 1;
  const legend_top = { speed: text.round_up(run.speed.usual), stress: text.round_up(run.stress.usual) };
  const units = { speed: "m/s", stress: "Pa" };
  const modes = { color: ["speed", "stress", "body"], contacts: ["off", "motion", "region"] };
  const state = {
    frame: 0, time: 0, playing: false, rate: 1, color: "speed", contacts: "motion", wire: false, flat: false,
    xray: false, colliders: true,
  };
  const many = (number, one, more) => text.count(number) + " " + (number === 1 ? one : more);

  const gravity = new THREE.Vector3(...run.gravity);
  const up = gravity.length() > 0 ? gravity.clone().negate().normalize() : new THREE.Vector3(0, 0, 1);
  const box = measure_scene(run, frames);
  let view = null, bodies, contacts, colliders;
  try {
    view = make_view(find("view"), up, box);
  } catch (error) {
    notice("The three-dimensional view needs WebGL, which this browser does not offer. The plots work without it.");
    root.dataset.error = "no WebGL";
  }
  if (view) {
    bodies = make_bodies(view.scene, run.bodies, frames, legend_top);
    contacts = make_contacts(view.scene, Math.max(0, ...run.rows.contacts), box, run.force.usual || 1);
    colliders = make_colliders(view.scene, run.colliders, box);
    if (frames.length === 0) notice("No frames were recorded.");
  }

  const rows = run.rows;
  const floor = Math.min(...rows.potential.filter((value) => value !== null), Infinity);
  const potential = rows.potential.map((value) => (value === null ? null : value - floor));
  const total = rows.kinetic.map((kinetic, i) => kinetic + rows.elastic[i] + potential[i]);
  const plots = [
    make_plot(find("energy_plot"), times, [
      { name: "total", color: "#e8ebef", values: total },
      { name: "kinetic", color: "#6cb6ff", values: rows.kinetic },
      { name: "potential", color: "#b8a6e0", values: potential },
      { name: "elastic", color: "#7fbf7b", values: rows.elastic },
      { name: "dissipated", color: "#e07f72", values: rows.dissipated },
    ], (value) => text.si(value, "J"), go_to),
    make_plot(find("contact_plot"), times, [
      { name: "contacts", color: "#e8ebef", values: rows.contacts },
      { name: "stick", color: colors.motion.stick, values: rows.stick },
      { name: "slide", color: colors.motion.slide, values: rows.slide },
      { name: "regions", color: "#b8a6e0", values: rows.regions },
    ], (value) => String(+value.toFixed(2)), go_to),
  ];

  function show_summary() {
    const r = run.report;
    find("title").textContent = run.title || "Run";
    find("subtitle").textContent = many(r.bodies, "body", "bodies") + ", " + many(r.elements, "element", "elements")
      + ", "
      + text.si(r.time, "s") + " in " + many(r.steps, "step", "steps");
    const items = [
      ["Bodies", text.count(r.bodies)], ["Elements", text.count(r.elements)],
      ["Nodes", text.count(r.nodes)], ["Steps", text.count(r.steps)],
      ["Simulated time", text.si(r.time, "s")], ["Mean step", r.steps ? text.si(r.time / r.steps, "s") : "\u2013"],
      ["Contacts, mean and most", text.average(r.mean_contacts) + ", " + text.count(r.max_contacts)],
      ["Regions, mean and most", text.average(r.mean_regions) + ", " + text.count(r.max_regions)],
      ["Largest region", many(r.largest_region, "contact", "contacts")],
      ["Sweeps by solved region", text.average(r.mean_iterations)],
      ["Regions not converged", text.count(r.unconverged) + " of " + text.count(r.solved)],
      ["Deepest overlap", text.si(r.max_penetration, "m")],
    ];
    for (const [name, value] of items) add_item(name, value);
    const code = document.createElement("code");
    code.textContent = r.state_hash;
    add_item("State hash", code).className = "wide";
  }
  function add_item(name, value) {
    const item = document.createElement("div"), term = document.createElement("dt"),
      about = document.createElement("dd");
    term.textContent = name;
    about.append(value);
    item.append(term, about);
    find("summary").append(item);
    return item;
  }

  function show_legends() {
    const [name, bar, ticks] = find("color_legend").children;
    const by_value = state.color !== "body";
    bar.hidden = !by_value;
    ticks.className = by_value ? "ticks" : "bodies";
    ticks.replaceChildren();
    const add = (content, swatch) => {
      const label = document.createElement("span");
      if (swatch) {
        const spot = document.createElement("i");
        spot.className = "swatch";
        spot.style.background = swatch;
        label.append(spot);
      }
      label.append(content);
      ticks.append(label);
    };
    if (by_value) {
      name.textContent = state.color === "speed" ? "Speed" : "Von Mises stress";
      const pen = bar.getContext("2d"), top = legend_top[state.color];
      for (let i = 0; i < 256; ++i) {
        pen.fillStyle = colors.css(colors.at(state.color, i / 255));
        pen.fillRect(i, 0, 1, 1);
      }
      add("0");
      add(text.si(top / 2, units[state.color]));
      add((run[state.color].max > top ? "\u2265\u202f" : "") + text.si(top, units[state.color]));
    } else {
      name.textContent = many(run.bodies.length, "body", "bodies");
      run.bodies.slice(0, 10).forEach((body, i) => add(body.name || "body " + i, colors.css(colors.of_body(i))));
      if (run.bodies.length > 10) add("and " + text.count(run.bodies.length - 10) + " more");
    }
    show_contact_legend();
  }
  function show_contact_legend() {
    const card = find("contact_legend");
    card.hidden = state.contacts === "off" || run.force.max === 0;
    card.replaceChildren();
    const add = (content, swatch) => {
      const line = document.createElement("div");
      if (swatch) {
        const spot = document.createElement("i");
        spot.className = "swatch";
        spot.style.background = swatch;
        line.append(spot);
      }
      line.append(content);
      card.append(line);
    };
    if (state.contacts === "motion") for (const name of ["stick", "slide", "open"]) add(name, colors.motion[name]);
    else add("one colour by contact region");
    add("arrows: root of the force");
    add("strongest " + text.si(run.force.max, "N"));
  }

  // Draws the frame, between frames the mean of two, and says where it is.
  function show() {
    if (frames.length > 0 && view) {
      const next = Math.min(state.frame + 1, last), width = times[next] - times[state.frame];
      const share = (state.time - times[state.frame]) / width;
      const blend = state.playing && width > 0 ? Math.min(Math.max(share, 0), 0.999) : 0;
      root.dataset.bodies = bodies.show(frames[state.frame], frames[next], blend, state.color);
      contacts.show(frames[state.frame].contacts, state.contacts);
      colliders.show(frames[state.frame], state.colliders);
      bodies.style(state);
      view.touch();
    }
    if (shown.frame !== state.frame || shown.time !== times[state.frame]) {
      plots.forEach((plot) => plot.show(state.frame));
      find("scrub").value = state.frame;
      const time = document.createElement("b");
      time.textContent = frames.length ? times[state.frame].toFixed(3) + " s" : "";
      find("clock").replaceChildren(time, frames.length ? "  frame " + state.frame + " of " + last : "no frames");
      Object.assign(shown, { frame: state.frame, time: times[state.frame] });
    }
    root.dataset.frame = state.frame;
    root.dataset.color = state.color;
  }
  const shown = { frame: -1, time: NaN };

  function go_to(frame) {
    set_playing(false);
    state.frame = Math.min(Math.max(Math.round(frame) || 0, 0), Math.max(last, 0));
    state.time = times[state.frame] || 0;
    show();
  }
  function set_playing(on) {
    state.playing = on && last > 0;
    if (state.playing && state.frame >= last) {
      state.frame = 0;
      state.time = times[0];
    }
    find("play").querySelector("path").setAttribute("d",
      state.playing ? "M6 5h4v14H6zM14 5h4v14h-4z" : "M8 5v14l11-7z");
  }
  function set_mode(name, value) {
    if (!modes[name].includes(value)) return;
    state[name] = value;
    for (const button of find(name).querySelectorAll("button")) {
      button.setAttribute("role", "radio");
      button.setAttribute("aria-checked", button.dataset.value === value);
    }
    show_legends();
    show();
  }
  function set_switch(name, on) {
    state[name] = on;
    find("switches").querySelector('[data-switch="' + name + '"]').setAttribute("aria-pressed", on);
    show();
  }
  function set_rate(rate) {
    const select = find("rate").querySelector("select");
    if (![...select.options].some((option) => option.value === String(rate))) return;
    select.value = String(rate);
    state.rate = rate;
  }

  // #frame=30&color=stress&contacts=region&wire=1&flat=1&xray=1&colliders=0&play=1&rate=0.5&view=turn,lift,distance
  function read_hash() {
    const asked = new URLSearchParams(location.hash.slice(1));
    for (const name in modes) if (asked.has(name)) set_mode(name, asked.get(name));
    for (const name of ["wire", "flat", "xray", "colliders"])
      if (asked.has(name)) set_switch(name, asked.get(name) !== "0");
    if (asked.has("rate")) set_rate(Number(asked.get("rate")));
    if (asked.has("view") && view) {
      const numbers = asked.get("view").split(",").map(Number);
      if (numbers.length === 3 && numbers.every(isFinite)) view.look(...numbers);
    }
    if (asked.has("frame")) go_to(Number(asked.get("frame")));
    if (asked.has("play")) set_playing(asked.get("play") !== "0");
    return asked.has("frame") || asked.has("play");
  }

  for (const name in modes)
    for (const button of find(name).querySelectorAll("button"))
      button.addEventListener("click", () => set_mode(name, button.dataset.value));
  for (const button of find("switches").children)
    button.addEventListener("click", () => set_switch(button.dataset.switch, !state[button.dataset.switch]));
  find("play").addEventListener("click", () => { set_playing(!state.playing); show(); });
  find("scrub").addEventListener("input", () => go_to(Number(find("scrub").value)));
  find("rate").querySelector("select").addEventListener("change", (event) => set_rate(Number(event.target.value)));
  window.addEventListener("hashchange", read_hash);
  window.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
    const jump = event.shiftKey ? 10 : 1;
    const keys = {
      " ": () => { set_playing(!state.playing); show(); },
      ArrowLeft: () => go_to(state.frame - jump), ArrowRight: () => go_to(state.frame + jump),
      Home: () => go_to(0), End: () => go_to(last),
      1: () => set_mode("color", "speed"), 2: () => set_mode("color", "stress"), 3: () => set_mode("color", "body"),
      c: () => set_mode("contacts", modes.contacts[(modes.contacts.indexOf(state.contacts) + 1) % 3]),
      x: () => set_switch("xray", !state.xray), w: () => set_switch("wire", !state.wire),
      f: () => set_switch("flat", !state.flat),
      o: () => set_switch("colliders", !state.colliders),
    };
    const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });

  // At the end the picture stands for a moment, then begins again.
  const pause = 0.8;  // s
  let then = null;
  function tick(now) {
    const passed = then === null ? 0 : Math.min((now - then) / 1000, 0.25);
    then = now;
    if (state.playing) {
      state.time += passed * state.rate;
      if (state.time > times[last] + pause * state.rate) {
        state.time = times[0];
        state.frame = 0;
      }
      while (state.frame < last && times[state.frame + 1] <= state.time) ++state.frame;
      show();
    }
    if (view) {
      view.render();
      if (!root.dataset.ready) {
        root.dataset.frames = frames.length;
        root.dataset.ready = "true";
      }
    }
    requestAnimationFrame(tick);
  }

  find("scrub").max = Math.max(last, 0);
  show_summary();
  show_stages(find("stages"), run.report);
  for (const name in modes) set_mode(name, state[name]);
  for (const name of ["wire", "flat", "xray", "colliders"]) set_switch(name, state[name]);
  show_legends();
  go_to(0);
  if (!read_hash()) set_playing(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  requestAnimationFrame(tick);
})();
