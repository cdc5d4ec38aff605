// The colliders: planes as a grid that fades out, containers transparent, the rest solid.
"use strict";

function make_colliders(scene, state, box) {
  const cell = text.tick(2 * box.radius, 8), colliders = [];
  function add(collider) {
    const object = collider.kind === "plane" ? plane_object(box.radius, cell) : solid_object(collider);
    object.userData.set_light(state.light);
    scene.add(object);
    colliders.push(object);
  }
  function clear() {
    for (const object of colliders.splice(0)) {
      scene.remove(object);
      object.traverse(({ geometry, material }) => {
        if (geometry) geometry.dispose();
        if (material) material.dispose();
      });
    }
  }

  const other = new THREE.Vector3(), other_turn = new THREE.Quaternion();
  function show(frame, next, blend, on) {
    colliders.forEach((object, number) => {
      const pose = frame.colliders.get(number), then = blend > 0 && next ? next.colliders.get(number) : undefined;
      object.visible = on && pose !== undefined;
      if (!pose) return;
      object.position.fromArray(pose.position);
      turn_from(object.quaternion, pose.rotation);
      if (then) {
        object.position.lerp(other.fromArray(then.position), blend);
        turn_from(other_turn, then.rotation);
        object.quaternion.slerp(other_turn, blend);
      }
      if (object.userData.follow) {
        // Moves the drawn part of an infinite plane below the bodies.
        const back = object.quaternion.clone().inverse();
        object.userData.follow(box.center.clone().sub(object.position).applyQuaternion(back));
      }
    });
  }
  const set_light = (light) => colliders.forEach((object) => object.userData.set_light(light));
  return { add, clear, show, set_light, list: colliders };
}

function plane_object(radius, cell) {
  const size = 7 * radius;
  const grid = new THREE.ShaderMaterial({
    uniforms: {
      cell: { value: cell }, reach: { value: size / 2 }, offset: { value: new THREE.Vector2() },
      ground: { value: new THREE.Color() }, ink: { value: new THREE.Color() },
    },
    transparent: true, depthWrite: false, extensions: { derivatives: true },
    vertexShader: `
      varying vec2 at;
      void main() { at = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    // Lines one pixel wide, in two widths of cell; where a pixel covers many cells they melt into their mean.
    fragmentShader: `
      varying vec2 at; uniform float cell, reach; uniform vec2 offset; uniform vec3 ground, ink;
      float lines(vec2 p) {
        vec2 width = fwidth(p);
        vec2 line = 1.0 - min(abs(fract(p - 0.5) - 0.5) / width, 1.0);
        return max(line.x, line.y) * (1.0 - smoothstep(0.2, 0.6, max(width.x, width.y)));
      }
      void main() {
        vec2 p = (at + offset) / cell;
        float fade = 1.0 - smoothstep(0.15, 1.0, length(at) / reach);
        float share = 0.20 * lines(p) + 0.22 * lines(p / 5.0);
        gl_FragColor = vec4(mix(ground, ink, share), fade);
      }`,
  });
  // Planes are visible from above only, because from below they would hide the objects on them.
  const surface = new THREE.Mesh(new THREE.PlaneBufferGeometry(size, size), grid);
  surface.renderOrder = -2;
  const shadow = new THREE.Mesh(new THREE.PlaneBufferGeometry(size, size),
    new THREE.ShadowMaterial({ opacity: 0.42, depthWrite: false }));
  shadow.receiveShadow = true;
  shadow.renderOrder = -1;
  const object = new THREE.Group();
  object.add(surface, shadow);
  object.userData.set_light = (light) => {
    grid.uniforms.ground.value.setRGB(...(light ? [0.86, 0.88, 0.9] : [0.2, 0.235, 0.27]));
    grid.uniforms.ink.value.setRGB(...(light ? [0.3, 0.36, 0.42] : [0.78, 0.85, 0.92]));
    shadow.material.opacity = light ? 0.25 : 0.42;
  };
  object.userData.follow = (foot) => {
    surface.position.set(foot.x, foot.y, 0);
    shadow.position.copy(surface.position);
    grid.uniforms.offset.value.set(foot.x, foot.y);
  };
  return object;
}

function solid_object(collider) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(decode.floats(collider.points), 3));
  geometry.setIndex(new THREE.BufferAttribute(decode.words(collider.triangles), 1));
  geometry.computeVertexNormals();
  const clear = { bucket: 0.16, mesh: 0.4 }[collider.kind];
  const material = new THREE.MeshStandardMaterial({
    roughness: 0.85, metalness: 0,
    flatShading: collider.kind === "mesh", side: clear ? THREE.DoubleSide : THREE.FrontSide,
    transparent: Boolean(clear), opacity: clear || 1, depthWrite: !clear,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.receiveShadow = !clear;
  mesh.castShadow = !clear;
  const ink = new THREE.LineBasicMaterial({ transparent: true, opacity: clear ? 0.55 : 0.35 });
  const object = new THREE.Group();
  object.userData.set_light = (light) => {
    ink.color.setHex(light ? 0x2c3844 : clear ? 0xc3d2e2 : 0x9fb0c0);
    const dark = clear ? 0xb9c9da : 0x66717d, bright = clear ? 0x6d7f92 : 0x9aa5b1;
    material.color.setHex(light ? bright : dark).convertGammaToLinear(2.2);
  };
  object.add(mesh, new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 30), ink));
  return object;
}
