"""Opens pages of PageWriter in headless Chromium: check_page.py FOLDER, which holds page.html, visual.html and
empty.html of output_sample_files.

A page marks its root element: data-ready after the first picture, data-error after a failure or a blocked request. The
script asks for several states by URL fragment, reads the marks back, and looks at the picture itself; then it puts
scripts of its own into copies of the page, which point, zoom, press keys and record, and leave marks too. Pictures stay
in the folder. Ends with 77 (skipped, for CTest) when there is no Chromium.
"""
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import zlib

from live_page import LIVE, SERVER

MAX_BYTES = 3_000_000  # limit for 120 frames of 5,000 surface vertices, which take 2.3 MB


def chromium():
    for name in ["chromium", "chromium-browser", "google-chrome"]:
        if shutil.which(name):
            return shutil.which(name)
    print("SKIPPED: no Chromium; Debian: apt-get install chromium")
    sys.exit(77)


def run_once(command, seconds):
    """Output of a command, or None if it takes longer than that many seconds; then all its processes are killed."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          start_new_session=True) as process:
        try:
            return process.communicate(timeout=seconds)[0]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return None


def browse(page, fragment, picture=None, size=(720, 450), seconds=12):
    """The document after that many seconds of the browser's virtual time. Writes a picture if a name is given.

    Virtual time also passes while the page unpacks its frames, and Chromium hangs if it takes a picture too early.
    Then it is started again, up to twice, with four times as many seconds.
    """
    for attempt in range(3):
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            command = [chromium(), "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
                       "--enable-unsafe-swiftshader",
                       "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={profile}",
                       f"--window-size={size[0]},{size[1]}", f"--virtual-time-budget={1000 * seconds * 4 ** attempt}",
                       "--dump-dom"]
            if picture:
                command.append(f"--screenshot={picture}")
            dom = run_once(command + [f"file://{page}{fragment}"], 60)
        if dom:
            return dom
        print(f"the browser gave no page for {fragment or 'an empty fragment'}; started again", flush=True)
    sys.exit(f"the browser gave no page for {page}{fragment} in three attempts of 60 s")


def marks(dom):
    root = re.search(r"<html[^>]*>", dom)
    assert root, "no page came back"
    return dict(re.findall(r'data-([a-z]+)="([^"]*)"', root.group(0)))


def pixels(path):
    """Rows of (r, g, b) of an 8-bit PNG without interlace (PNG specification, 9.2)."""
    with open(path, "rb") as file:
        data = file.read()
    width, height, depth, kind, _, _, interlace = struct.unpack(">IIBBBBB", data[16:29])
    assert depth == 8 and kind in (2, 6) and interlace == 0
    size = 3 if kind == 2 else 4
    packed, at = b"", 8
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + length] if name == b"IDAT" else b""
        at += 12 + length
    raw, stride, rows = zlib.decompress(packed), width * size, []
    above = bytearray(stride)
    for y in range(height):
        method, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = (line[x - size], above[x], above[x - size]) if x >= size else (0, above[x], 0)
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[x] = (line[x] + (0, left, up, (left + up) // 2, paeth)[method]) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, size)])
        above = line
    return rows


def colors_in_view(path):
    """Number of colours in the middle of the three-dimensional view, and the share of the commonest one."""
    rows = pixels(path)
    height, width = len(rows), len(rows[0])
    seen = {}
    for row in rows[height // 4:3 * height // 4]:
        for pixel in row[width // 8:5 * width // 8]:
            seen[pixel] = seen.get(pixel, 0) + 1
    return len(seen), max(seen.values()) / sum(seen.values())


def check(folder, page, fragment, expected, picture, size=(720, 450)):
    path = os.path.join(folder, picture)
    found = marks(browse(os.path.join(folder, page), fragment, path, size))
    assert "error" not in found, f"{page}{fragment}: {found['error']}"
    for name, value in expected.items():
        assert found.get(name) == value, f"{page}{fragment}: {name} is {found.get(name)}, expected {value}"
    return path


# Frame of the scripts below: functions that act on the page, and marks for the result.
ACTING = """
(async () => {
  const root = document.documentElement, wait = (ms) => new Promise((done) => setTimeout(done, ms));
  while (!root.dataset.ready && !root.dataset.error) await wait(20);
  const canvas = document.querySelector("#view > canvas:not(#overlay)"), box = canvas.getBoundingClientRect();
  const tip = document.getElementById("tip"), find = (id) => document.getElementById(id);
  const send = (Type, name, [x, y], more) => canvas.dispatchEvent(new Type(name,
    { clientX: box.left + x, clientY: box.top + y, pointerId: 1, bubbles: true, cancelable: true, ...more }));
  const point = (place) => send(PointerEvent, "pointermove", place, { pointerType: "mouse" });
  const key = (name, more) =>
    window.dispatchEvent(new KeyboardEvent("keydown", { key: name, cancelable: true, ...more }));
  const pressed = (name) => document.querySelector("[data-switch=" + name + "]").getAttribute("aria-pressed");
  const search = (wanted) => {
    for (let y = 10; y < box.height; y += 6)
      for (let x = 10; x < box.width; x += 6) {
        point([x, y]);
        if (!tip.hidden && wanted.test(tip.textContent)) return [x, y];
      }
    throw new Error("nothing under the pointer tells " + wanted);
  };
  const check = (holds, what) => { if (!holds) throw new Error("not so: " + what); };
  try {
    %s
    root.dataset.done = "true";
  } catch (error) { root.dataset.error = error.message; }
})();
"""

POINTING = """
    const at = search(/ball/), before = tip.textContent;
    check(/speed [\\d.]+.m?m\\/s/.test(before), "a speed with its unit in " + before);
    check(/von Mises stress [\\d.]+.[kM]?Pa/.test(before), "a stress in " + before);
    check(/equivalent strain [\\d.e-]+.%/.test(before), "a strain in " + before);
    check(/triangle \\d+, node \\d+/.test(before), "numbers in " + before);
    const place = (text) => /at (\\S+), (\\S+), (\\S+) m/.exec(text).slice(1).map(Number);
    check(pressed("follow") === "true", "the view follows at first");
    send(WheelEvent, "wheel", at, { deltaY: -700 });
    point(at);
    const way = Math.hypot(...place(before).map((x, axis) => x - place(tip.textContent)[axis]));
    check(way < 1e-3, "what is under the pointer stays there when the wheel turns, but it moved " + way + " m");
    check(pressed("follow") === "false", "a zoom ends following");
    key("v");
    check(pressed("follow") === "true", "V follows again");
    const contact = search(/Contact: /);
    check(/force [\\d.]+.[munk\\u00b5]?N, normal .*N, friction .*N/.test(tip.textContent),
      "a force in " + tip.textContent);
    check(/(stick|slide|open)/.test(tip.textContent), "a motion in " + tip.textContent);
    send(PointerEvent, "pointerleave", at, { pointerType: "mouse" });
    check(tip.hidden, "nothing is told when the pointer has left");
    send(PointerEvent, "pointerdown", contact, { pointerType: "touch" });
    send(PointerEvent, "pointerup", contact, { pointerType: "touch" });
    check(!tip.hidden, "a tap tells values");
    search(/Cable: cable <&>tension [\\d.]+.m?N/);
    search(/Tie: tieforce on the node [\\d.]+.m?N/);
    search(/Spring: springforce -[\\d.]+.m?N/);
