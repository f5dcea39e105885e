"""Draws the gallery of the site: a picture of every example model after half a second, and the page of all pictures.

Without a graphics driver the page says so and has no pictures.

    python docs/site/gallery.py
"""

from __future__ import annotations

import re
from pathlib import Path

import clench

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(__file__).resolve().parent / "gallery"
SECONDS = 0.5


def picture(path: Path, to: Path) -> None:
    """Draws a model after half a second, as a PNG."""
    from matplotlib import image

    sim = clench.Sim(clench.Model.from_file(path))
    sim.step(max(1, round(SECONDS / sim.model.timestep)))
    image.imsave(to, sim.render(640, 400))


def about(path: Path) -> str:
    """Returns the text of the comment at the top of a model's file."""
    comment = re.match(r"\s*<!--(.*?)-->", path.read_text(encoding="utf-8"), re.S)
    return " ".join(comment[1].split()) if comment else ""


def main() -> None:
    """Draws all models and writes the page."""
    FOLDER.mkdir(exist_ok=True)
    page = ["# Gallery", f"The example models of the repository after {SECONDS} s, as `sim.render()` draws them.", ""]
    models = sorted((ROOT / "models").glob("*.xml"))
    for path in models:
        page += [f"## {path.stem.replace('_', ' ').capitalize()}", ""]
        try:
            picture(path, FOLDER / f"{path.stem}.png")
            page += [f"![{path.stem}]({path.stem}.png)", ""]
        except clench.ClenchError as error:
            page += [f"There is no picture: {error}", ""]
        page += [about(path), ""]
    (FOLDER / "index.md").write_text("\n".join(page), encoding="utf-8")
    print(f"{len(models)} models in {FOLDER.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
