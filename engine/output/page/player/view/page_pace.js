// Chooses how finely to draw, by how fast the browser draws.
"use strict";

const pace_levels = [
  { shadows: true, share: 1 }, { shadows: false, share: 1 }, { shadows: false, share: 0.7 },
  { shadows: false, share: 0.5 },
];

// The finest level without shadows that draws at most 300,000 of the pixels, or the coarsest one.
function first_level(pixels) {
  const level = pace_levels.findIndex(({ shadows, share }) => !shadows && share * share * pixels <= 300000);
  return level < 0 ? pace_levels.length - 1 : level;
}

// next(is_changed) is called before each turn of the loop, and returns the level of detail: a coarser one while turns
// with new pictures take too long, and all pixels once the picture stands still. share: drawn pixels per pixel of a
// row. Shadows do not come back, because switching them takes the time of many pictures. is_coarse: there is no GPU, so
// that the first level depends on `pixels`, the number of pixels of the view.
function make_pace(is_coarse, pixels) {
  const slow = 40, rest = 400;  // ms of a turn, and after the last picture
  let level = is_coarse ? first_level(pixels) : 0, late = 0, drew = false;
  let turned = 0, changed = 0, chosen = 0, trial = 10000;  // ms

  function judge(passed, now) {
    late = Math.max(late + (passed > slow ? Math.min(passed / slow, 3) : -1), 0);
    if (late > 6 && level < pace_levels.length - 1) {
      if (now - chosen < 2000) trial *= 2;  // the finer level was tried in vain
      ++level;
    } else if (late === 0 && level > 1 && now - chosen > trial) {
      --level;
    } else {
      return;
    }
    late = 0;
    chosen = now;
  }
  function next(is_changed) {
    const now = performance.now(), passed = now - turned;
    if (drew && passed < 1000) judge(passed, now);  // a longer turn: the page was hidden
    turned = now;
    drew = is_changed;
    if (is_changed) changed = now;
    const { shadows, share } = pace_levels[level];
    return { shadows, share: now - changed > rest ? 1 : share };
  }
  return { next };
}
