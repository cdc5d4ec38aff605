"""Scripts that check_page.py puts into a live page: a server inside the page, and the actions of a user."""
# Replaces WebSocket by a server that sends the messages of live.json. `sent`: messages of the page.
SERVER = """
const server = { sent: [], at: 0, refuses: false };
window.fetch = async () => ({ ok: true });
window.WebSocket = class extends EventTarget {
  static OPEN = 1;
  constructor(url) {
    super();
    Object.assign(server, { url, socket: this });
    this.readyState = 0;
    setTimeout(() => (server.refuses ? this.close() : this.open()), 10);
  }
  open() {
    this.readyState = WebSocket.OPEN;
    this.dispatchEvent(new Event("open"));
    server.begin();
  }
  close() {
    this.readyState = 3;
    this.dispatchEvent(new Event("close"));
  }
  send(text) { server.sent.push(JSON.parse(text)); }
};
server.say = (data) => server.socket.dispatchEvent(new MessageEvent("message", { data }));
server.tell = (message) => server.say(JSON.stringify(message));
server.orders = () => server.sent.filter((order) => order.do !== "seen").map((order) => order.do).join();
server.begin = () => {
  server.at = 0;
  server.tell({ type: "begin", run: { title: "Live <b>", gravity: [0, 0, -9.81] },
    state: { playing: true, rate: 1, gravity: true },
    sliders: [{ name: "height", unit: "m", low: 0, high: 1, value: 0.25 }],
    plots: [{ name: "tip", columns: [{ name: "x", unit: "m" }, { name: "force", unit: "N" }] }] });
};
server.pace = 0.5;
server.push = (speed, force) => {
  const { objects, bytes } = MESSAGES[server.at], number = server.at++;
  server.tell({ type: "add", ...objects });
  server.tell({ type: "row", number, time: number / 60, kinetic: 1, elastic: 2, potential: null, dissipated: 0,
    contacts: 3, stick: 1, slide: 2, regions: 1, top: { speed, stress: 0, strain: 0, force: 1, line_force: 1 },
    probes: [[number, 2]], sliders: [0.25], pull: force ? { force, length: 0.1 } : null, speed: server.pace });
  server.say(Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0)).buffer);
  return number;
};
server.frame = async (speed, force) => {
  const number = server.push(speed, force);
  const seen = () => server.sent.some((order) => order.do === "seen" && order.number === number);
  while (!seen()) await new Promise((done) => setTimeout(done, 10));
};
(async () => {
  while (!server.socket || server.socket.readyState !== 1) await new Promise((done) => setTimeout(done, 5));
  await server.frame(1);
})();
"""

