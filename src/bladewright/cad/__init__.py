"""Solids, CAD files and their round trips: the only room that loads OpenCASCADE."""