"""

KEYS = """
    const summary = find("summary").textContent;
    check(summary.includes("'</dd> ring' crosses itself in up to 3 places"), "a self-crossing in " + summary);
    check(/cannot be trusted/.test(summary), "a reason not to trust the run in " + summary);
    check(/not to be trusted/.test(find("subtitle").textContent), "a mark in " + find("subtitle").textContent);
    key("?");
    check(!find("help").hidden && /record the run as a video/.test(find("help").textContent), "? lists the keys");
    key("Escape");
    check(find("help").hidden, "Escape hides them");
    const wide = canvas.clientWidth;
    key("h");
    check(getComputedStyle(document.querySelector("aside")).display === "none", "H hides the panel");
    key("h");
    key("l");
    check(root.classList.contains("light"), "L is light");
    key("n");
    check(Number(root.dataset.labels) > 2, "N shows names, not " + root.dataset.labels);
    key("4");
    check(root.dataset.color === "body", "4 colours by body");
    check(document.querySelectorAll("#color_legend .bodies div").length === 8, "the legend lists all bodies");
    const count = Number(root.dataset.lines);
    check(count > 8 && /cable/.test(find("line_legend").textContent), "joints and cables are shown");
    key("j");
    check(root.dataset.lines === "0" && find("line_legend").hidden, "J hides them");
    key("c");
    check(document.querySelector("#contacts [aria-checked=true]").dataset.value === "region", "C goes on");
    const frame = () => Number(root.dataset.frame), begun = frame();
    key("ArrowRight");
    check(frame() === begun + 1, "an arrow steps on");
    key("ArrowLeft", { shiftKey: true });
    check(frame() === begun - 9, "with Shift ten back");
    find("scrub").value = 20.5;
    find("scrub").dispatchEvent(new Event("input"));
    check(frame() === 20 && find("clock").textContent.startsWith("0.342 s"),
      "half a frame is a time, not " + find("clock").textContent);
    key("p");
    while (!root.dataset.picture) await wait(50);
