# SPDX-License-Identifier: Apache-2.0
"""Every kind of drawing people have, and what is said of each; hostile ones are refused by name."""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable

import numpy as np
import posespace
import pytest
from numpy.typing import NDArray
from PIL import Image
from synthetic_drawings import WALK, figure, star

CARD = figure(**WALK["stand"])
LIMITS = ("IMAGE_UNDECODABLE", "IMAGE_TOO_LARGE", "OUTLINE_EMPTY", "OUTLINE_TOO_SMALL")


def on_page(colour: tuple[int, int, int], pixels: NDArray[np.uint8] = CARD) -> Image.Image:
    """The drawing on a page of one colour, opaque all over."""
    page = Image.new("RGBA", (pixels.shape[1], pixels.shape[0]), (*colour, 255))
    page.alpha_composite(Image.fromarray(pixels))
    return page.convert("RGB")


def silhouette(ink: int, page: int) -> Image.Image:
    """The drawing in one grey on a page of another."""
    share = CARD[..., 3] / 255.0
    return Image.fromarray(np.round(page + share * (ink - page)).astype(np.uint8))


def file_of(image: Image.Image, form: str, **options: object) -> bytes:
    file = io.BytesIO()
    image.save(file, format=form, **options)
    return file.getvalue()


def area(ring: NDArray[np.float64]) -> float:
    x, y = ring.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


@pytest.fixture
def reference(session):
    """The outline of the drawing sent as a PNG with alpha."""
    return session.put_shape("reference", image=CARD)


def expect_same_outline(shape: posespace.Shape, reference: posespace.Shape) -> None:
    assert shape.size == reference.size
    ours, theirs = area(shape.outline[0]), area(reference.outline[0])
    assert ours == pytest.approx(theirs, rel=0.02)
    low, high = shape.outline[0].min(axis=0), shape.outline[0].max(axis=0)
    assert np.allclose(low, reference.outline[0].min(axis=0), atol=1.5)
    assert np.allclose(high, reference.outline[0].max(axis=0), atol=1.5)


def test_a_webp_with_alpha_is_the_drawing_that_the_png_is(session, reference):
    for name, options in (("lossless", {"lossless": True}), ("lossy", {"quality": 95})):
        shape = session.put_shape(name, image=file_of(Image.fromarray(CARD), "WEBP", **options))
        expect_same_outline(shape, reference)
        assert not [word for word in shape.warnings if "hole" not in word]


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"subsampling": 0}])
def test_a_jpeg_loses_its_paper_and_says_so(session, reference, options):
    scan = file_of(on_page((250, 246, 238)), "JPEG", quality=92, **options)
    shape = session.put_shape("scan", image=scan)
    expect_same_outline(shape, reference)
    assert any("its paper, of colour (" in word for word in shape.warnings)


def test_a_cmyk_jpeg_keeps_its_look_and_says_so(session, reference):
    shape = session.put_shape("print", image=file_of(on_page((255,) * 3).convert("CMYK"), "JPEG"))
    expect_same_outline(shape, reference)
    assert any("CMYK" in word for word in shape.warnings)


@pytest.mark.parametrize("orientation", range(2, 9))
def test_a_photo_is_turned_upright_and_says_so(session, reference, orientation):
    undo = {
        2: Image.Transpose.FLIP_LEFT_RIGHT, 3: Image.Transpose.ROTATE_180,
        4: Image.Transpose.FLIP_TOP_BOTTOM, 5: Image.Transpose.TRANSPOSE,
        6: Image.Transpose.ROTATE_90, 7: Image.Transpose.TRANSVERSE,
        8: Image.Transpose.ROTATE_270,
    }[orientation]  # fmt: skip
    exif = Image.Exif()
    exif[0x0112] = orientation
    photo = file_of(on_page((255,) * 3).transpose(undo), "JPEG", quality=95, exif=exif)
    shape = session.put_shape("photo", image=photo)
    expect_same_outline(shape, reference)
    assert any(f"EXIF orientation, {orientation}" in word for word in shape.warnings)


@pytest.mark.parametrize(("foreground", "ink", "page"), [("dark", 20, 240), ("light", 230, 15)])
def test_a_silhouette_on_a_plain_background(session, reference, foreground, ink, page):
    picture = silhouette(ink, page)
    shape = session.put_shape("s", image=file_of(picture, "PNG"), foreground=foreground)
    expect_same_outline(shape, reference)
    lighter = "lighter" if foreground == "light" else "darker"
    assert any(f"{lighter} than the background" in word for word in shape.warnings)


