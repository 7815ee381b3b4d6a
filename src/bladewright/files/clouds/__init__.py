"""Clouds of points in files of many formats, read as points in metres."""

from bladewright.files.clouds.cloud import Cloud as Cloud
from bladewright.files.clouds.reading import read_cloud as read_cloud
