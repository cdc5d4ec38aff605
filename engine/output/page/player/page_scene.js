// The scene with what lies over it: names, the values under the pointer, and pictures of both.
"use strict";

// `state` is that of the page, read at each call. changed(follow): somebody moved the camera. Throws without WebGL.
function make_scene(find, run, { bodies: shapes, visuals, frames }, state, legend_top, changed) {
  const root = document.documentElement;
  const gravity = new THREE.Vector3(...run.gravity);
  const up = gravity.length() > 0 ? gravity.clone().negate().normalize() : new THREE.Vector3(0, 0, 1);
  const box = measure_scene(run, shapes, frames);
  const view = make_view(find("view"), up, box);
  const largest = Object.fromEntries(field_names.map((field) => [field, run[field].max]));
  const bodies = make_bodies(view.scene, shapes, run.visual_of_body.map((row) => visuals[row]), frames, legend_top,
    largest, view.touch);
  const contacts = make_contacts(view.scene, Math.max(0, ...run.rows.contacts), box, run.force.usual || 1);
  const lines = make_lines(view.scene, run.lines, frames, box, run.line_force.usual || 1);
  const colliders = make_colliders(view.scene, run.colliders, box);

  const ink = () => {
    const style = getComputedStyle(root);
    return { text: style.getPropertyValue("--text").trim(), halo: style.getPropertyValue("--ground-middle").trim() };
  };
  const picture = make_picture(view, (pen, width, height, ratio) => {
    const by_value = state.color !== "body";
    if (state.labels) draw_names(pen, width, height, ratio);
    draw_caption(pen, width, height, ratio, {
      title: run.title || "Run", clock: state.time.toFixed(3) + " s", color: state.color, style: ink(),
      name: by_value ? fields[state.color].name : "",
      ticks: by_value ? legend_ticks(state.color, run, legend_top) : null,
    });
  });

  // Names are on a canvas of their own.
  const overlay = find("overlay"), overlay_pen = overlay.getContext("2d");
  function draw_names(pen, width, height, ratio) {
    const named = bodies.list.filter((body) => body.group.visible)
      .map((body) => ({ name: body.name, box: box_of_body(body) }));
    colliders.list.forEach((object, number) => {
      const { name, kind } = run.colliders[number];
      if (object.visible && name && kind !== "plane") named.push({ name, box: new THREE.Box3().setFromObject(object) });
    });
    return draw_labels(pen, named, view.camera, { width: width / ratio, height: height / ratio }, ratio, ink());
  }
  function show_names() {
    overlay.hidden = !state.labels;
    if (!state.labels) return;
    const ratio = view.canvas.width / view.canvas.clientWidth;
    Object.assign(overlay, { width: view.canvas.width, height: view.canvas.height });
    root.dataset.labels = draw_names(overlay_pen, overlay.width, overlay.height, ratio);
  }

  // What is under the pointer; looked up again when the picture has changed.
  let pointer = null, pointed = true;
  const point_again = () => { pointed = pointer === null; };
  function point() {
    pointed = true;
    if (!pointer) {
      find("tip").hidden = true;
      return;
    }
    const { origin, direction } = view.ray(pointer.x, pointer.y);
    const hit = pick_body(bodies.list, origin, direction);
    const size = { width: view.canvas.clientWidth, height: view.canvas.clientHeight };
    const row = pick_contact(contacts.shown, view.camera, size, pointer, 8);
    const row_of_line = pick_line(lines.shown, view.camera, size, pointer, 8);
    show_tip(find("tip"), find("view"), pointer, {
      hit, values: hit && bodies.values_at(hit), body: hit && bodies.list[hit.body], color: state.color,
      contact: row < 0 ? null : contacts.at(row), joining: row_of_line < 0 ? null : lines.at(row_of_line),
      name_of: {
        body: (number) => bodies.list[number].name,
        collider: (number) => run.colliders[number].name || run.colliders[number].kind,
      },
    });
  }
  const set_pointer = (place) => {
    pointer = place;
    point();
  };
  view.attach((origin, direction) => pick_body(bodies.list, origin, direction), (x, y) => set_pointer({ x, y }),
    () => set_pointer(null));
  view.watch((follow) => {
    changed(follow);
    show_names();
    point_again();
  });

  return {
    view, picture, set_light: colliders.set_light,
    // What is `blend` of the way from frame `number` to the next.
    show: (number, blend) => {
      const frame = frames[number], then = frames[Math.min(number + 1, frames.length - 1)];
      root.dataset.bodies = bodies.show(frame, then, blend, state.color, state.visual);
      contacts.show(frame.contacts, then.contacts, blend, state.contacts);
      root.dataset.lines = lines.show(frame.lines, then.lines, blend, state.lines);
      colliders.show(frame, then, blend, state.colliders);
      bodies.style(state);
      view.go_to(number + blend);
      view.touch();
      show_names();
      point_again();
    },
    render: () => {
      view.render();
      if (!pointed) point();
    },
  };
}
