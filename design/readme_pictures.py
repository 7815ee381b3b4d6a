"""Remake the pictures of the README and of docs/.

python design/readme_pictures.py
"""

import tempfile
from importlib import resources
from pathlib import Path

from PIL import Image

import bladewright as bw
from bladewright import views

HERE = Path(__file__).parents[1] / "docs" / "pictures"
WIDTH, NARROW = 1400, 1150
"""of a picture, and of one in all its colours [pixels]"""


def smaller(made, width):
    """A copy of another width."""
    with Image.open(made) as picture:
        size = (width, round(picture.height * width / picture.width))
        return picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)


def keep(made, name):
    """A smaller copy: 200 colours are enough for lines and shaded blades."""
    smaller(made, WIDTH).quantize(200, dither=Image.Dither.NONE).save(HERE / name, optimize=True)


with tempfile.TemporaryDirectory() as directory:
    picture = Path(directory) / "picture.png"
    for name in ("fan-rotor", "centrifugal-impeller"):
        with resources.as_file(resources.files("bladewright") / "examples" / f"{name}.toml") as path:
            blade = bw.read_design(path).build()
        views.blade_view(blade, picture)
        keep(picture, f"{name}-row.png")
        if name == "fan-rotor":
            views.picture(blade, picture)
            keep(picture, f"{name}.png")
    with resources.as_file(resources.files("bladewright") / "examples" / "nasa-rotor-67.toml") as path:
        views.passage_view(bw.passage(bw.read_design(path).build()), picture)
    # with so few colours its large faces would show bands
    smaller(picture, NARROW).save(HERE / "passage.png", optimize=True)
