// Joints, ties, cables and springs: a dot at each point, and a tube along each segment. Tubes and dots grow with the
// root of the force.
"use strict";

// list: {name, kind} by number. A force of `full_force` [N] gets a tube of the full radius.
function make_lines(scene, list, frames, { size, spacing }, full_force) {
  const count_points = (frame) => [...frame.lines.list.values()].reduce((sum, line) => sum + line.force.length, 0);
  const capacity = Math.max(1, ...frames.map(count_points)), full_radius = Math.min(0.14 * spacing, 0.06 * size);
  const color = new THREE.InstancedBufferAttribute(new Float32Array(3 * capacity), 3);
  const dots = make_instances(scene, new THREE.IcosahedronBufferGeometry(1, 1), color);
  const tube = new THREE.CylinderBufferGeometry(1, 1, 1, 10, 1, true);
  tube.translate(0, 0.5, 0);
  const tubes = make_instances(scene, tube, color);
  const kind_colors = Object.fromEntries(Object.entries(colors.line).map(([kind, hex]) =>
    [kind, colors.linear(colors.parse(hex))]));

  const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), scale = new THREE.Vector3();
  const point = new THREE.Vector3(), along = new THREE.Vector3(), y_axis = new THREE.Vector3(0, 1, 0);
  // One row for each point: its place, that of the next point of its line (its own if there is none), force, line.
  const shown = { count: 0, top: 0, point: new Float32Array(3 * capacity), next: new Float32Array(3 * capacity),
    force: new Float32Array(capacity), line: new Int32Array(capacity) };

  // Lines that both frames have with equally many points move from one to the other.
  function blend_rows({ list: now, top }, next, blend) {
    let row = 0;
    for (const [number, line] of now) {
      const points = line.force.length, then = next && next.list.get(number), joined = list[number].kind !== "tie";
      const share = then && then.force.length === points ? blend : 0;
      const mix = (values, others, k) => (share > 0 ? (1 - share) * values[k] + share * others[k] : values[k]);
      for (let p = 0; p < points; ++p) {
        const other = joined && p + 1 < points ? p + 1 : p;
        for (let axis = 0; axis < 3; ++axis) {
          shown.point[3 * row + axis] = mix(line.point, then && then.point, 3 * p + axis);
          shown.next[3 * row + axis] = mix(line.point, then && then.point, 3 * other + axis);
        }
        shown.force[row] = mix(line.force, then && then.force, p);
        shown.line[row++] = number;
      }
    }
    Object.assign(shown, { count: row, top });
  }
  function show(lines, next, blend, visible) {
    shown.count = 0;
    if (visible) blend_rows(lines, next, blend);
    show_instances([...dots, ...tubes], shown.count);
    for (let i = 0; i < shown.count; ++i) {
      point.fromArray(shown.point, 3 * i);
      along.fromArray(shown.next, 3 * i).sub(point);
      const length = along.length(), strength = Math.sqrt(Math.min(Math.abs(shown.force[i]) / full_force, 1));
      const radius = (0.35 + 0.65 * strength) * full_radius;
      color.array.set(kind_colors[list[shown.line[i]].kind], 3 * i);
      dots[0].setMatrixAt(i, matrix.compose(point, turn.set(0, 0, 0, 1), scale.setScalar(1.7 * radius)));
      if (length > 0) turn.setFromUnitVectors(y_axis, along.multiplyScalar(1 / length));
      tubes[0].setMatrixAt(i, matrix.compose(point, turn, scale.set(length > 0 ? radius : 0, length, radius)));
    }
    color.needsUpdate = true;
    dots[0].instanceMatrix.needsUpdate = tubes[0].instanceMatrix.needsUpdate = true;
    return shown.count;
  }
  // The object of row i, and its force as it is shown.
  const at = (i) => ({ ...list[shown.line[i]], force: shown.force[i],
    error: half_code(Math.abs(shown.force[i]), shown.top / (2047 * 2047)) });
  return { show, shown, at };
}
