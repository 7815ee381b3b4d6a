"""The cure for builds of XFOIL that stop at floating-point traps, as Debian's does in every viscous case.

XFOIL divides by zero harmlessly where a transition point moves. A build with traps ends there (signal SIGFPE). gfortran
arms them by one call when the program starts, and a preloaded library with an empty function of that name leaves them
unarmed. It is compiled once, and kept in the user's cache directory.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from bladewright.errors import PolarError

SOURCE = "void _gfortran_set_fpe(int flags) { (void)flags; }\n"
"""The library: what gfortran calls to arm the traps does nothing."""
COMPILERS = ("cc", "gcc", "clang")
"""Names of C compilers that take -shared, in the order in which they are looked for."""
NAMED = "BLADEWRIGHT_XFOIL to an XFOIL that does not trap, or to a script that starts one (see docs/polars.md)"
"""What the variable is to be set to."""


def library() -> Path:
    """Where the library is kept: the cache directory of the user, by the processor that it is for."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "bladewright" / f"no-floating-point-traps-{os.uname().machine}.so"


def built() -> bool:
    """Whether the library has been built."""
    return sys.platform.startswith("linux") and library().is_file()


def environment() -> dict[str, str]:
    """The environment in which XFOIL runs: without a screen, and with the library where it has been built."""
    env = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    if built():
        env["LD_PRELOAD"] = ":".join(filter(None, [str(library()), env.get("LD_PRELOAD")]))
    return env


def build_library() -> None:
    """Compile the library; raises PolarError where that cannot be done here."""
    trapped = "XFOIL stopped at a floating-point trap, as Debian's and Ubuntu's build does in every viscous case"
    if not sys.platform.startswith("linux"):
        raise PolarError(f"{trapped}: set {NAMED}")
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        raise PolarError(
            f"{trapped}; a library of one line cures it, which is built on first use, but there is no C compiler here: "
            f"install one (apt-get install gcc), or set {NAMED}"
        )
    place = library()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=place.parent) as folder:
            source, made = Path(folder) / "traps.c", Path(folder) / "traps.so"
            source.write_text(SOURCE)
            subprocess.run(  # noqa: S603  a C compiler, on a source of our own
                [compiler, "-shared", "-fPIC", "-o", str(made), str(source)], check=True, capture_output=True, text=True
            )
            made.replace(place)
    except (OSError, subprocess.CalledProcessError) as error:
        reason = str(getattr(error, "stderr", "") or error).strip()
        raise PolarError(
            f"{trapped}; the library of one line that cures it cannot be built as '{place}': {reason}; or set {NAMED}"
        ) from error