def test_a_cut_out_drawing_shows_none_of_its_background(client):
    session = client.create_session()
    page = on_page((255, 0, 255))
    session.put_shape("only", image=file_of(page, "PNG"))
    session.build()
    pixels = session.texture("only").astype(float)
    edge = (pixels[..., 3] > 40) & (pixels[..., 3] < 215)
    assert edge.sum() > 200, "edges are smooth"
    bright_magenta = (pixels[..., 0] > 225) & (pixels[..., 1] < 60) & (pixels[..., 2] > 225)
    assert not (edge & bright_magenta).any()
    assert np.abs(pixels[..., 3] - CARD[..., 3])[CARD[..., 3] == 0].max() == 0
    session.delete()


def test_a_threshold_keeps_a_shadow_out(session, reference):
    pixels = np.asarray(silhouette(0, 255)).copy()
    pixels[235:250, 10:190] = np.minimum(pixels[235:250, 10:190], 150)  # 105 below the page
    for threshold, has_shadow in ((100, True), (110, False)):
        shape = session.put_shape(
            f"t{threshold}", image=file_of(Image.fromarray(pixels), "PNG"),
            foreground="dark", threshold=threshold,
        )  # fmt: skip
        assert (shape.outline[0][:, 0].max() > 185) == has_shadow


# Polygons.


def test_a_ring_that_crosses_itself_is_filled_and_says_where_it_crosses(session):
    angle = 2 * np.pi * np.arange(5) * 2 / 5
    pentagram = 100 + 90 * np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    shape = session.put_shape("pentagram", polygon=pentagram)
    assert area(shape.outline[0]) > 0 and len(shape.outline) == 1
    (said,) = shape.warnings
    assert "edge 0 meets edge 2" in said and "non-zero rule" in said
    session.build()


def test_a_simple_ring_keeps_its_points_exactly(session):
    ring = star() + 1 / 3
    shape = session.put_shape("star", polygon=ring)
    assert np.array_equal(shape.outline[0], ring)
    assert shape.warnings == []


def test_what_is_needless_in_a_ring_is_dropped_and_told(session):
    ring = [(0, 0), (0, 0), (50, 0), (100, 0), (100, 80), (0, 100), (0, 0)]
    shape = session.put_shape("paper", polygon=ring)
    assert len(shape.outline[0]) == 4
    assert [word.split(": ")[1] for word in shape.warnings] == [
        "the first point, repeated at the end, was dropped",
        "1 repeated point was dropped",
        "1 point within a straight run was dropped",
    ]


# Vector drawings.

HEAD = "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' "
KITE = "<path d='M-40,0 L0,-60 L40,0 L0,90 Z' fill='#c33' stroke='#333' stroke-width='4'/>"


def svg_of(content: str, attributes: str = "viewBox='-50 -70 100 170'") -> bytes:
    return f"{HEAD}{attributes}>{content}</svg>".encode()


def test_an_svg_drawing_has_its_outline_in_user_units(session):
    shape = session.put_shape("kite", svg=svg_of(KITE))
    low, high = shape.outline[0].min(axis=0), shape.outline[0].max(axis=0)
    assert np.allclose([low, high], [(-43, -64), (43, 95)], atol=3)
    assert shape.size == (100, 170)
    assert shape.warnings == []
    assert shape.texture.scale > 5


def test_an_svg_drawing_builds_beside_a_picture_and_renders(client, tmp_path):
    session = client.create_session()
    file = tmp_path / "kite.svg"
    file.write_bytes(svg_of(KITE))
    session.put_shape("kite", svg=file)
    session.put_shape("packed", svg=gzip.compress(svg_of(KITE.replace("90", "60"))))
    session.build()
    pixels = session.render(at=session.state().placements["kite"])
    assert (pixels[..., 3] > 250).sum() > 5000
    mesh = session.mesh()
    assert mesh.vertices["kite"][:, 0].min() == pytest.approx(-43, abs=4)
    session.delete()


def test_an_svg_page_loses_its_paper(session):
    page = svg_of("<rect x='-50' y='-70' width='100' height='170' fill='white'/>" + KITE)
    shape = session.put_shape("kite", svg=page)
    assert shape.outline[0][:, 0].max() < 47
    assert any("its paper" in word for word in shape.warnings)


def test_a_dark_svg_drawing_on_a_light_page(session):
    page = svg_of("<rect x='-50' y='-70' width='100' height='170' fill='#eee'/>" + KITE)
    shape = session.put_shape("kite", svg=page, foreground="dark", threshold=60)
    assert shape.outline[0][:, 0].max() < 47


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        (b"", "SHAPE_SOURCE_MISSING"),
        (b"hello", "IMAGE_UNDECODABLE"),
        (svg_of("<rect")[:-8], "IMAGE_UNDECODABLE"),
        (svg_of(""), "OUTLINE_EMPTY"),
        (svg_of(KITE, "viewBox='0 0 1e9 1e9'"), "IMAGE_TOO_LARGE"),
        (gzip.compress(b" " * (33 << 20)), "IMAGE_TOO_LARGE"),
        (gzip.compress(svg_of(KITE))[:-30], "IMAGE_UNDECODABLE"),
    ],
)
def test_a_document_that_is_no_drawing_is_refused_by_name(session, document, reason):
    with pytest.raises(posespace.InvalidDrawing, match="'kite'") as refusal:
        session.put_shape("kite", svg=document)
    assert refusal.value.reason == reason
    assert list(refusal.value.fields) == ["svg.document"]


