"""The Python blocks of the documents run."""

import re
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[3]
BLOCKS = [
    pytest.param(block, id=f"{name}-{number}")
    for name in ("README.md", "docs/python.md", "crates/python/README.md")
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", (TOP / name).read_text(), re.S))
]


def test_there_are_blocks():
    assert len(BLOCKS) >= 6


@pytest.mark.parametrize("block", BLOCKS)
def test_block_runs(block):
    exec(compile(block, "document", "exec"), {"__name__": "document"})
