"""Error bars of studies against known solutions. scripts/error_bars measures all items."""

import importlib
import json
import sys
from pathlib import Path
from typing import Any

import pytest

import skerry as sk

sys.path.insert(0, str(Path(__file__).parents[2] / "profiling" / "error_bars"))
ITEMS: dict[str, Any] = {
    item.name: item for module in ("static_items", "motion_items") for item in importlib.import_module(module).items()
}


@pytest.mark.parametrize("name", ["cantilever_thick", "bar_step_load", "drag", "bounce"])
def test_a_true_error_lies_inside_the_error_bar(name: str, tmp_path: Path) -> None:
    item = ITEMS[name]
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(item.scene))
    found = sk.study(scene, probes=[item.probe], threads=1, budget=10).quantities[f"{item.probe}_{item.at}"]
    error = abs(found.value - item.truth)
    assert error > 1e-3 * abs(item.truth)  # else the next line claims little
    assert error <= found.error + item.doubt * abs(item.truth) < 10 * error