def test_a_threshold_of_an_svg_is_named_by_its_path(session):
    with pytest.raises(posespace.InvalidArgument) as refusal:
        session.put_shape("kite", svg=svg_of(KITE), threshold=0)
    assert list(refusal.value.fields) == ["svg.threshold"]


def test_two_sources_at_once_are_refused(session):
    with pytest.raises(posespace.InvalidArgument, match="svg"):
        session.put_shape("kite", svg=svg_of(KITE), polygon=star())


# Hostile files.


def small_page() -> Image.Image:
    return on_page((255, 255, 255)).resize((100, 130))


FORMS: dict[str, Callable[[], bytes]] = {
    "png": lambda: file_of(Image.fromarray(CARD), "PNG"),
    "png-palette": lambda: file_of(small_page().quantize(64), "PNG"),
    "png-grey": lambda: file_of(silhouette(0, 255), "PNG"),
    "png-16": lambda: file_of(
        Image.fromarray(np.asarray(silhouette(0, 255), np.uint16) * 257), "PNG"
    ),
    "jpeg": lambda: file_of(small_page(), "JPEG"),
    "jpeg-progressive": lambda: file_of(small_page(), "JPEG", progressive=True),
    "webp": lambda: file_of(Image.fromarray(CARD), "WEBP"),
    "webp-lossless": lambda: file_of(Image.fromarray(CARD), "WEBP", lossless=True),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_file_of_every_form_is_taken(session, form):
    assert session.put_shape("whole", image=FORMS[form]()).outline


@pytest.mark.parametrize("form", FORMS)
def test_a_file_that_is_cut_short_is_refused_by_name(session, form):
    whole = FORMS[form]()
    for length in [*range(20, len(whole), 97), len(whole) - 1]:
        with pytest.raises(posespace.InvalidDrawing, match="'torn'") as refusal:
            session.put_shape("torn", image=whole[:length])
        assert refusal.value.reason == "IMAGE_UNDECODABLE"
        assert list(refusal.value.fields) == ["image.data"]


@pytest.mark.parametrize("form", FORMS)
def test_flipped_bits_never_harm_the_service(client, session, form):
    whole = FORMS[form]()
    random = np.random.default_rng(5)
    for _ in range(60):
        damaged = np.frombuffer(whole, np.uint8).copy()
        damaged[random.integers(0, len(whole), 3)] ^= 1 << random.integers(0, 8, 3, dtype=np.uint8)
        try:
            session.put_shape("flipped", image=damaged.tobytes(), replace=True)
        except posespace.InvalidDrawing as refusal:
            assert refusal.reason in LIMITS, refusal
            assert "'flipped'" in str(refusal)
    client.ping()


@pytest.mark.parametrize("size", [(1, 1), (65535, 1), (1, 65535), (30, 30)])
@pytest.mark.parametrize("colour", [(0, 0, 0, 0), (255, 255, 255, 255)])
def test_pictures_of_one_colour_at_odd_sizes(session, size, colour):
    picture = file_of(Image.new("RGBA", size, colour), "PNG")
    for foreground in ("alpha", "light", "dark"):
        try:
            shape = session.put_shape(foreground, image=picture, foreground=foreground)
            assert any("every pixel is opaque" in word for word in shape.warnings)
        except posespace.InvalidDrawing as refusal:
            assert refusal.reason in LIMITS, refusal


def test_an_animated_webp_is_refused_with_what_to_do(session):
    frames = [Image.fromarray(CARD), Image.fromarray(CARD[:, ::-1])]
    film = file_of(frames[0], "WEBP", save_all=True, append_images=frames[1:])
    with pytest.raises(posespace.InvalidDrawing, match="animation; send one of its frames"):
        session.put_shape("film", image=film)


def test_a_session_that_is_full_refuses_a_picture_by_its_header():
    with (
        posespace.serve_locally(flags=["--max-session-pixels", "60000"]) as server,
        posespace.connect(server.address) as client,
    ):
        session = client.create_session()
        session.put_shape("first", image=CARD)
        torn = file_of(Image.fromarray(CARD), "PNG")[:60]  # the header, and too few bytes for more
        with pytest.raises(posespace.InvalidDrawing, match="at most 8000 are accepted") as refusal:
            session.put_shape("second", image=torn)
        assert refusal.value.reason == "IMAGE_TOO_LARGE"
        session.put_shape("first", image=CARD[:, ::-1], replace=True)
