// The three-dimensional view: renderer, light, and a camera that turns about a point.
"use strict";

// `up` is a unit vector; the camera first shows all `corners` of `box` {center, radius, corners}.
function make_view(host, up, box) {
  const renderer = new THREE.WebGLRenderer({
    antialias: true,
    alpha: true,                  // the style sheet paints what is behind
    preserveDrawingBuffer: true,  // only what changed is drawn again, and a screenshot may come any time
  });
  renderer.gammaOutput = true;
  renderer.gammaFactor = 2.2;
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  host.prepend(renderer.domElement);

  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(35, 1, box.radius / 200, box.radius * 60);
  camera.up.copy(up);

  // Two directions that span the horizontal plane.
  const east = new THREE.Vector3(1, 0, 0);
  if (Math.abs(up.x) > 0.9) east.set(0, 1, 0);
  east.addScaledVector(up, -east.dot(up)).normalize();
  const north = new THREE.Vector3().crossVectors(up, east);
  const direction = (e, n, u) => new THREE.Vector3()
    .addScaledVector(east, e).addScaledVector(north, n).addScaledVector(up, u);

  const sky = new THREE.HemisphereLight(0xffffff, 0x7b7672, 0.66);
  sky.position.copy(up);
  const key = new THREE.DirectionalLight(0xfffaf2, 0.62);
  key.position.copy(box.center).addScaledVector(direction(0.55, -0.65, 1.25).normalize(), 4 * box.radius);
  key.target.position.copy(box.center);
  key.castShadow = true;
  key.shadow.mapSize.set(2048, 2048);
  key.shadow.radius = 3;
  const reach = 1.8 * box.radius;
  Object.assign(key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: box.radius,
    far: 8 * box.radius });
  key.shadow.bias = -0.0006;
  const fill = new THREE.DirectionalLight(0xcfe0ff, 0.2);
  fill.position.copy(direction(-1, 0.6, 0.3));
  scene.add(sky, key, key.target, fill);

  // Camera: angles about `up`, distance and target.
  const home = { turn: -1.05, lift: 0.38, distance: 1, target: box.center.clone() };
  const orbit = { ...home, target: home.target.clone() };
  let dirty = true;

  const outward = (turned, lifted) => direction(Math.cos(lifted) * Math.cos(turned),
    Math.cos(lifted) * Math.sin(turned), Math.sin(lifted));

  // From where all corners are in sight, seen from home: a corner at depth z towards the camera and x aside needs |x| /
  // tan(half) + z.
  function fit_distance() {
    const out = outward(home.turn, home.lift), right = new THREE.Vector3().crossVectors(up, out).normalize();
    const above = new THREE.Vector3().crossVectors(out, right);
    const tall = Math.tan(THREE.Math.degToRad(camera.fov / 2)), wide = tall * camera.aspect;
    let distance = box.radius;
    for (const corner of box.corners) {
      const arm = corner.clone().sub(box.center);
      distance = Math.max(distance, Math.max(Math.abs(arm.dot(right)) / wide, Math.abs(arm.dot(above)) / tall)
        + arm.dot(out));
    }
    return 1.1 * distance;
  }
  function place_camera() {
    camera.position.copy(orbit.target).addScaledVector(outward(orbit.turn, orbit.lift),
      orbit.distance * fit_distance());
    camera.lookAt(orbit.target);
    camera.updateMatrixWorld();
    dirty = true;
  }
  function turn(dx, dy) {
    orbit.turn -= 0.006 * dx;
    orbit.lift = Math.min(Math.max(orbit.lift + 0.006 * dy, -1.55), 1.55);
    place_camera();
  }
  function pan(dx, dy) {
    const half_view = THREE.Math.degToRad(camera.fov / 2);
    const size = 2 * orbit.distance * fit_distance() * Math.tan(half_view) / host.clientHeight;
    const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const above = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    orbit.target.addScaledVector(right, -dx * size).addScaledVector(above, dy * size);
    place_camera();
  }
  function zoom(factor) {
    orbit.distance = Math.min(Math.max(orbit.distance * factor, 0.02), 8);
    place_camera();
  }
  function reset() {
    Object.assign(orbit, home, { target: home.target.clone() });
    place_camera();
  }
  listen_to_pointers(renderer.domElement, { turn, pan, zoom, reset });

  function render() {
    if (!dirty) return;
    dirty = false;
    renderer.render(scene, camera);
  }
  // A new size clears the canvas, so it is drawn at once: a blank picture would flash until the next turn of the loop.
  function resize() {
    const width = Math.max(host.clientWidth, 1), height = Math.max(host.clientHeight, 1);
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    place_camera();
    render();
  }
  new ResizeObserver(resize).observe(host);
  resize();

  return {
    scene, camera,
    look: (turn_to, lift_to, distance) => {
      Object.assign(orbit, { turn: turn_to, lift: lift_to, distance });
      place_camera();
    },
    touch: () => { dirty = true; },
    render,
  };
}

// Mouse: left turns, right or with Shift moves, wheel zooms. Touch: one finger turns, two move and zoom.
function listen_to_pointers(canvas, { turn, pan, zoom, reset }) {
  const down = new Map();
  const spread = () => {
    const [a, b] = [...down.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = down.get(event.pointerId);
    if (!last) return;
    const dx = event.clientX - last.x, dy = event.clientY - last.y;
    const before = down.size === 2 ? spread() : 0;
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (down.size === 2) {
      pan(dx / 2, dy / 2);
      zoom(before / Math.max(spread(), 1));
    } else if (event.shiftKey || (event.buttons & 6) !== 0) {
      pan(dx, dy);
    } else {
      turn(dx, dy);
    }
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => down.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", reset);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)));
  }, { passive: false });
}
