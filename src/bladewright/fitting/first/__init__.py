"""A first design from points alone: near enough for a least-squares fit to converge from it."""

from bladewright.fitting.initial_guess.arrangement import found_arrangement
from bladewright.fitting.initial_guess.blade import first_blade
from bladewright.fitting.initial_guess.section import first_section

__all__ = ["first_blade", "first_section", "found_arrangement"]
