// The three-dimensional view: renderer, light, and a camera that turns about a point.
"use strict";

// `up` is a unit vector, `box` the result of measure_scene. The camera shows the box of the frame until the user moves
// or zooms it. is_coarse: there is no GPU; the view is drawn without smooth edges, on a ground of one colour, and
// without shadows at first.
function make_view(host, up, box, is_coarse) {
  const renderer = new THREE.WebGLRenderer({
    antialias: !is_coarse,
    alpha: !is_coarse,  // the style sheet paints what is behind; without a GPU this takes long
    stencil: false,
    preserveDrawingBuffer: !is_coarse,  // a recorded page can be read at any time; without a GPU the copy takes long
  });
  renderer.gammaOutput = true;
  renderer.gammaFactor = 2.2;
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  host.prepend(renderer.domElement);

  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(35);
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
  function light_up(center) {
    key.position.copy(center).addScaledVector(direction(0.55, -0.65, 1.25).normalize(), 4 * box.radius);
    key.target.position.copy(center);
  }
  light_up(box.center);
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

  // Camera: angles about `up`; distance as a multiple of the one that shows the whole box; offset of the target from
  // the center of the box. place: number of the frame whose box counts; while `follow` that of the shown frame.
  const home = { turn: -1.05, lift: 0.38, distance: 1, place: 0, follow: true };
  const orbit = { ...home, offset: new THREE.Vector3() };
  const course = box.course.map(fitted);
  const style = getComputedStyle(host);
  const pixel_ratio = () => Math.min(window.devicePixelRatio || 1, 2);
  const pace = make_pace(is_coarse, host.clientWidth * host.clientHeight * pixel_ratio() ** 2);
  let share = 1;  // fraction of the pixels of a row that are drawn
  let free = { share: 1, middle: 0.5 };  // part between the cards: height and middle, as shares of the view
  let dirty = true, shown_place = 0, pick = null, on_change = () => {};

  function outward(turned, lifted) {
    return direction(Math.cos(lifted) * Math.cos(turned), Math.cos(lifted) * Math.sin(turned), Math.sin(lifted));
  }
  // Seen from home, a corner at depth z towards the camera and x aside needs a distance of |x| / tan(half) + z.
  function fitted(shown) {
    const out = outward(home.turn, home.lift), right = new THREE.Vector3().crossVectors(up, out).normalize();
    const above = new THREE.Vector3().crossVectors(out, right), center = shown.getCenter(new THREE.Vector3());
    const corners = [];
    for (const x of [shown.min.x, shown.max.x])
      for (const y of [shown.min.y, shown.max.y])
        for (const z of [shown.min.z, shown.max.z]) {
          const arm = new THREE.Vector3(x, y, z).sub(center);
          corners.push([Math.abs(arm.dot(right)), Math.abs(arm.dot(above)), arm.dot(out)]);
        }
    return { center, corners, radius: Math.max(shown.min.distanceTo(shown.max) / 2, 1e-6) };
  }
  function fit_distance({ corners, radius }) {
    const whole = Math.tan(THREE.Math.degToRad(camera.fov / 2));
    const tall = whole * free.share, wide = whole * camera.aspect;
    return 1.12 * corners.reduce((most, [x, y, z]) => Math.max(most, Math.max(x / wide, y / tall) + z), radius);
  }
  // Center and distance of the course, between frames their means.
  function course_at(place) {
    const last = course.length - 1, number = Math.min(Math.floor(place), last);
    const now = course[number], next = course[Math.min(number + 1, last)], share = place - number;
    if (now === next || share <= 0) return { center: now.center.clone(), distance: fit_distance(now) };
    return {
      center: now.center.clone().lerp(next.center, share),
      distance: fit_distance(now) + share * (fit_distance(next) - fit_distance(now)),
    };
  }
  function place_camera() {
    const { center, distance } = course_at(orbit.place), range = orbit.distance * distance;
    const target = center.add(orbit.offset);
    camera.position.copy(target).addScaledVector(outward(orbit.turn, orbit.lift), range);
    camera.near = range / 100;
    camera.far = range + 60 * box.radius;
    camera.updateProjectionMatrix();
    camera.lookAt(target);
    camera.updateMatrixWorld();
    dirty = true;
  }
  function moved() {
    place_camera();
    on_change(orbit.follow);
  }
  function turn(dx, dy) {
    orbit.turn -= 0.006 * dx;
    orbit.lift = Math.min(Math.max(orbit.lift + 0.006 * dy, -1.55), 1.55);
    moved();
  }
  function pan(dx, dy) {
    const half_view = THREE.Math.degToRad(camera.fov / 2);
    const size = 2 * orbit.distance * course_at(orbit.place).distance * Math.tan(half_view) / host.clientHeight;
    const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const above = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    orbit.offset.addScaledVector(right, -dx * size).addScaledVector(above, dy * size);
    orbit.follow = false;
    moved();
  }
  function ray(x, y) {
    const caster = new THREE.Raycaster();
    caster.setFromCamera({ x: 2 * x / host.clientWidth - 1, y: 1 - 2 * y / host.clientHeight }, camera);
    return caster.ray;
  }
  // Camera and target are scaled about the point under the pointer, so that this point stays in its place.
  function zoom(factor, x = host.clientWidth / 2, y = host.clientHeight / 2) {
    const { center } = course_at(orbit.place), target = center.clone().add(orbit.offset);
    const { origin, direction: way } = ray(x, y);
    const next = Math.min(Math.max(orbit.distance * factor, 0.002), 12), share = next / orbit.distance;
    const hit = pick && pick(origin, way);
    const forward = target.clone().sub(camera.position);
    const depth = hit ? hit.distance : forward.lengthSq() / forward.dot(way);
    const fixed = origin.clone().addScaledVector(way, depth);
    target.sub(fixed).multiplyScalar(share).add(fixed);
    orbit.offset.copy(target).sub(center);
    orbit.distance = next;
    orbit.follow = false;
    moved();
  }
  function reset() {
    Object.assign(orbit, home, { place: shown_place });
    orbit.offset.set(0, 0, 0);
    moved();
  }

  const render = () => draw_at(pace.next(dirty));
  function render_fine() {
    dirty = true;
    draw_at(pace_levels[0]);
  }
  function draw_at(level) {
    key.castShadow = level.shadows;
    if (level.share !== share) {
      share = level.share;
      size_up();
      dirty = true;
    }
    if (dirty) draw();
  }
  function draw() {
    dirty = false;
    if (is_coarse) renderer.setClearColor(style.getPropertyValue("--ground-middle").trim());
    renderer.render(scene, camera);
  }
  // Sets the number of pixels, and returns width by height.
  function size_up() {
    const width = Math.max(host.clientWidth, 1), height = Math.max(host.clientHeight, 1);
    renderer.setPixelRatio(share * pixel_ratio());
    renderer.setSize(width, height);
    return width / height;
  }
  // A new size clears the canvas, so it is drawn at once: a blank picture would flash until the next turn of the loop.
  function resize() {
    camera.aspect = size_up();
    free = free_part(host);
    camera.setViewOffset(1000 * camera.aspect, 1000, 0, 1000 * (0.5 - free.middle), 1000 * camera.aspect, 1000);
    place_camera();
    draw();
    on_change(orbit.follow);
  }
  const observer = new ResizeObserver(resize);
  for (const element of [host, ...host.querySelectorAll("#top, #legends")]) observer.observe(element);
  resize();

  return {
    scene, camera, canvas: renderer.domElement, ray, turn, zoom, reset, render, render_fine,
    // Connects the pointers. picker(origin, direction) returns the {distance} of the first body on a ray, or null.
    attach: (picker, hover, leave, pull) => {
      pick = picker;
      listen_to_pointers(renderer.domElement, { turn, pan, zoom, reset, hover, leave, pull });
    },
    // changed(follow) is called after each movement of the camera by the user.
    watch: (changed) => { on_change = changed; },
    look: (turn_to, lift_to, distance) => {
      Object.assign(orbit, { turn: turn_to, lift: lift_to, distance });
      moved();
    },
    // Shows the box of this frame while following. place: number of the frame, with a fraction between two frames.
    go_to: (place) => {
      shown_place = place;
      if (!orbit.follow || orbit.place === place) return;
      orbit.place = place;
      if (course.length > 1) place_camera();
    },
    // Sets the box that the camera shows while it follows a live run.
    aim: (shown) => {
      course[0] = fitted(shown);
      box.center.copy(course[0].center);
      light_up(box.center);
      if (orbit.follow) place_camera();
    },
    follow: (on) => {
      if (on) return reset();
      orbit.follow = false;
      moved();
    },
    touch: () => { dirty = true; },
  };
}

// The part of the view between the cards at its top and bottom. At least 60 % of the height counts as free.
function free_part(host) {
  const frame = host.getBoundingClientRect(), height = Math.max(frame.height, 1);
  const [top, bottom] = ["#top", "#legends"].map((name) => host.querySelector(name).getBoundingClientRect());
  const above = top.height > 0 ? (top.bottom - frame.top) / height : 0;
  const below = bottom.height > 0 ? (frame.bottom - bottom.top) / height : 0;
  const scale = Math.min(1, 0.4 / Math.max(above + below, 1e-6));
  return { share: 1 - scale * (above + below), middle: (1 + scale * (above - below)) / 2 };
}
