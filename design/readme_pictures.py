"""Remake the pictures of the README.

python design/readme_pictures.py
"""

import tempfile
from importlib import resources
from pathlib import Path

from PIL import Image

import bladewright as bw
from bladewright import views

HERE = Path(__file__).parents[1] / "docs" / "pictures"
WIDTH = 1400
"""of a picture [pixels]"""


def keep(made, name):
    """A smaller copy: 200 colours are enough for lines and shaded blades."""
    with Image.open(made) as picture:
        size = (WIDTH, round(picture.height * WIDTH / picture.width))
        small = picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)
        small.quantize(200, dither=Image.Dither.NONE).save(HERE / name, optimize=True)


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
