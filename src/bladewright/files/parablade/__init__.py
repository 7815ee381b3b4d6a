"""Designs of the program ParaBlade (Agromayor et al. 2021), read as designs of the unified family."""

from bladewright.files.parablade.reading import import_parablade as import_parablade
from bladewright.files.parablade.reading import is_parablade as is_parablade
from bladewright.files.parablade.reading import read_parablade as read_parablade
