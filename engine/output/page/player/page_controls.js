// Buttons, keys and address of the page: how a run is shown, recorded or live.
"use strict";

const initial_state = {
  frame: 0, time: 0, playing: false, rate: 1, color: "speed", contacts: "motion", wire: false, flat: false,
  xray: false, visual: true, colliders: true, lines: true, labels: false, follow: true, light: false, panel: true,
  legend: true,
  recording: false, fields: field_names,
};

// page: {find, run, state, scales, scene, plots}; scene may be null. player: the functions that differ between recorded
// and live runs: show() draws, toggle() plays or pauses, set_rate(rate), colored(color), keys, read(asked).
function make_controls(page, player) {
  const { find, run, state, scales } = page, root = document.documentElement;
  const modes = { color: ["speed", "stress", "strain", "body", "error"], contacts: ["off", "motion", "region"] };
  const switches = ["wire", "flat", "xray", "visual", "colliders", "lines", "labels", "follow", "light", "panel",
    "legend"];

  function show_legends() {
    show_color_legend(find("color_legend"), state.color, page.bodies(), scales);
    show_contact_legend(find("contact_legend"), state.contacts, scales);
    show_line_legend(find("line_legend"), state.lines, run, scales);
    document.querySelector('[data-switch="visual"]').hidden = run.visuals.length === 0;
    document.querySelector('[data-switch="lines"]').hidden = run.lines.length === 0;
  }
  function set_mode(name, value) {
    if (!modes[name].includes(value)) return;
    state[name] = value;
    for (const button of find(name).querySelectorAll("button")) {
      button.setAttribute("role", "radio");
      button.setAttribute("aria-checked", button.dataset.value === value);
    }
    if (name === "color") player.colored(value);
    show_legends();
    player.show();
  }
  function set_pressed(name, on) {
    state[name] = on;
    document.querySelector('[data-switch="' + name + '"]').setAttribute("aria-pressed", on);
  }
  function set_switch(name, on) {
    set_pressed(name, on);
    if (name === "panel") root.classList.toggle("bare", !on);
    if (name === "legend") root.classList.toggle("folded", !on);
    if (name === "light") {
      root.classList.toggle("light", on);
      if (page.scene) page.scene.colliders.set_light(on);
      page.plots.forEach((plot) => plot.draw());
    }
    if (name === "follow" && page.scene) page.scene.view.follow(on);
    if (name === "lines") show_legends();
    player.show();
  }
  function set_rate(rate) {
    const select = find("rate").querySelector("select");
    if (![...select.options].some((option) => option.value === String(rate))) return;
    select.value = String(rate);
    player.set_rate(rate);
  }
  function save_picture() {
    if (!page.scene) return;
    player.show();
    page.scene.compose();
    page.scene.picture.canvas.toBlob((blob) => {
      save(blob, file_name(run) + "_" + state.time.toFixed(3) + "s.png");
      root.dataset.picture = blob.size;
    });
  }

  // #color=stress&contacts=region&wire=1&flat=1&xray=1&visual=0&colliders=0&lines=0&labels=1&light=1&panel=0&legend=0
  // &rate=0.5&view=turn,lift,distance; more: see the players. Returns whether it names a time of a recorded run.
  function read_hash() {
    const asked = new URLSearchParams(location.hash.slice(1));
    for (const name in modes) if (asked.has(name)) set_mode(name, asked.get(name));
    for (const name of switches) if (asked.has(name)) set_switch(name, asked.get(name) !== "0");
    if (asked.has("rate")) set_rate(Number(asked.get("rate")));
    if (asked.has("view") && page.scene) {
      const numbers = asked.get("view").split(",").map(Number);
      if (numbers.length === 3 && numbers.every(isFinite)) page.scene.view.look(...numbers);
    }
    return player.read(asked);
  }

  const flip = (name) => () => set_switch(name, !state[name]);
  const move = (action) => () => { if (page.scene) action(page.scene.view); };
  listen_to_keys(find, [
    [[" "], "play or pause", player.toggle],
    ...player.keys,
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
    [["e"], "show or hide the legends", flip("legend")],
    [["h"], "show or hide the panel and the controls", flip("panel")],
    [["l"], "light or dark colours", flip("light")],
    [["p"], "save a picture (PNG)", save_picture],
  ]);
  for (const name in modes)
    for (const button of find(name).querySelectorAll("button"))
      button.addEventListener("click", () => set_mode(name, button.dataset.value));
  for (const button of document.querySelectorAll("[data-switch]"))
    button.addEventListener("click", flip(button.dataset.switch));
  find("play").addEventListener("click", player.toggle);
  find("picture").addEventListener("click", save_picture);
  find("rate").querySelector("select").addEventListener("change", (event) => set_rate(Number(event.target.value)));
  window.addEventListener("hashchange", read_hash);

  page.follow_changed = (follow) => { if (state.follow !== follow) set_pressed("follow", follow); };
  // Calls everything once, so that the page shows the initial state.
  function start() {
    for (const name in modes) set_mode(name, state[name]);
    for (const name of switches) set_switch(name, state[name]);
  }
  return { start, read_hash, show_legends };
}

const file_name = (run) => (run.title || "run").replace(/[^\p{L}\p{N}_-]+/gu, "_");

function show_playing(find, on) {
  find("play").querySelector("path").setAttribute("d", on ? "M6 5h4v14H6zM14 5h4v14h-4z" : "M8 5v14l11-7z");
  find("play").setAttribute("aria-label", on ? "Pause" : "Play");
}

function show_clock(find, strong, rest) {
  const time = document.createElement("b");
  time.textContent = strong;
  find("clock").replaceChildren(time, rest);
}
