"""Cases of the program T-Blade3 (Siddappaji et al. 2012), read as they stand and evaluated by its own rules."""

from bladewright.files.tblade3.angles import MetalAngles as MetalAngles
from bladewright.files.tblade3.angles import metal_angles as metal_angles
from bladewright.files.tblade3.importing import import_tblade3 as import_tblade3
from bladewright.files.tblade3.reading import is_tblade3 as is_tblade3
from bladewright.files.tblade3.reading import read_tblade3 as read_tblade3
from bladewright.files.tblade3.records import TBlade3Case as TBlade3Case
from bladewright.files.tblade3.sections import SectionValues as SectionValues
from bladewright.files.tblade3.sections import section_spans as section_spans
from bladewright.files.tblade3.sections import section_values as section_values
from bladewright.files.tblade3.splines import SpanSpline as SpanSpline
