// The keyboard, and the card that explains the keys.
"use strict";

// keys: rows of [keys, description, action(shift, key)]. A key whose action returns false keeps its meaning in the
// browser. `?` shows the rows; it and Escape hide them again.
function listen_to_keys(find, keys) {
  const help = find("help"), list = help.querySelector("dl"), spoken = { " ": "Space", ArrowLeft: "\u2190",
    ArrowRight: "\u2192", ArrowUp: "\u2191", ArrowDown: "\u2193" };
  const show_help = (on) => {
    help.hidden = !on;
    find("help_button").setAttribute("aria-pressed", on);
    if (on) help.focus();
  };
  const bound = new Map();
  for (const [names, description, action] of keys) {
    const term = document.createElement("dt"), about = document.createElement("dd");
    for (const name of names) {
      const key = document.createElement("kbd");
      key.textContent = spoken[name] || (name.length === 1 ? name.toUpperCase() : name);
      term.append(key);
      bound.set(name, action);
    }
    about.textContent = description;
    list.append(term, about);
  }
  // Characters of these keys with Shift, or without.
  for (const [other, key] of [["{", "["], ["}", "]"], ["=", "+"], ["_", "-"]]) bound.set(other, bound.get(key));
  bound.set("?", () => show_help(help.hidden));
  bound.set("Escape", () => show_help(false));

  // Keys that an element needs for itself. The page handles the arrow keys of the timeline.
  const own = { range: /^(Arrow|Page|Home$|End$|Delete$)/, checkbox: /^ $/ };
  const needs = ({ id, type }, key) => id !== "scrub" && own[type] && own[type].test(key);
  window.addEventListener("keydown", (event) => {
    const { target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || target.tagName === "SELECT") return;
    if (needs(target, event.key)) return;
    if (target.tagName === "BUTTON" && (event.key === " " || event.key === "Enter")) return;  // presses the button
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, action = bound.get(key);
    if (action && action(event.shiftKey, key) !== false) event.preventDefault();
  });
  find("help_button").addEventListener("click", () => show_help(help.hidden));
  help.querySelector("button").addEventListener("click", () => show_help(false));
}
