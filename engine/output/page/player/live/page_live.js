// Shows and controls a run that is being simulated.
"use strict";

// Columns of the plots by name. They have the values of the last `kept` rows.
const live_columns = ["time", "kinetic", "elastic", "potential", "dissipated", "contacts", "stick", "slide", "regions"];

function make_live_rows(kept = 600) {
  const rows = Object.fromEntries(live_columns.map((name) => [name, []]));
  let probes = [];  // by plot, by column: values
  const push = (column, value) => {
    column.push(value === undefined ? null : value);
    if (column.length > kept) column.shift();
  };
  function begin(plots) {
    for (const column of Object.values(rows)) column.length = 0;
    probes = plots.map(({ columns }) => columns.map(() => []));
    return probes;
  }
  function add(row) {
    for (const name of live_columns) push(rows[name], row[name]);
    probes.forEach((columns, plot) => columns.forEach((column, k) => push(column, row.probes[plot][k])));
  }
  return { rows, begin, add };
}

// Plots of the probes, one for each unit of a probe. values: by probe, by column.
function make_probe_plots(host, probes, values, times) {
  const plots = [];
  host.replaceChildren();
  probes.forEach(({ name, columns }, probe) => {
    for (const unit of new Set(columns.map((column) => column.unit))) {
      const section = document.createElement("section"), title = document.createElement("h2"),
        plot = document.createElement("div");
      title.textContent = name;
      plot.className = "plot";
      section.append(title, plot);
      host.append(section);
      const series = columns.map((column, k) => ({ ...column, values: values[probe][k] }))
        .filter((column) => column.unit === unit)
        .map((column, k) => ({ ...column, color: colors.css(colors.of_body(k)) }));
      plots.push(make_plot(plot, times, series, (value) => text.si(value, unit), null));
    }
  });
  return plots;
}