LIVE = """
    check(server.url.endsWith("/live?token=secret") && !/secret/.test(location.href), "the token is taken away");
    check(find("title").textContent === "Live <b>" && root.dataset.live === "open", "a live page");
    check(root.dataset.bodies === "2" && root.dataset.number === "0", "the first frame is drawn, then acknowledged");
    while (server.at < 24) server.push(1);
    await server.frame(1);
    check(root.dataset.bodies === "3", "a new body appears");
    while (server.at < 44) server.push(1);
    await server.frame(1);
    check(Number(root.dataset.drawn) < 10, "only the newest of waiting frames is drawn, not " + root.dataset.drawn);
    check(root.dataset.bodies === "2", "a removed body disappears");
    while (!/x 44\u202fm/.test(find("probe_plots").textContent)) await wait(20);

    key("4");
    check(document.querySelectorAll("#color_legend .bodies div").length === 2,
      "the legend lists bodies that are there");
    key("1");

    // Frames in memory used again have the values of the run: within rounding to 1/32768 of a ball, and to 1/1000 of
    // the forces.
    const decoder = decode.decoder([], field_names, true);
    const distance = (a, b) => Math.hypot(...a.map((x, axis) => x - b[axis]));
    MESSAGES.forEach(({ bytes, node, points, forces }, i) => {
      const [frame] = decoder.add(Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0)));
      const [[number, { lower, offset }]] = frame.bodies, shape = decoder.bodies[number], { contacts } = frame;
      const row = shape.node.indexOf(1), at = lower.map((x, axis) => x + shape.step * offset[3 * row + axis]);
      check(distance(at, node) < shape.step, "frame " + i + ": a node at " + at + ", expected at " + node);
      const sum = (list) => [0, 1, 2].map((axis) => {
        let total = 0;
        for (let row = 0; row < contacts.count; ++row) total += list[3 * row + axis];
        return total;
      });
      check(distance(sum(contacts.point), points) <= contacts.count * 2 * shape.step,
        "frame " + i + ": contact points");
      check(distance(sum(contacts.force), forces) <= 2e-3 * distance(forces, [0, 0, 0]), "frame " + i + ": forces "
        + sum(contacts.force) + ", expected " + forces);
    });

    const orders = (wanted) => {
      check(server.orders() === wanted, wanted + ", not " + server.orders());
      server.sent = [];
    };
    orders("fields");
    key("2");
    orders("fields");
    const at = search(/ball/);
    check(/von Mises stress/.test(tip.textContent) && !/strain/.test(tip.textContent), "only fields that are computed");
    send(PointerEvent, "pointerdown", at, { pointerType: "mouse", button: 0 });
    const { do: begun, body, point: taken, to } = server.sent[0];
    check(begun === "pull" && body > 0 && taken.join() === to.join(), "a body is pulled, first at its place");
    send(PointerEvent, "pointermove", [at[0] + 40, at[1] - 30], { pointerType: "mouse", buttons: 1 });
    await server.frame(1, 12.5);
    const move = server.sent.filter((order) => order.do === "move").pop();
    check(move && Math.hypot(...move.to.map((x, axis) => x - taken[axis])) > 1e-3, "the end of the spring moves");
    check(!find("overlay").hidden, "the spring is drawn");
    window.dispatchEvent(new Event("blur"));
    check(server.sent.pop().do === "release" && find("overlay").hidden, "leaving the window lets go");
    server.sent = [];
    send(PointerEvent, "pointerup", at, { pointerType: "mouse" });
    send(PointerEvent, "pointerdown", [4, box.height - 4], { pointerType: "mouse", button: 0 });
    send(PointerEvent, "pointermove", [40, box.height - 40], { pointerType: "mouse", buttons: 1 });
    send(PointerEvent, "pointerup", [40, box.height - 40], { pointerType: "mouse" });
    orders("");

    find("slider_0").value = 0.5;
    find("slider_0").dispatchEvent(new Event("input"));
    check(server.sent[0].value === 0.5 && server.sent[0].number === 0, "a slider moves");
    const shown_after = async (ms) => {
      await wait(ms);
      await server.frame(1);
      await wait(200);
      return Number(find("slider_0").value);
    };
    check(await shown_after(600) === 0.5, "a slider waits for a row that knows its movement");
    for (let i = 0; i < 3; ++i) await shown_after(0);
    while (await shown_after(0) !== 0.25) continue;
    server.sent = server.sent.filter((order) => order.do === "slider");
    find("slider_0").dispatchEvent(new Event("dblclick"));
    check(server.sent[1].value === 0.25, "a double click moves it back");
    server.sent = [];
    for (const name of [" ", "ArrowRight", "Home", "g"]) key(name);
    orders("pause,step,reset,gravity");
    server.tell({ type: "state", playing: false, rate: 0.1, gravity: false });
    server.tell({ type: "problem", text: "no such body" });
    await wait(20);
    check(root.dataset.playing === "false" && find("rate").querySelector("select").value === "0.1"
      && !find("gravity").checked && find("notice").textContent === "no such body", "state and problem are shown");

    const shown = [[2, "1"], [0.5, "1"], [0, "1"], [1234, "1"], [-0.0123, "1"], [null, "1"], [0.5, "m"]];
    const texts = shown.map(([value, unit]) => text.si(value, unit)).join("; ");
    check(texts === "2; 0.5; 0; 1,234; -0.0123; \u2013; 500\u202fmm", "plain numbers have no unit: " + texts);

    const { scales: { speed }, widen } = make_live_scales();
    const ends = [[0, 1], [0.1, 3], [1, 0.4], [3.05, 0.4], [3.2, 0.4], [3.3, 2]].map(([now, value]) => {
      widen({ speed: value }, now);
      return speed.top;
    });
    check(ends.join() === "1,3,3,3,0.4,2", "scales widen at once and narrow slowly: " + ends);

    server.pace = 0.0004321;
    await server.frame(1);
    while (!/0\\.000432\u00d7 real time/.test(find("clock").textContent)) await wait(20);

    const corner = (x) => new THREE.Vector3(x, x, x), aim = make_aim(new THREE.Box3(corner(0), corner(1)));
    const frame_at = (height) => ({ bodies: new Map([[0, { lower: [0, 0, height], extent: [1, 1, 1] }]]) });
    for (let i = 0; i <= 8; ++i) {  // a fall that is drawn four times a second
      const { min, max } = aim(frame_at(-5 * (i / 4) ** 2), i / 4);
      check(min.z <= -5 * (i / 4) ** 2 && max.z >= 1 - 5 * (i / 4) ** 2 && max.z - min.z < 2,
        "a falling body is in the box from " + min.z + " to " + max.z + " after " + i / 4 + " s");
    }

    server.refuses = true;
    server.socket.close();
    await wait(100);
    check(root.dataset.live === "lost", "a lost connection is shown, not " + root.dataset.live);
    while (root.dataset.live !== "refused") await wait(20);
    check(/token/.test(find("notice").textContent), "a refusal is shown");
    server.refuses = false;
    const { begin } = server, problem = "found 4 browsers";
    server.begin = () => {
      server.tell({ type: "problem", text: problem });
      setTimeout(() => server.socket.close(), 0);
    };
    while (root.dataset.live !== "full") await wait(20);
    const pause_of_notice = () => Number(/again in ([\\d.]+)\u202fs/.exec(find("notice").textContent)[1]);
    check(find("notice").textContent.startsWith(problem + ". Trying"), "not so: " + find("notice").textContent);
    const first_pause = pause_of_notice();
    while (!(pause_of_notice() > first_pause)) await wait(20);
    server.begin = begin;
    while (root.dataset.live !== "open") await wait(20);
    await server.frame(1);
    check(root.dataset.number === "0" && root.dataset.bodies === "2" && find("notice").hidden, "it begins again");
"""
