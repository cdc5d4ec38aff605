// The scene with its overlay of names, the tip at the pointer, and pictures of both.
"use strict";

// box: measure_scene. changed(follow): somebody moved the camera. pull: see page_pointers.js. Throws without WebGL.
function make_scene({ find, run, state, scales, is_coarse }, box, changed, pull) {
  const root = document.documentElement;
  const gravity = new THREE.Vector3(...run.gravity);
  const up = gravity.length() > 0 ? gravity.clone().negate().normalize() : new THREE.Vector3(0, 0, 1);
  const view = make_view(find("view"), up, box, is_coarse);
  const bodies = make_bodies(view.scene, scales, is_coarse, view.touch);
  const contacts = make_contacts(view.scene, box, scales);
  const lines = make_lines(view.scene, run, box, scales);
  const colliders = make_colliders(view.scene, state, box);

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
      ticks: by_value ? legend_ticks(state.color, scales) : null,
    });
  });

  // Names, and the drawing of `draw_over`, have a canvas of their own.
  const overlay = find("overlay"), overlay_pen = overlay.getContext("2d");
  let draw_over = null;
  function draw_names(pen, width, height, ratio, covered = []) {
    const named = [];
    bodies.list.forEach((body) => {
      if (body.group.visible) named.push({ name: body.name, box: box_of_body(body) });
    });
    colliders.list.forEach((object, number) => {
      const { name, kind } = run.colliders[number];
      if (object.visible && name && kind !== "plane") named.push({ name, box: new THREE.Box3().setFromObject(object) });
    });
    const size = { width: width / ratio, height: height / ratio, covered };
    return draw_labels(pen, named, view.camera, size, ratio, ink());
  }
  function cards() {
    const frame = view.canvas.getBoundingClientRect();
    return [...find("view").querySelectorAll("header, .choice, #legends > .card")].map((card) => {
      const { left, right, top, bottom } = card.getBoundingClientRect();
      return { left: left - frame.left, right: right - frame.left, top: top - frame.top, bottom: bottom - frame.top };
    }).filter(({ left, right }) => right > left);
  }
  function show_overlay() {
    overlay.hidden = !state.labels && !draw_over;
    if (overlay.hidden) return;
    const ratio = window.devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = view.canvas;
    Object.assign(overlay, { width: Math.round(ratio * width), height: Math.round(ratio * height) });
    if (state.labels) root.dataset.labels = draw_names(overlay_pen, overlay.width, overlay.height, ratio, cards());
    if (draw_over) draw_over(overlay_pen, ratio, ink());
  }

  // The tip at the pointer, which is updated when the picture has changed.
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
      hit, fields: state.fields, values: hit && bodies.values_at(hit), body: hit && bodies.list[hit.body],
      color: state.color,
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
    () => set_pointer(null), pull);
  view.watch((follow) => {
    changed(follow);
    show_overlay();
    point_again();
  });

  function clear() {
    bodies.list.forEach((body, number) => bodies.remove(number));
    colliders.clear();
  }

  return {
    view, picture, bodies, colliders, clear,
    // Draws draw(pen, ratio, ink) over each picture from now on; null: nothing.
    set_over: (draw) => {
      draw_over = draw;
      show_overlay();
    },
    // Draws the state between two frames: `blend` is 0 at `frame` and 1 at `then`. place: number of the frame for the
    // camera, with a fraction between two frames.
    show: (frame, then, blend, place) => {
      root.dataset.bodies = bodies.show(frame, then, blend, state.color, state.visual);
      contacts.show(frame.contacts, then.contacts, blend, state.contacts);
      root.dataset.lines = lines.show(frame.lines, then.lines, blend, state.lines);
      colliders.show(frame, then, blend, state.colliders);
      bodies.style(state);
      view.go_to(place);
      view.touch();
      show_overlay();
      point_again();
    },
    // Composes the picture with all pixels and shadows.
    compose: () => {
      view.render_fine();
      picture.compose();
    },
    render: () => {
      view.render();
      if (!pointed) point();
    },
  };
}
