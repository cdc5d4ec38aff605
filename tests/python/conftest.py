"""Fixtures of several files of tests."""

from __future__ import annotations

from typing import Any

import pytest

import skerry as sk
from worlds import ball_world


@pytest.fixture
def view() -> Any:
    with sk.view(ball_world()[0], open=False) as opened:
        yield opened