"""

VISUAL = """
    search(/visual triangle \\d+, node \\d+/);
    const values = tip.textContent;
    check(/von Mises stress [\\d.]+.[kM]?Pa/.test(values), "an interpolated stress in " + values);
    key("s");
    search(/triangle \\d+, node \\d+/);
    check(!/visual/.test(tip.textContent), "S shows the simulated surface");
"""

# Names, the title and the stages beside each other.
LAYOUT = """
    const covers = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const cards = [{ left: 0, right: 400, top: 0, bottom: 60 }], drawn = [];
    const pen = new Proxy(document.createElement("canvas").getContext("2d"), {
      get: (pen, name) => (name === "fillText" ? (...text) => drawn.push(text)
        : typeof pen[name] === "function" ? pen[name].bind(pen) : pen[name]),
      set: (pen, name, value) => Reflect.set(pen, name, value) });
    const camera = new THREE.PerspectiveCamera(90), unit = new THREE.Vector3(0.1, 0.1, 0.1);
    camera.updateMatrixWorld();
    const named = [[-2, 2], [2, -2]].map(([x, y], i) => {
      const center = new THREE.Vector3(x, 1.7 * y, -4);
      return { name: "body " + i, box: new THREE.Box3(center.clone().sub(unit), center.clone().add(unit)) };
    });
    const size = { width: 400, height: 400, covered: cards };
    check(draw_labels(pen, named, camera, size, 1, { text: "black", halo: "white" }) === 2, "both names are drawn");
    for (const [name, x, y] of drawn)
      check(!covers({ left: x - 5, right: x + 5, top: y - 12, bottom: y }, cards[0]), name + " is under a card");
    check(getComputedStyle(document.querySelector("header")).backgroundColor !== "rgba(0, 0, 0, 0)",
      "the title has a ground");
    const tall = document.createElement("div");
    tall.style = "position: fixed; width: 100px; height: 1000px";
    tall.innerHTML = ["top: 0; bottom: auto; height: 100px", "bottom: 0; top: auto; height: 300px"].map((style, i) =>
      "<div id='" + ["top", "legends"][i] + "' style='" + style + "; position: absolute'></div>").join("");
    document.body.append(tall);
    const { share, middle } = free_part(tall);
    check(Math.abs(share - 0.6) < 1e-9 && Math.abs(middle - 0.4) < 1e-9, "a free part of " + share + " at " + middle);
    tall.remove();
    const stages = document.createElement("div"), stage = (name, seconds) => ({ name, seconds, runs: 1, skipped: 0 });
    show_stages(stages,
      { steps: 1, stages: [stage("a", 0.6), stage("b", 0.397), stage("c", 0.001), stage("d", 0.002)] });
    const shown = [...stages.querySelectorAll(".name")].map((name) => name.textContent);
    check(shown.join() === "a,b,others (2)", "small stages are added up, not " + shown);
"""

RECORDING = """
    let saved = null;
    const make_address = URL.createObjectURL;
    URL.createObjectURL = (blob) => make_address(saved = blob);
    const rate = document.querySelector("#rate select");
    rate.value = "2";
    rate.dispatchEvent(new Event("change"));
    find("record").click();
    await wait(100);
    check(/%/.test(find("record").textContent), "progress on the button, not " + find("record").textContent);
    while (!root.dataset.video) await wait(50);
    check(root.dataset.pictures === "31", "31 pictures of 2 s at twice the pace, not " + root.dataset.pictures);
    check(Number(root.dataset.video) > 10000, root.dataset.video + " bytes of video");
    const video = document.createElement("video");
    video.src = URL.createObjectURL(saved);
    await new Promise((resolve, reject) => { video.onloadedmetadata = resolve; video.onerror = reject; });
    check(Math.abs(video.duration - 31 / 30) < 0.01, "31 pictures last " + video.duration + " s");
    check(video.videoWidth > 100 && video.videoHeight > 100, "the size of the video");
    check(find("record").textContent === "Video", "the button is as before");
