// Plays a recorded run: its timeline, the loop of pictures, and the video.
"use strict";

// frames: all of the run, none if the browser cannot unpack them.
function make_recorded(page, frames) {
  const { find, run, state } = page, root = document.documentElement;
  const times = run.rows.time, last = times.length - 1;
  page.plots = make_run_plots(find, run.rows, go_to);

  const clock_text = () => (times.length ? state.time.toFixed(3) + " s" : "");
  const shown = { frame: -1, time: NaN };
  // Draws the state at state.time, between two frames, and shows the time in the clock and on the timeline.
  function show() {
    const next = Math.min(state.frame + 1, last), width = times[next] - times[state.frame];
    const blend = width > 0 ? Math.min(Math.max((state.time - times[state.frame]) / width, 0), 0.9999) : 0;
    if (frames.length > 0 && page.scene)
      page.scene.show(frames[state.frame], frames[Math.min(state.frame + 1, frames.length - 1)], blend,
        state.frame + blend);
    find("scrub").value = state.frame + blend;
    if (shown.frame !== state.frame || shown.time !== state.time) {
      if (shown.frame !== state.frame) page.plots.forEach((plot) => plot.show(state.frame));
      show_clock(find, clock_text(), times.length ? "  frame " + state.frame + " of " + last : "no frames");
      find("scrub").setAttribute("aria-valuetext", clock_text());
      Object.assign(shown, { frame: state.frame, time: state.time });
    }
    root.dataset.frame = state.frame;
    root.dataset.color = state.color;
  }

  // place: number of a frame; a fraction is a state between two frames.
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
    show_playing(find, state.playing);
  }
  function go_to_start() {
    state.frame = 0;
    state.time = times[0];
  }
  function toggle() {
    set_playing(!state.playing);
    show();
  }

  // Records the run as a video of 30 pictures a second, at the present playback speed. A second click stops it.
  async function record_run() {
    if (state.recording) {
      state.recording = false;
      return;
    }
    if (!page.scene || last < 1) return;
    if (!can_record()) {
      page.notice("This browser cannot record videos, because it lacks VideoEncoder. Use Chrome or Edge 94, "
        + "Firefox 130, Safari 16.4, or a later version.");
      return;
    }
    const button = find("record"), label = button.textContent, place = state.frame, pictures_a_second = 30;
    set_playing(false);
    state.recording = true;
    button.setAttribute("aria-pressed", true);
    try {
      const count = Math.round((times[last] - times[0]) / state.rate * pictures_a_second) + 1;
      const blob = await record(page.scene.picture.canvas, count, pictures_a_second, (i) => {
        go_to_time(times[0] + i * state.rate / pictures_a_second);
        page.scene.compose();
      }, (share) => {
        button.textContent = Math.floor(100 * share) + "\u202f% \u2013 stop";
        return state.recording;
      });
      if (blob) {
        save(blob, file_name(run) + ".webm");
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

  // frame=30, or time=0.5 [s]; play=1
  function read(asked) {
    if (asked.has("frame")) go_to(asked.get("frame"));
    if (asked.has("time") && times.length) {
      set_playing(false);
      go_to_time(Number(asked.get("time")) || 0);
    }
    if (asked.has("play")) set_playing(asked.get("play") !== "0");
    return ["frame", "time", "play"].some((name) => asked.has(name));
  }

  // At its end the run rests for this time, then starts again.
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
    if (page.scene && !state.recording) {
      page.scene.render();
      if (!root.dataset.ready) {
        root.dataset.frames = frames.length;
        root.dataset.ready = "true";
      }
    }
    requestAnimationFrame(tick);
  }
  function start({ read_hash }) {
    find("scrub").max = Math.max(last, 0);
    go_to(0);
    if (!read_hash()) set_playing(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
    requestAnimationFrame(tick);
  }

  find("record").addEventListener("click", record_run);
  find("scrub").addEventListener("input", () => go_to(find("scrub").value));
  const frame_by = (step) => (shift) => go_to(Math.round(state.frame) + (shift ? 10 : 1) * step);
  const keys = [
    [["ArrowLeft"], "one frame back; with Shift: ten frames", frame_by(-1)],
    [["ArrowRight"], "one frame forward; with Shift: ten frames", frame_by(1)],
    [["Home"], "to the start", () => go_to(0)],
    [["End"], "to the end", () => go_to(last)],
    [["r"], "record the run as a video at this playback speed; again: stop", record_run],
  ];
  return { show, toggle, keys, read, start, colored: () => {}, set_rate: (rate) => { state.rate = rate; } };
}

// Unpacks a recorded run and makes its scene. packed: texts of the page, by name.
async function open_recorded(page, packed, has_view, can_unpack) {
  const { find, run, notice } = page;
  page.scales = recorded_scales(run);
  show_summary(find, run);
  show_stages(find("stages"), run.report);
  if (!can_unpack) return make_recorded(page, []);
  notice("Unpacking \u2026");
  const decoder = decode.decoder(run.bodies, field_names), shapes = decoder.bodies;
  const frames = decoder.add(await decode.inflate(packed.frames));
  const visuals = decode.visuals(await decode.inflate(packed.visuals));
  visuals.forEach((visual, i) => { visual.materials = run.visuals[i]; });
  notice(frames.length ? "" : "No frames were recorded.");
  page.bodies = () => shapes;
  if (has_view) {
    const scene = make_scene(page, measure_scene(run, shapes, frames), (follow) => page.follow_changed(follow), null);
    shapes.forEach((shape, number) => {
      const first = frames.find((frame) => frame.bodies.has(number)).bodies.get(number);
      scene.bodies.add(number, shape, visuals[run.visual_of_body[number]], first);
    });
    run.colliders.forEach(scene.colliders.add);
    page.scene = scene;
  }
  return make_recorded(page, frames);
}
