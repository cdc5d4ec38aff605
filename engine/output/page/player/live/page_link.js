// The connection to the program that runs the scene.
"use strict";

// The token is in the fragment of the address that the program prints. It is removed from the address, and kept for
// this tab, so that the page can be loaded again.
function take_token() {
  const asked = new URLSearchParams(location.hash.slice(1));
  if (asked.has("token")) {
    sessionStorage.setItem("token", asked.get("token"));
    asked.delete("token");
    history.replaceState(null, "", location.pathname + (asked.toString() ? "#" + asked : ""));
  }
  return sessionStorage.getItem("token") || "";
}

// receive(data) gets the messages in their order; each call waits for the promise of the previous one. status(name,
// seconds): "connecting", "open", "lost" or "refused", with the time until the next try [s].
// settle(): the program has accepted the page, so that the next try after a lost connection comes soon.
function make_link(receive, status) {
  const token = take_token(), shortest_pause = 0.5, longest_pause = 15;  // s
  let socket = null, pause = shortest_pause;

  // The browser reports a refused socket like a lost program. A program that refuses the socket still serves the page.
  async function is_served() {
    try {
      return (await fetch("/", { cache: "no-store" })).ok;
    } catch (error) {
      return false;
    }
  }
  function connect() {
    status("connecting");
    const own = socket = new WebSocket("ws://" + location.host + "/live?token=" + encodeURIComponent(token));
    let queue = Promise.resolve(), was_open = false;
    own.binaryType = "arraybuffer";
    own.addEventListener("open", () => {
      was_open = true;
      status("open");
    });
    own.addEventListener("message", ({ data }) => {
      queue = queue.then(() => (own === socket ? receive(data) : undefined));
    });
    own.addEventListener("close", async () => {
      socket = null;
      const wait = pause;
      pause = Math.min(2 * pause, longest_pause);
      setTimeout(connect, 1000 * wait);
      status(!was_open && await is_served() ? "refused" : "lost", wait);
    });
  }
  const is_open = () => socket !== null && socket.readyState === WebSocket.OPEN;
  const send = (message) => { if (is_open()) socket.send(JSON.stringify(message)); };
  const settle = () => { pause = shortest_pause; };
  return { connect, send, is_open, settle };
}
