"""The models that the tests load: our examples, and those of the comparison with MuJoCo that cover a feature each."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "models").glob("*.xml"))
FEATURES = sorted((ROOT / "parity/models").glob("*.xml"))
