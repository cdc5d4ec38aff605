// Puts the page together.
"use strict";

function is_without_gpu(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return names !== null && /swiftshader|llvmpipe|softpipe/i.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}

(async () => {
  const find = (id) => document.getElementById(id);
  const root = document.documentElement;

  function notice(message) {
    if (root.dataset.error) return;  // the message about the error stays
    find("notice").textContent = message;
    find("notice").hidden = !message;
  }
  // A check of the page reads these marks: data-ready after the first picture, data-error after a failure.
  function fail(mark, message) {
    notice(message);
    root.dataset.error = mark;
  }
  window.addEventListener("error", (event) => fail(event.message, "This page failed: " + event.message));
  window.addEventListener("unhandledrejection", (event) => {
    const message = (event.reason && event.reason.message) || String(event.reason);
    fail(message, "This page failed: " + message);
  });
  document.addEventListener("securitypolicyviolation", (event) => {
    root.dataset.error = "blocked " + event.blockedURI;
  });

  const run = JSON.parse(find("run").textContent);
  root.classList.toggle("live", Boolean(run.live));
  const page = { find, run, notice, fail, state: { ...initial_state }, plots: [], scene: null, bodies: () => [] };
  const text_of = (id) => {
    const content = find(id).textContent;
    find(id).remove();
    return content;
  };
  const packed = Object.fromEntries(["three", "frames", "visuals"].map((id) => [id, text_of(id)]));
  const can_unpack = typeof DecompressionStream !== "undefined";
  if (!can_unpack) {
    fail("no DecompressionStream", "This browser cannot show the frames of this page, because it lacks "
      + "DecompressionStream. Use Chrome or Edge 80, Firefox 113, Safari 16.4, or a later version. The plots work "
      + "without the frames.");
  } else {
    notice("Unpacking \u2026");
    const library = document.createElement("script");
    library.textContent = new TextDecoder().decode(await decode.inflate(packed.three, "gzip"));
    document.head.append(library);
    notice("");
  }
  const has_view = can_unpack && document.createElement("canvas").getContext("webgl");
  page.is_coarse = Boolean(run.live && has_view && is_without_gpu(has_view));
  if (can_unpack && !has_view)
    fail("no WebGL", "The three-dimensional view needs WebGL, which is not available in this browser. Enable hardware "
      + "acceleration or use another browser. The plots work without WebGL.");
  root.classList.toggle("plain", !has_view);

  const player = run.live ? make_live(page, has_view) : await open_recorded(page, packed, has_view, can_unpack);
  const controls = make_controls(page, player);
  controls.start();
  player.start(controls);
})();