"""


def check_acting(folder, fragment, script, size=(900, 700), before="", page="page.html"):
    """The marks of a page after `script` has acted on it. `before` runs before all other scripts.

    The encoding of pictures and videos may take longer than the virtual time; then it is tried again with more time.
    """
    with open(os.path.join(folder, page), encoding="utf-8") as file:
        text = file.read()
    acting = os.path.join(folder, "acting.html")
    with open(acting, "w", encoding="utf-8") as file:
        # The scripts play the video that the page has made.
        text = text.replace("img-src data:", "img-src data:; media-src blob:", 1)
        file.write(text.replace("<head>", f"<head><script>{before}</script>", 1)
                   .replace("</body>", f"<script>{ACTING % script if script else ''}</script></body>"))
    for seconds in [600, 6000] if script else [12]:
        found = marks(browse(acting, fragment, size=size, seconds=seconds))
        if "error" in found or "done" in found:
            break
    return found


def check_live(folder):
    with open(os.path.join(folder, "live.json"), encoding="utf-8") as file:
        messages = file.read().replace("<", "\\u003c")  # names with markup
    before = f"const MESSAGES = {messages};{SERVER}"
    found = check_acting(folder, "#token=secret", LIVE, before=before, page="live.html")
    assert "error" not in found, f"live: {found['error']}"
    assert found.get("done") == "true", "live: the script did not come to its end"


def check_actions(folder):
    for fragment, script, page in [("#frame=60&color=stress", POINTING, "page.html"), ("#frame=40", KEYS, "page.html"),
                                   ("#frame=0", LAYOUT, "empty.html"),
                                   ("#frame=10", RECORDING, "page.html"), ("#color=body", VISUAL, "visual.html")]:
        found = check_acting(folder, fragment, script, page=page)
        assert "error" not in found, f"{fragment}: {found['error']}"
        assert found.get("done") == "true", f"{fragment}: the script did not come to its end"
    lacking = {
        "no DecompressionStream": "delete window.DecompressionStream;",
        "no WebGL": "HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...more) {"
                    "return /webgl/.test(kind) ? null : get.call(this, kind, ...more); })"
                    "(HTMLCanvasElement.prototype.getContext);",
    }
    for expected, before in lacking.items():
        found = check_acting(folder, "#frame=10", "", before=before)
        assert found.get("error") == expected, f"expected {expected}, found {found}"
        assert found.get("frame") == "10", f"{expected}: the plots do not work: {found}"


def main(folder):
    folder = os.path.abspath(folder)
    page = os.path.join(folder, "page.html")
    with open(page, encoding="utf-8") as file:
        text = file.read()
    assert len(text.encode()) < MAX_BYTES, f"{len(text.encode())} bytes"
    for outside in [r"<script[^>]*\ssrc", r"<link\b", r"@import", r"url\(", r"<img\b", r"<iframe\b"]:
        assert not re.search(outside, text.split("<script>")[0]), f"the page refers to something outside: {outside}"

    ready = {"ready": "true", "frames": "120"}
    first = check(folder, "page.html", "#frame=0", {**ready, "frame": "0", "bodies": "7", "color": "speed"},
                  "frame_0.png")
    later = check(folder, "page.html", "#frame=30&color=stress",
                  {**ready, "frame": "30", "bodies": "7", "color": "stress"}, "frame_30.png")
    switched = "#frame=60&color=body&contacts=region&xray=1&wire=1&flat=1"
    check(folder, "page.html", switched, {**ready, "bodies": "8", "color": "body"}, "frame_60.png")
    check(folder, "page.html", "#frame=119&colliders=0&contacts=off", {**ready, "frame": "119", "bodies": "7"},
          "frame_119.png")
    check(folder, "page.html", "#time=1.17", {**ready, "frame": "70"}, "narrow.png", (520, 1100))
    # In a small window, whose pictures cost little: on a machine with other work the browser's own time passes between
    # few of them.
    for seconds in [10, 40, 160]:
        playing = marks(browse(page, "#play=1&frame=0&rate=1", size=(400, 300), seconds=seconds))
        if "error" in playing or int(playing["frame"]) > 0:
            break
    assert "error" not in playing and int(playing["frame"]) > 0, f"playing did not move on: {playing}"
    check(folder, "empty.html", "", {"ready": "true", "frames": "0"}, "empty.png")

    check_actions(folder)
    check_live(folder)

    for path in [first, later]:
        count, commonest = colors_in_view(path)
        assert count > 500 and commonest < 0.9, f"{path} looks blank: {count} colours, one covers {commonest:.0%}"
    with open(first, "rb") as a, open(later, "rb") as b:
        assert a.read() != b.read(), "two frames look alike"
    print(f"page of {os.path.getsize(page) / 1e6:.1f} MB plays; pictures in {folder}")


if __name__ == "__main__":
    main(sys.argv[1])
