# SPDX-License-Identifier: Apache-2.0
"""Animations as files, read back with Pillow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import posespace
import pytest
from numpy.typing import NDArray
from PIL import Image

FPS = 30


def discs(count: int = 12, size: tuple[int, int] = (90, 60)) -> Iterator[NDArray[np.uint8]]:
    """A shaded disc with a soft edge that wanders over nothing."""
    width, height = size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    for k in range(count):
        distance = np.hypot(x - 20 - 4 * k, y - 30 - 10 * np.sin(k))
        pixels = np.zeros((height, width, 4), np.uint8)
        pixels[..., 0] = 200 - 8 * np.minimum(distance, 20)
        pixels[..., 1] = 60 + 10 * k
        pixels[..., 2] = 90
        pixels[..., 3] = np.clip((16 - distance) * 64, 0, 255)
        pixels[pixels[..., 3] == 0] = 0
        yield pixels


def read_back(file) -> tuple[list[NDArray[np.int_]], list[float], dict]:
    """Frames as they are shown, their milliseconds, and what the file says of itself."""
    frames, durations = [], []
    with Image.open(file) as image:
        for k in range(image.n_frames):
            image.seek(k)
            frames.append(np.asarray(image.convert("RGBA")).astype(int))
            durations.append(image.info["duration"])
        return frames, durations, dict(image.info)


@pytest.mark.parametrize("suffix", ["png", "apng", "gif", "webp"])
def test_frames_come_back_in_number_size_and_time(tmp_path, suffix):
    file = tmp_path / f"disc.{suffix}"
    assert posespace.save_animation(discs(), file, fps=FPS, loop=True) == 12
    frames, durations, info = read_back(file)
    assert len(frames) == 12 and all(frame.shape == (60, 90, 4) for frame in frames)
    assert sum(durations) == pytest.approx(1000 * 12 / FPS, abs=5)
    assert info["loop"] == 0, "0 is for ever"
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


@pytest.mark.parametrize("suffix", ["png", "gif", "webp"])
def test_what_is_not_looped_is_played_once(tmp_path, suffix):
    file = tmp_path / f"disc.{suffix}"
    posespace.save_animation(discs(), file, fps=FPS)
    assert read_back(file)[2].get("loop", 1) == 1


def test_an_animated_png_is_exact_in_pixels_and_in_time(tmp_path):
    posespace.save_animation(discs(), tmp_path / "disc.png", fps=60)
    frames, durations, _ = read_back(tmp_path / "disc.png")
    for frame, drawn in zip(frames, discs(), strict=True):
        assert np.array_equal(frame, drawn)
    assert durations == pytest.approx([1000 / 60] * 12, rel=1e-6)


def test_a_webp_keeps_its_alpha_exactly_and_its_colours_nearly(tmp_path):
    posespace.save_animation(discs(), tmp_path / "disc.webp", fps=60)
    for frame, drawn in zip(read_back(tmp_path / "disc.webp")[0], discs(), strict=True):
        assert np.array_equal(frame[..., 3], drawn[..., 3])
        painted = drawn[..., 3] > 0
        assert np.abs(frame - drawn)[painted].mean() < 8


def test_a_gif_shows_each_frame_on_nothing_in_colours_of_its_own(tmp_path):
    posespace.save_animation(discs(), tmp_path / "disc.gif", fps=FPS)
    frames, durations, _ = read_back(tmp_path / "disc.gif")
    assert set(durations) == {30, 40}, "a third of a hundredth is made up for"
    for frame, drawn in zip(frames, discs(), strict=True):
        painted = drawn[..., 3] >= 128
        assert np.array_equal(frame[..., 3], np.where(painted, 255, 0))
        assert np.abs(frame - drawn)[painted][:, :3].max() < 8


def test_a_gif_of_many_colours_comes_near_all_of_them(tmp_path):
    y, x = np.mgrid[0:128, 0:128]
    pixels = np.stack([2 * x, 2 * y, 255 - x - y, np.full_like(x, 255)], axis=2).astype(np.uint8)
    posespace.save_animation([pixels], tmp_path / "colours.gif", fps=10)
    ((frame,), _, _) = read_back(tmp_path / "colours.gif")
    assert (frame[..., 3] == 255).all()
    assert np.abs(frame - pixels.astype(int)).mean() < 8


def test_frames_without_anything_painted_are_frames_too(tmp_path):
    empty = np.zeros((20, 30, 4), np.uint8)
    solid = np.full((20, 30, 4), 255, np.uint8)
    for suffix in ("png", "gif", "webp"):
        file = tmp_path / f"blink.{suffix}"
        assert posespace.save_animation([empty, solid, empty], file, fps=10) == 3
        assert [frame[..., 3].max() for frame in read_back(file)[0]] == [0, 255, 0]


def test_single_frames_are_numbered_from_0(tmp_path):
    count = posespace.save_animation(discs(), tmp_path / "walk" / "%04d.png", fps=FPS)
    files = sorted((tmp_path / "walk").iterdir())
    assert [file.name for file in files] == [f"{k:04}.png" for k in range(12)] and count == 12
    for file, drawn in zip(files, discs(), strict=True):
        with Image.open(file) as image:
            assert np.array_equal(np.asarray(image), drawn)


@pytest.mark.parametrize("fps", [0.5, 12.5, 23.976, 29.97, 50])
def test_times_do_not_drift(tmp_path, fps):
    for suffix in ("png", "gif", "webp"):
        file = tmp_path / f"disc.{suffix}"
        posespace.save_animation(discs(), file, fps=fps)
        assert sum(read_back(file)[1]) == pytest.approx(12_000 / fps, abs=10)


def test_frames_are_taken_one_at_a_time(tmp_path):
    alive = []

    class Watched(np.ndarray):
        def __del__(self):
            alive.remove(self.number)

    def watched():
        for number, pixels in enumerate(discs()):
            frame = pixels.view(Watched)
            frame.number = number
            alive.append(number)
            yield frame
            del frame
            assert len(alive) <= 2

    for suffix in ("png", "gif", "webp"):
        posespace.save_animation(watched(), tmp_path / f"disc.{suffix}", fps=FPS)


@pytest.mark.parametrize(
    ("file", "fps", "says"),
    [
        ("disc.mp4", 30, "disc.mp4: an animation ends in .png"),
        ("disc", 30, "disc: an animation ends in"),
        ("disc.gif", 50.5, "at most 50 frames a second, not 50.5"),
        ("disc.png", 0, "fps is 0"),
        ("disc.webp", -1, "fps is -1"),
        ("disc.png", 1001, "fps is 1001"),
        ("disc.png", float("nan"), "fps is nan"),
        ("%04d.gif", 30, "%04d.png"),
        ("%s.png", 30, None),
        ("100%.png", 30, "%04d.png"),
        ("%d-%d.png", 30, "%04d.png"),
    ],
)
def test_what_cannot_be_written_is_refused_before_a_frame_is_taken(tmp_path, file, fps, says):
    taken = []
    frames = (taken.append(frame) or frame for frame in discs())
    if says is None:
        assert posespace.save_animation(frames, tmp_path / file, fps=fps) == 12
        return
    with pytest.raises(posespace.InvalidArgument) as refusal:
        posespace.save_animation(frames, tmp_path / file, fps=fps)
    assert says in str(refusal.value)
    assert not taken and not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["png", "gif", "webp"])
def test_a_failing_frame_leaves_the_old_file_and_no_other(tmp_path, suffix):
    file = tmp_path / f"disc.{suffix}"
    file.write_bytes(b"mine")

    def failing():
        yield from discs(3)
        raise ZeroDivisionError

    def of_two_sizes():
        yield from discs(3)
        yield from discs(3, size=(80, 60))

    with pytest.raises(ZeroDivisionError):
        posespace.save_animation(failing(), file, fps=FPS)
    with pytest.raises(posespace.InvalidArgument, match=r"frame 3 is \(60, 80, 4\) uint8, not"):
        posespace.save_animation(of_two_sizes(), file, fps=FPS)
    with pytest.raises(posespace.InvalidArgument, match="needs a frame"):
        posespace.save_animation([], file, fps=FPS)
    with pytest.raises(posespace.InvalidArgument, match=r"not \(H, W, 4\) uint8"):
        posespace.save_animation([np.zeros((5, 5, 3), np.uint8)], file, fps=FPS)
    assert file.read_bytes() == b"mine"
    assert list(tmp_path.iterdir()) == [file]
