"""What bladewright raises: every message says what was asked, the value, the limit and the cure."""


class BladewrightError(Exception):
    """Base of all errors a user can cause; the command line turns it into one paragraph and exit status 2."""


class DesignError(BladewrightError, ValueError):
    """A design that cannot be built: parameters out of their limits, or a shape that is impossible.

    `args` are a paragraph for each thing to correct. It is a ValueError so that the validation of a design file goes on
    with the other keys.
    """

    def __str__(self) -> str:
        if len(self.args) < 2:
            return super().__str__()
        numbered = (f"({number}) {text}" for number, text in enumerate(self.args, start=1))
        return f"{len(self.args)} things to correct: {'; '.join(numbered)}"


class FileError(BladewrightError):
    """A file that cannot be read, understood or written."""


class GeometryError(BladewrightError):
    """A geometric operation asked of a curve or surface that cannot carry it out."""


class CadError(BladewrightError):
    """A solid that OpenCASCADE could not make, write or reopen."""


class MeshError(BladewrightError):
    """A mesh that was asked for wrongly, or that gmsh could not make, write or reopen."""


class DerivativeError(BladewrightError):
    """A derivative that cannot be taken: a quantity that loses the step, or parameters that do not exist."""


class FitError(BladewrightError):
    """A cloud of points that cannot be fitted, or a fit that was asked for wrongly."""


class PolarError(BladewrightError):
    """A polar that was asked for wrongly, or whose solver is missing, hangs or does not converge anywhere."""


class StudyError(BladewrightError):
    """A study that was asked for wrongly: its file, its variables, its quantities, or a manifest of another one."""
