"""What is refused as a cloud."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bladewright.errors import FitError
from bladewright.fitting.clouds.cloud import checked_cloud, different_points, pitch_found, refuse_several_blades

ANGLES = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
SECTION = 0.05 * np.stack([np.cos(ANGLES), 0.2 * np.sin(ANGLES) + 0.3 * np.cos(ANGLES) ** 2], axis=-1)
BLADE = np.array([[x, y, z] for z in np.linspace(0.3, 0.4, 12) for x, y in SECTION[::5]])
HOLED = np.array(SECTION)
HOLED[7, 1] = np.nan
NEXT_SECTION, NEXT_BLADE = SECTION + np.array([0.0, 0.06]), BLADE + np.array([0.0, 0.06, 0.0])
TURNS = Rotation.from_rotvec(np.arange(20)[:, None] * [2.0 * np.pi / 20, 0.0, 0.0]).as_matrix()
LINE = np.linspace(0.0, 1.0, 200)[:, None]


@pytest.mark.parametrize("cloud", [SECTION, BLADE, np.concatenate([SECTION, SECTION])])
def test_a_whole_blade_is_taken_as_it_is(cloud: np.ndarray) -> None:
    assert np.array_equal(checked_cloud(cloud), cloud)


@pytest.mark.parametrize(
    ("cloud", "said"),
    [
        ([["a", "b"]] * 200, "are not numbers"),
        (np.zeros((200, 4)), "the shape"),
        (HOLED, "the first of them row 7"),
        (SECTION[:23], "23 different points"),
        (BLADE[:99], "99 different points"),
        (np.repeat(BLADE[:50], 4, axis=0), "50 different points"),
        (LINE * [1.0, 2.0], "one line"),
        (LINE * [1.0, 2.0, 3.0], "one line"),
        (SECTION @ [[1.0, 0.0, 0.5], [0.0, 1.0, 0.2]], "one plane"),
        (np.stack([LINE[:, 0], LINE[:, 0] * (1.0 - LINE[:, 0])], axis=-1), "one side"),
    ],
)
def test_what_is_no_blade_is_refused_in_one_paragraph(cloud: object, said: str) -> None:
    with pytest.raises(FitError, match=said) as refusal:
        checked_cloud(cloud)  # type: ignore[arg-type]
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("cloud", "pitch"),
    [
        (np.concatenate([SECTION, NEXT_SECTION]), "0.06 m"),
        (np.concatenate([BLADE, NEXT_BLADE]), "0.06 m"),
        (np.concatenate([BLADE @ turn.T for turn in TURNS]), "18 deg"),
    ],
)
def test_several_blades_are_refused_with_their_pitch(cloud: np.ndarray, pitch: str) -> None:
    with pytest.raises(FitError, match=f"two blades or more: {pitch} along the pitch") as refusal:
        refuse_several_blades(cloud)
    assert "\n" not in str(refusal.value)


def test_a_blade_that_hardly_shows_beside_its_walls_is_refused_with_the_number_of_its_points() -> None:
    assert len(different_points(BLADE[:100], " on the sides")) == 100
    with pytest.raises(FitError, match=r"99 different points on the sides: at least 100 are needed"):
        different_points(BLADE[:99], " on the sides")


def test_sections_along_y_are_no_copies_along_the_pitch() -> None:
    sections = [np.column_stack([SECTION[:, 0], np.full(len(SECTION), span), SECTION[:, 1]]) for span in (0.0, 0.02)]
    assert pitch_found(np.concatenate(sections)) is None


def vane(count: int, rows: int) -> np.ndarray:
    """Points of a thin vane of a radial machine, 72 degrees from the radius, in rows along x."""
    t, x = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, count, endpoint=False), np.linspace(0.0, 0.02, rows))
    r = 0.07 + 0.02 * np.cos(t)
    theta = np.tan(np.radians(72.0)) * np.log(r / 0.07) + 0.04 * np.sin(t)
    return np.stack([x, r * np.sin(theta), r * np.cos(theta)], axis=-1).reshape(-1, 3)


def test_a_highly_staggered_vane_is_one_blade_and_its_wheel_has_a_pitch() -> None:
    assert pitch_found(vane(200, 12)) is None
    turns = Rotation.from_rotvec(np.arange(24)[:, None] * [2.0 * np.pi / 24, 0.0, 0.0]).as_matrix()
    # rows further from each other than the blades
    assert pitch_found(np.concatenate([vane(40, 4) @ turn.T for turn in turns])) == "15 deg"
