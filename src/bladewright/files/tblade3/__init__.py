"""Cases of the program T-Blade3 (Siddappaji et al. 2012), read and evaluated by its own rules, and imported."""

from bladewright.files.tblade3.case import TBlade3Case as TBlade3Case
from bladewright.files.tblade3.importing import import_tblade3 as import_tblade3
from bladewright.files.tblade3.reading import is_tblade3 as is_tblade3
from bladewright.files.tblade3.reading import read_tblade3 as read_tblade3
from bladewright.files.tblade3.section_values import MetalAngles as MetalAngles
from bladewright.files.tblade3.section_values import SectionValues as SectionValues
from bladewright.files.tblade3.section_values import SpanSpline as SpanSpline
from bladewright.files.tblade3.section_values import metal_angles as metal_angles
from bladewright.files.tblade3.section_values import section_spans as section_spans
from bladewright.files.tblade3.section_values import section_values as section_values
