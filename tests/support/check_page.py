"""Opens pages of PageWriter in headless Chromium: check_page.py FOLDER, which holds page.html and empty.html of
output_sample_files.

A page marks its root element: data-ready after the first picture, data-error after a failure or a blocked request. The
script asks for several states by URL fragment, reads the marks back, and looks at the picture itself. Pictures stay in
the folder. Ends with 77 (skipped, for CTest) when there is no Chromium.
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

MAX_BYTES = 10_000_000  # of 120 frames of 5,000 surface vertices


def chromium():
    for name in ["chromium", "chromium-browser", "google-chrome"]:
        if shutil.which(name):
            return shutil.which(name)
    print("SKIPPED: no Chromium; Debian: apt-get install chromium")
    sys.exit(77)


def run_once(command, seconds):
    """What the command prints, or None when it is not done after that many seconds: then all its processes end."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          start_new_session=True) as process:
        try:
            return process.communicate(timeout=seconds)[0]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return None


def browse(page, fragment, picture=None, size=(1440, 900), seconds=2):
    """The page as the browser has it after that many seconds of its own time, and its picture if a name is given.

    Headless Chromium hangs now and then on a machine with other work, whatever the page: it is started again, twice.
    """
    for _ in range(3):
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            command = [chromium(), "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
                       "--enable-unsafe-swiftshader",
                       "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={profile}",
                       f"--window-size={size[0]},{size[1]}", f"--virtual-time-budget={1000 * seconds}", "--dump-dom"]
            if picture:
                command.append(f"--screenshot={picture}")
            dom = run_once(command + [f"file://{page}{fragment}"], 120)
        if dom:
            return dom
        print(f"the browser gave no page for {fragment or 'an empty fragment'}; started again", flush=True)
    sys.exit(f"the browser gave no page for {page}{fragment} in three attempts of 120 s")


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
    """How many different colours the middle of the three-dimensional view has, and the share of the commonest."""
    rows = pixels(path)
    height, width = len(rows), len(rows[0])
    seen = {}
    for row in rows[height // 4:3 * height // 4]:
        for pixel in row[width // 8:5 * width // 8]:
            seen[pixel] = seen.get(pixel, 0) + 1
    return len(seen), max(seen.values()) / sum(seen.values())


def check(folder, page, fragment, expected, picture, size=(1440, 900)):
    path = os.path.join(folder, picture)
    found = marks(browse(os.path.join(folder, page), fragment, path, size))
    assert "error" not in found, f"{page}{fragment}: {found['error']}"
    for name, value in expected.items():
        assert found.get(name) == value, f"{page}{fragment}: {name} is {found.get(name)}, expected {value}"
    return path


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
    check(folder, "page.html", "#frame=70", ready, "narrow.png", (520, 1100))
    # In a small window, whose pictures cost little: on a machine with other work the browser's own time passes between
    # few of them.
    for seconds in [2, 8, 32]:
        playing = marks(browse(page, "#play=1&frame=0&rate=1", size=(400, 300), seconds=seconds))
        if "error" in playing or int(playing["frame"]) > 0:
            break
    assert "error" not in playing and int(playing["frame"]) > 0, f"playing did not move on: {playing}"
    check(folder, "empty.html", "", {"ready": "true", "frames": "0"}, "empty.png")

    for path in [first, later]:
        count, commonest = colors_in_view(path)
        assert count > 500 and commonest < 0.9, f"{path} looks blank: {count} colours, one covers {commonest:.0%}"
    with open(first, "rb") as a, open(later, "rb") as b:
        assert a.read() != b.read(), "two frames look alike"
    print(f"page of {os.path.getsize(page) / 1e6:.1f} MB plays; pictures in {folder}")


if __name__ == "__main__":
    main(sys.argv[1])
