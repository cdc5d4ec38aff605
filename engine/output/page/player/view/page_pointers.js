// Mouse: the left button turns the view, the right button or Shift moves it, the wheel zooms to the pointer. Touch: one
// finger turns, two fingers move and zoom, a tap shows values. In a live view the left button and one finger pull
// bodies.
"use strict";

// Places are in pixels of the canvas. hover(x, y) is called while the pointer moves over the picture without a button,
// leave() when this ends. pull: null, or {grab(x, y), drag(x, y), drop()}. grab returns true if a body is at the place.
function listen_to_pointers(canvas, { turn, pan, zoom, reset, hover, leave, pull }) {
  const down = new Map();
  let moved = 0, pulling = null;  // pulling: number of the pointer
  const drop = () => {
    if (pulling !== null) pull.drop();
    pulling = null;
  };
  const at = (event) => {
    const frame = canvas.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  };
  const pair = () => {
    const [a, b] = [...down.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, spread: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    try { canvas.setPointerCapture(event.pointerId); } catch (error) { /* a pointer that has gone already */ }
    if (down.size === 0) moved = 0;
    else drop();  // with a second finger
    const place = at(event), is_plain = event.button === 0 && !event.shiftKey && !event.ctrlKey && !event.altKey;
    if (pull && down.size === 0 && is_plain && pull.grab(place.x, place.y)) pulling = event.pointerId;
    down.set(event.pointerId, place);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = down.get(event.pointerId), now = at(event);
    if (!last) {
      if (event.pointerType !== "touch") hover(now.x, now.y);
      return;
    }
    const dx = now.x - last.x, dy = now.y - last.y;
    moved += Math.abs(dx) + Math.abs(dy);
    if (moved > 4) leave();
    if (event.pointerId === pulling) {
      down.set(event.pointerId, now);
      pull.drag(now.x, now.y);
      return;
    }
    if (down.size === 2) {
      const before = pair();
      down.set(event.pointerId, now);
      const after = pair();
      pan(after.x - before.x, after.y - before.y);
      zoom(before.spread / after.spread, after.x, after.y);
      return;
    }
    down.set(event.pointerId, now);
    if (event.shiftKey || (event.buttons & 6) !== 0) pan(dx, dy);
    else turn(dx, dy);
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      const place = down.get(event.pointerId);
      down.delete(event.pointerId);
      if (event.pointerId === pulling) drop();
      if (place && name === "pointerup" && moved <= 4) hover(place.x, place.y);
    });
  canvas.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") leave(); });
  window.addEventListener("blur", drop);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const place = at(event);
    zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)), place.x, place.y);
  }, { passive: false });
}
