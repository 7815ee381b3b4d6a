"""The program: its commands, and what becomes of their outcomes and errors."""

import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType

import click

from bladewright.cli.build import build
from bladewright.cli.fit import fit
from bladewright.cli.import_design import import_design
from bladewright.cli.mesh import mesh
from bladewright.cli.new import new
from bladewright.cli.optimise import optimise
from bladewright.cli.options import Call, common
from bladewright.cli.outcome import INTERRUPTED, Outcome, one_paragraph, print_outcome
from bladewright.cli.polar import polar
from bladewright.cli.schema import schema
from bladewright.cli.sensitivity import sensitivity
from bladewright.cli.show import show
from bladewright.cli.sweep import sweep
from bladewright.cli.verify import verify
from bladewright.errors import BladewrightError, FileError


def _version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if not wanted or context.resilient_parsing:
        return
    from importlib import metadata

    from bladewright import __version__

    try:
        kernel = ".".join(metadata.version("cadquery-ocp").split(".")[:3])
    except metadata.PackageNotFoundError:
        kernel = "not installed"
    click.echo(f"bladewright {__version__} (OpenCASCADE {kernel})")
    context.exit()


@click.group(invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Print the versions."
)
@common
@click.pass_context
def program(context: click.Context) -> None:
    """Turbomachinery blades: from a design file to CAD solids that are reopened and measured.

    Exit status: 0 done and passed; 1 done, but a check failed; 2 the input or the call is wrong; 130 interrupted.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


for each in (build, verify, fit, import_design, mesh, show, sensitivity, polar, sweep, optimise, new, schema):
    program.add_command(each)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command that the words of a command line name, and return the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    call = Call.from_words(words)
    with _noted_interrupts() as interrupts:
        try:
            outcome = program.main(words, prog_name="bladewright", standalone_mode=False, obj=call)
            return print_outcome(outcome, call) if isinstance(outcome, Outcome) else int(outcome or 0)
        except (KeyboardInterrupt, click.Abort) as error:
            told = str(error.__cause__ or error)  # click's own error leaves out what was told
            return _refused(call, error, "Interrupted", f"interrupted: {told}" if told else "interrupted", INTERRUPTED)
        except Exception as error:  # noqa: BLE001  a user is owed a paragraph whatever happens
            kind, message = _told(error)
            if interrupts:
                # the import of a compiled module makes another error of an interrupt
                return _refused(call, error, "Interrupted", f"interrupted ({message})", INTERRUPTED)
            return _refused(call, error, kind, message)


@contextmanager
def _noted_interrupts() -> Iterator[list[int]]:
    """The interrupts that have come so far, each of which is handled as before."""
    heard: list[int] = []
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield heard
        return

    def handle(number: int, frame: FrameType | None) -> None:
        heard.append(number)
        before(number, frame)

    signal.signal(signal.SIGINT, handle)
    try:
        yield heard
    finally:
        signal.signal(signal.SIGINT, before)


def _told(error: Exception) -> tuple[str, str]:
    """The kind of an error, and what a user is told of it."""
    if isinstance(error, click.ClickException):
        return "UsageError", _with_help(error)
    if isinstance(error, BladewrightError | MemoryError):
        return type(error).__name__, str(error) or "there is not enough memory for this design"
    if isinstance(error, OSError):
        return FileError.__name__, str(error)
    reason = f"{type(error).__name__}: {error}"
    return "InternalError", f"this is a fault of bladewright, not of the input ({reason}); --debug shows where"


def _with_help(error: click.ClickException) -> str:
    """The message of a usage error as a sentence, and where the help is."""
    context, message = getattr(error, "ctx", None), error.format_message()
    return f"{message.rstrip('.')}. See '{context.command_path} --help'." if context else message


def _refused(call: Call, error: BaseException, kind: str, message: str, status: int = 2) -> int:
    if call.debug:
        traceback.print_exception(error, file=sys.stderr)
    message = one_paragraph(message)
    if call.as_json:
        print_outcome(Outcome(data={"error": {"kind": kind, "message": message}}), call)
    click.echo(f"bladewright: {message}", err=True)
    return status
