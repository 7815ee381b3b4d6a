"""The command line: `bladewright COMMAND`, one file per command."""

from bladewright.cli.program import main as main