function make_live(page, has_view) {
  const { find, run, state } = page, root = document.documentElement;
  const memory = make_live_scales(), { rows, begin: begin_rows, add: add_row } = make_live_rows();
  const link = make_link(receive, show_status), pull = make_pull(page, link), visuals = [];
  const lists = ["bodies", "visual_of_body", "visuals", "colliders", "lines"];
  const clear_run = () => lists.forEach((name) => { run[name] = []; });
  let decoder = null, frame = null, sliders = null, controls = null;
  let row_next = null, row = null;  // rows of the frame that will arrive next, and of `frame`
  let is_new = false;               // the frame has not been drawn
  let is_stale = false;             // the panel shows an older row
  let aim = null;                   // make_aim of the scene
  let has_begun = false;            // since the page is connected
  let refusal = "";                 // problem in place of a begin
  let refreshed = 0, drawn = 0;
  page.scales = memory.scales;
  state.fields = ["speed"];
  clear_run();
  const run_plots = make_run_plots(find, rows, null);
  page.plots = run_plots;

  async function receive(data) {
    if (data instanceof ArrayBuffer) return take_frame(new Uint8Array(data));
    const message = JSON.parse(data);
    const handlers = { begin, add, row: take_row, state: take_state, problem: show_problem };
    if (handlers[message.type]) await handlers[message.type](message);
  }
  async function begin({ run: described, state: first_state, sliders: movable, plots }) {
    has_begun = true;
    link.settle();
    pull.forget();
    clear_run();
    visuals.length = 0;
    const { title, gravity } = described;
    Object.assign(run, { title, gravity });
    find("title").textContent = document.title = title || "Run";
    await add(described);
    decoder = decode.decoder(run.bodies, field_names, true);
    page.bodies = () => decoder.bodies;
    frame = null;
    is_new = is_stale = false;
    if (page.scene) page.scene.clear();
    memory.clear();
    page.plots = [...run_plots, ...make_probe_plots(find("probe_plots"), plots, begin_rows(plots), rows.time)];
    find("sliders").hidden = movable.length === 0;
    sliders = make_sliders(find("sliders"), movable, (number, value) => link.send({ do: "slider", number, value }));
    page.notice("");
    take_state(first_state);
    ask_for_fields();
    controls.show_legends();
  }
  // Appends new objects to the lists of the run. more: the members of a message "add".
  async function add(more) {
    for (const name of lists) run[name].push(...(more[name] || []));
    if (more.visual_stream) visuals.push(...decode.visuals(await decode.inflate(more.visual_stream)));
    visuals.forEach((visual, i) => { visual.materials = run.visuals[i]; });
    if (page.scene && frame) (more.colliders || []).forEach(page.scene.colliders.add);
  }
  function take_row(received) {
    row_next = received;
    add_row(received);
    memory.widen(received.top, performance.now() / 1000);
  }
  function take_frame(bytes) {
    const is_first = frame === null;
    [frame] = decoder.add(bytes);
    row = row_next;
    is_new = is_stale = true;
    if (!has_view) return;
    if (!page.scene) make_first_scene();
    const { bodies, colliders } = page.scene;
    if (is_first) run.colliders.forEach(colliders.add);
    bodies.list.forEach((body, number) => {
      if (frame.bodies.has(number)) return;
      bodies.remove(number);
      delete decoder.bodies[number];
    });
    for (const [number, place] of frame.bodies)
      if (!bodies.list[number])
        bodies.add(number, decoder.bodies[number], visuals[run.visual_of_body[number]], place);
  }
  function make_first_scene() {
    const box = measure_scene(run, decoder.bodies, [frame]);
    page.scene = make_scene(page, box, page.follow_changed, pull);
    aim = make_aim(box.course[0]);
    controls.read_hash();
  }
  function take_state({ playing, rate, gravity }) {
    Object.assign(state, { playing, rate });
    show_playing(find, playing);
    root.dataset.playing = playing;
    find("gravity").checked = gravity;
    const select = find("rate").querySelector("select");
    if (![...select.options].some((option) => option.value === String(rate)))
      select.add(new Option(rate + "\u00d7", String(rate)));
    select.value = String(rate);
    if (playing) page.notice("");
  }
  // A problem stays while the run pauses for it, and otherwise for some seconds.
  function show_problem({ text: about }) {
    if (!has_begun) refusal = about;
    page.notice(about);
    setTimeout(() => { if (state.playing && find("notice").textContent === about) page.notice(""); }, 8000);
  }
  function show_status(name, seconds) {
    if (name === "connecting") {
      has_begun = false;
      refusal = "";
    }
    if (name === "lost" && refusal) name = "full";
    root.dataset.live = name;
    if (name !== "open") pull.forget();
    const again = "Trying again in " + text.si(seconds, "s") + ".";
    const [short, long] = {
      connecting: ["connecting \u2026", null], open: ["live", null],
      full: ["not connected", refusal + ". " + again],
      lost: ["connection lost", "The program that runs the scene does not answer. It has ended, or the connection was "
        + "lost. " + again],
      refused: ["connection refused", "The program refused the connection. The address of this page lacks the right "
        + "token, or too many pages are open. Open the address that the program printed. " + again],
    }[name];
    find("subtitle").textContent = short;
    if (long !== null) page.notice(long);
  }
  // Only fields that are shown are computed.
  function ask_for_fields() {
    const names = state.fields.filter((name) => name !== "speed");
    link.send({ do: "fields", names });
  }
  function colored(color) {
    const wanted = [...new Set(["speed", ...(fields[color] ? [color] : [])])];
    if (wanted.join() === state.fields.join()) return;
    state.fields = wanted;
    ask_for_fields();
  }

  function show() {
    root.dataset.color = state.color;
    if (!frame || !page.scene) return;
    page.scene.show(frame, frame, 0, 0);
  }
  function draw_new() {
    is_new = false;
    state.time = row.time;
    pull.measured(row.pull);
    if (page.scene && state.follow) page.scene.view.aim(aim(frame, performance.now() / 1000));
    show();
    if (page.scene) page.scene.render();
    link.send({ do: "seen", number: row.number });
    root.dataset.drawn = ++drawn;
    Object.assign(root.dataset, { number: row.number, time: row.time });
    root.dataset.ready = "true";
  }
  // Updates clock, plots, legends and sliders, less often than the picture.
  function refresh() {
    const pace = row.speed > 0 ? "  " + text.unitless(row.speed) + "\u00d7 real time" : "";
    show_clock(find, row.time.toFixed(3) + " s", pace);
    page.plots.forEach((plot) => plot.update());
    sliders.show(row.sliders, row.number);
    controls.show_legends();
  }
  function tick(now) {
    requestAnimationFrame(tick);
    pull.tick();
    if (is_new) draw_new();
    else if (page.scene) page.scene.render();
    if (!is_stale || now - refreshed < 150) return;
    is_stale = false;
    refreshed = now;
    refresh();
  }
  function start(made) {
    controls = made;
    controls.read_hash();
    link.connect();
    requestAnimationFrame(tick);
  }

  const order = (name) => () => link.send({ do: name });
  const toggle = () => link.send({ do: state.playing ? "pause" : "play" });
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  function toggle_pull() {
    if (pull.is_held()) return pull.drop();
    if (!page.scene || !pull.grab_middle()) show_problem({ text: "No body is near the middle of the view." });
  }
  const set_gravity = (on) => link.send({ do: "gravity", on });
  find("step").addEventListener("click", order("step"));
  find("reset").addEventListener("click", order("reset"));
  find("gravity").addEventListener("change", () => set_gravity(find("gravity").checked));
  const keys = [
    [["ArrowRight"], "one time step", order("step")],
    [["q"], "pull the body in the middle of the view, or let it go", toggle_pull],
    [["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], "while pulling: move the target; with Shift: further",
      (shift, key) => pull.shift(...arrows[key].map((way) => way * (shift ? 0.1 : 0.02)))
        || (key === "ArrowRight" && order("step")())],
    [["Home"], "back to the start", order("reset")],
    [["g"], "switch gravity on or off", () => set_gravity(!find("gravity").checked)],
  ];
  return { show, toggle, keys, read: () => false, start, colored,
    set_rate: (value) => link.send({ do: "rate", value }) };
}
