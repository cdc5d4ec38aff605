// Joints, ties, cables and springs: a dot at each point, and a tube along each segment. Their radius grows with the
// square root of the force.
"use strict";

// run.lines: {name, kind} by number. A force of scales.line_force.top gets a tube of the full radius.
function make_lines(scene, run, { size, spacing }, scales) {
  const full_radius = Math.min(0.14 * spacing, 0.06 * size);
  const tube = new THREE.CylinderBufferGeometry(1, 1, 1, 10, 1, true);
  tube.translate(0, 0.5, 0);
  const copies = make_instances(scene, new THREE.IcosahedronBufferGeometry(1, 1), tube);
  const kind_colors = Object.fromEntries(Object.entries(colors.line).map(([kind, hex]) =>
    [kind, colors.linear(colors.parse(hex))]));

  const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), scale = new THREE.Vector3();
  const point = new THREE.Vector3(), along = new THREE.Vector3(), y_axis = new THREE.Vector3(0, 1, 0);
  // One row for each point: its place, that of the next point of its line (its own if there is none), force, line.
  const shown = { count: 0, top: 0, point: new Float32Array(0), next: new Float32Array(0),
    force: new Float32Array(0), line: new Int32Array(0) };
  function reserve(count) {
    if (count <= shown.force.length) return;
    Object.assign(shown, { point: new Float32Array(6 * count), next: new Float32Array(6 * count),
      force: new Float32Array(2 * count), line: new Int32Array(2 * count) });
  }

  // Lines that both frames have with equally many points move from one to the other.
  function blend_rows({ list: now, top }, next, blend) {
    let row = 0;
    for (const line of now.values()) row += line.force.length;
    reserve(row);
    row = 0;
    for (const [number, line] of now) {
      const points = line.force.length, then = next && next.list.get(number), joined = run.lines[number].kind !== "tie";
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
    copies.show(shown.count);
    for (let i = 0; i < shown.count; ++i) {
      point.fromArray(shown.point, 3 * i);
      along.fromArray(shown.next, 3 * i).sub(point);
      const length = along.length(), share = Math.abs(shown.force[i]) / scales.line_force.top;
      const radius = (0.35 + 0.65 * Math.sqrt(Math.min(share, 1))) * full_radius;
      copies.set_color(i, kind_colors[run.lines[shown.line[i]].kind]);
      copies.set_place(0, i, matrix.compose(point, turn.set(0, 0, 0, 1), scale.setScalar(1.7 * radius)));
      if (length > 0) turn.setFromUnitVectors(y_axis, along.multiplyScalar(1 / length));
      copies.set_place(1, i, matrix.compose(point, turn, scale.set(length > 0 ? radius : 0, length, radius)));
    }
    if (shown.count > 0) copies.upload(shown.count);
    return shown.count;
  }
  // The object of row i, and its force as it is shown.
  const at = (i) => ({ ...run.lines[shown.line[i]], force: shown.force[i],
    error: half_code(Math.abs(shown.force[i]), shown.top / (2047 * 2047)) });
  return { show, shown, at };
}
