"""The models that the tests load: our examples, and those of the comparison with MuJoCo for features and shapes."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "models").glob("*.xml"))
FEATURES = sorted((ROOT / "parity/models").glob("*.xml"))
SHAPES = sorted((ROOT / "parity/shapes").glob("*.xml"))
# Models of other packages in .venv/models that Clench does not refuse; `parity/public.txt` gives the reasons of others.
PUBLIC = [
    line for line in (ROOT / "parity/public.txt").read_text().splitlines() if not line.startswith("#") and ": " not in line
]
