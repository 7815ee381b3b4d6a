"""The meridional flow as native geometry: channel, stream surfaces, stream lines, and the planes of sections."""
