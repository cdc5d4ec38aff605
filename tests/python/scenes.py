"""A small scene for the tests."""

from typing import Any

SCENE: dict[str, Any] = {
    "name": "drop",
    "description": "A ball falls on a floor.",
    "seconds": 0.1,
    "frame_step": 0.02,
    "probe_step": 0.01,
    "settings": {"threads": 1},
    "materials": {"rubber": {"young_modulus": 2e5}},
    "bodies": [
        {
            "name": "ball",
            "mesh": {"ball": {"radius": 0.05, "resolution": 4}},
            "material": "rubber",
            "position": [0, 0, 0.06],
        }
    ],
    "colliders": [{"name": "floor", "shape": {"plane": {"normal": [0, 0, 1]}}}],
    "probes": [
        {"name": "ball", "body": "ball", "quantity": "motion"},
        {"name": "push", "quantity": "force", "body": "ball", "by": "floor"},
    ],
}


def changed(**values: Any) -> dict[str, Any]:
    return {**SCENE, **values}
