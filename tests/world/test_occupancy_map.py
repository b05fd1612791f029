"""Occupancy maps: what map_server's files mean, and what is said about bad ones."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image
from world_scenes import SHARED

from surefoot.errors import InputError
from surefoot.world import OccupancyMap, read_occupancy_map

GOOD = {
    "image": "room.pgm",
    "resolution": "0.05",
    "origin": "[-1.5, 2.0, 0.25]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
P2 = b"P2\n# made by hand\n3 2\n255\n0 205 254\n255 100 0\n"


def write(folder: Path, picture: bytes = P2, **changes: Any) -> Path:
    keys = {key: value for key, value in {**GOOD, **changes}.items() if value is not None}
    (folder / "room.pgm").write_bytes(picture)
    path = folder / "room.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in keys.items()))
    return path


def save(folder: Path, values: object, kind: str | None = None, **changes: Any) -> OccupancyMap:
    image = Image.fromarray(np.asarray(values))
    (image if kind is None else image.convert(kind)).save(folder / "room.png")
    return read_occupancy_map(write(folder, image="room.png", **changes))


def labels(occupancy: OccupancyMap) -> list[str]:
    assert not (occupancy.occupied & occupancy.unknown).any()
    signs = np.where(occupancy.occupied, "#", np.where(occupancy.unknown, "?", "."))
    return ["".join(row) for row in signs]


def test_plain_and_binary_pgm_are_the_same_map(tmp_path: Path) -> None:
    plain = read_occupancy_map(write(tmp_path))
    assert labels(plain) == ["#?.", ".?#"]
    assert (plain.resolution_m, plain.origin_m, plain.yaw_rad) == (0.05, (-1.5, 2.0), 0.25)
    assert plain.image_path == tmp_path / "room.pgm"
    binary = b"P5 3 2 255\n" + bytes([0, 205, 254, 255, 100, 0])
    assert labels(read_occupancy_map(write(tmp_path, binary))) == labels(plain)


def test_arrays_are_read_only(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="read-only"):
        read_occupancy_map(write(tmp_path)).occupied[0, 0] = False


def test_negate_turns_black_and_white(tmp_path: Path) -> None:
    assert labels(read_occupancy_map(write(tmp_path, negate="true"))) == [".##", "#?."]


def test_thresholds_belong_to_their_side(tmp_path: Path) -> None:
    picture = b"P5 3 1 255\n" + bytes([102, 153, 127])  # p = 0.6, 0.4, 0.50196
    path = write(tmp_path, picture, occupied_thresh="0.6", free_thresh="0.4")
    assert labels(read_occupancy_map(path)) == ["#.?"]


def test_grey_of_a_small_greatest_value_is_scaled(tmp_path: Path) -> None:
    assert labels(read_occupancy_map(write(tmp_path, b"P2 3 1 15 0 12 15\n"))) == ["#?."]


def test_sixteen_bits(tmp_path: Path) -> None:
    picture = b"P5 3 1 65535\n" + struct.pack(">3H", 0, 205 * 257, 65535)
    assert labels(read_occupancy_map(write(tmp_path, picture))) == ["#?."]
    assert labels(save(tmp_path, np.array([[0, 205 * 257, 65535]], np.uint16))) == ["#?."]


def test_colours_count_by_their_mean(tmp_path: Path) -> None:
    colours = np.array([[[255, 0, 0], [255, 255, 90], [255, 255, 255], [0, 0, 0]]], np.uint8)
    assert labels(save(tmp_path, colours)) == ["#?.#"]  # p of red is 2/3


def test_palette_and_one_bit(tmp_path: Path) -> None:
    colours = np.array([[[255, 0, 0], [255, 255, 255]]], np.uint8)
    assert labels(save(tmp_path, colours, "P")) == ["#."]
    assert labels(save(tmp_path, np.array([[0, 255]], np.uint8), "1")) == ["#."]


def test_bmp(tmp_path: Path) -> None:
    Image.fromarray(np.array([[0, 255, 205]], np.uint8)).save(tmp_path / "room.bmp")
    assert labels(read_occupancy_map(write(tmp_path, image="room.bmp"))) == ["#.?"]


def test_alpha_is_a_channel_in_trinary_and_hides_in_scale(tmp_path: Path) -> None:
    grey_alpha = np.array([[[0, 255], [255, 255], [255, 0], [0, 0]]], np.uint8)
    assert labels(save(tmp_path, grey_alpha)) == ["#.?#"]  # p = 0.75, 0, 0.25, 1
    assert labels(save(tmp_path, grey_alpha, mode="scale")) == ["#.??"]


def test_alpha_of_a_palette_hides_in_scale(tmp_path: Path) -> None:
    image = Image.fromarray(np.array([[0, 1, 2]], np.uint8), "L").convert("P")
    image.putpalette([0, 0, 0, 255, 255, 255, 255, 255, 255])
    image.save(tmp_path / "room.png", transparency=2)
    assert labels(read_occupancy_map(write(tmp_path, image="room.png", mode="scale"))) == ["#.?"]


def test_scale_leaves_what_lies_between_unknown(tmp_path: Path) -> None:
    assert labels(read_occupancy_map(write(tmp_path, mode="scale"))) == ["#?.", ".?#"]


def test_raw_values_are_per_cent(tmp_path: Path) -> None:
    picture = b"P5 6 1 255\n" + bytes([0, 19, 20, 65, 100, 101])
    path = write(tmp_path, picture, mode="raw", negate="1")
    assert labels(read_occupancy_map(path)) == ["..?##?"]


def test_plain_picture(tmp_path: Path) -> None:
    path = tmp_path / "room.png"
    Image.fromarray(np.array([[0, 127, 128, 255]], np.uint8)).save(path)
    occupancy = read_occupancy_map(path, 0.1)
    assert labels(occupancy) == ["##.."]
    assert (occupancy.resolution_m, occupancy.origin_m, occupancy.yaw_rad) == (0.1, (0, 0), 0)
    Image.fromarray(np.array([[[0, 0], [255, 255]]], np.uint8)).save(path)
    assert labels(read_occupancy_map(path, 0.1)) == ["?."]


def test_numbers_in_the_notation_that_yaml_takes_for_text(tmp_path: Path) -> None:
    assert read_occupancy_map(write(tmp_path, resolution="5e-2")).resolution_m == 0.05


def test_further_keys_are_ignored(tmp_path: Path) -> None:
    assert labels(read_occupancy_map(write(tmp_path, author="nobody", floor="[1, {2: 3}]")))[0] == "#?."


def test_a_misspelt_mode_is_not_ignored(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'mode' is probably meant") as caught:
        read_occupancy_map(write(tmp_path, mod="raw"))
    assert caught.value.key == "mod"


@pytest.mark.parametrize("key", GOOD)
def test_every_missing_key_is_named_with_those_found(tmp_path: Path, key: str) -> None:
    with pytest.raises(InputError, match=f"the key '{key}' is missing; required are image, .*; found are ") as caught:
        read_occupancy_map(write(tmp_path, P2, **{key: None}))
    assert caught.value.key == key
    assert caught.value.source == tmp_path / "room.yaml"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("image", "3"),
        ("image", "''"),
        ("image", '"a\\0b"'),
        ("resolution", "0"),
        ("resolution", "-0.05"),
        ("resolution", ".nan"),
        ("resolution", ".inf"),
        ("resolution", "coarse"),
        ("resolution", "true"),
        ("origin", "[0, 0]"),
        ("origin", "[0, .nan, 0]"),
        ("origin", "[0, 0, .inf]"),
        ("origin", "[0, [1], 0]"),
        ("origin", "[1e300, 0, 0]"),
        ("origin", "{x: 0}"),
        ("negate", "perhaps"),
        ("occupied_thresh", "1.1"),
        ("free_thresh", "-0.1"),
        ("free_thresh", "0.65"),
        ("mode", "ternary"),
        ("mode", "[raw]"),
    ],
)
def test_a_wrong_value_is_named_with_its_line(tmp_path: Path, key: str, value: str) -> None:
    path = write(tmp_path, P2, **{key: value})
    with pytest.raises(InputError) as caught:
        read_occupancy_map(path)
    line = 1 + [text.split(":")[0] for text in path.read_text().splitlines()].index(key)
    assert (caught.value.key, caught.value.line, caught.value.source) == (key, line, path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "- image\n",
        "just words\n",
        "image: [\n",
        "image: room.pgm\n\tresolution: 1\n",
        "a: !!python/object/apply:os.system [true]\n",
        "a: 2001-99-99\n",
        "[" * 20_000,
        "? [a]\n: b\n",
        "a: &x [*x]\nimage: *x\nresolution: *x\norigin: *x\nnegate: *x\noccupied_thresh: *x\nfree_thresh: *x\n",
        "#" * 1_100_000,
        "\x00",
    ],
)
def test_a_file_that_is_no_map_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "room.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_occupancy_map(path)
    assert caught.value.source == path
    assert "\n" not in str(caught.value)


def test_text_in_another_encoding_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "room.yaml"
    path.write_bytes(b"image: r\xe9\n")
    with pytest.raises(InputError, match="is no valid YAML"):
        read_occupancy_map(path)


def test_nested_aliases_are_refused_quickly(tmp_path: Path) -> None:
    lines = ["l0: &l0 [x, x]"] + [f"l{i}: &l{i} [{', '.join([f'*l{i - 1}'] * 9)}]" for i in range(1, 40)]
    path = write(tmp_path, resolution="*l39")
    path.write_text("\n".join(lines) + "\n" + path.read_text())
    with pytest.raises(InputError, match="not a list"):
        read_occupancy_map(path)


def test_a_missing_map_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read") as caught:
        read_occupancy_map(tmp_path / "nowhere.yaml")
    assert caught.value.source == tmp_path / "nowhere.yaml"


@pytest.mark.parametrize("image", ["nowhere.pgm", ".", "x" * 5000, "/dev/null", '"\\ud800.png"'])
def test_a_missing_picture_is_named(tmp_path: Path, image: str) -> None:
    with pytest.raises(InputError, match="no such picture"):
        read_occupancy_map(write(tmp_path, image=image))


@pytest.mark.parametrize(
    "picture",
    [
        b"",
        b"GIF89a",
        b"P5 3 2",
        b"P5 3 2 255\nab",
        b"P2 3 2 255\n1 2 3",
        b"P2 3 2 255\n1 2 3 4 5 six",
        b"P2 2 1 255\n1 256",
        b"P5 0 3 255\n",
        b"P5 3 2 70000\nabcdef",
        b"Pf\n1 1\n-1.0\n\0\0\0\0",
        b"\x89PNG\r\n\x1a\n",
    ],
)
def test_a_damaged_picture_is_refused(tmp_path: Path, picture: bytes) -> None:
    with pytest.raises(InputError) as caught:
        read_occupancy_map(write(tmp_path, picture))
    assert caught.value.source == tmp_path / "room.pgm"


def test_a_picture_cut_short_is_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    Image.fromarray(rng.integers(0, 255, (80, 80), np.uint8)).save(tmp_path / "whole.png")
    whole = (tmp_path / "whole.png").read_bytes()
    with pytest.raises(InputError, match="damaged or cut short"):
        read_occupancy_map(write(tmp_path, whole[: len(whole) // 2]))


@pytest.mark.parametrize("side", [9_500, 10_001, 40_000, 2_000_000_000])
def test_a_picture_that_is_too_large_is_refused_before_it_is_decoded(tmp_path: Path, side: int) -> None:
    header = struct.pack(">IIBBBBB", side, 2**31 - 1 if side == 2_000_000_000 else 11_000, 8, 0, 0, 0, 0)
    chunk = b"IHDR" + header
    picture = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk))
    picture += struct.pack(">I4s", 0, b"IDAT") + struct.pack(">I", zlib.crc32(b"IDAT"))
    with pytest.raises(InputError, match="at most 100 million pixels"):
        read_occupancy_map(write(tmp_path, picture))


def test_the_resolution_belongs_to_pictures_without_yaml(tmp_path: Path) -> None:
    path = write(tmp_path)
    with pytest.raises(InputError, match="only allowed for a picture without YAML"):
        read_occupancy_map(path, 0.05)
    for wrong in (None, 0.0, float("nan")):
        with pytest.raises(InputError) as caught:
            read_occupancy_map(tmp_path / "room.pgm", wrong)
        assert caught.value.key == "map_resolution_m"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150, deadline=None)
@given(text=st.binary(max_size=60), picture=st.binary(max_size=60), keep=st.booleans())
def test_any_bytes_give_a_map_or_a_sentence(tmp_path: Path, text: bytes, picture: bytes, keep: bool) -> None:
    path = write(tmp_path, (b"P5 3 2 255\n" if keep else b"") + picture)
    path.write_bytes(path.read_bytes() + text)
    problem = ""
    try:
        read_occupancy_map(path)
    except InputError as caught:
        problem = str(caught)
    assert "\n" not in problem


@pytest.mark.skipif(not SHARED.is_dir(), reason="../shared/data is absent")
def test_maps_of_the_field() -> None:
    depot = read_occupancy_map(SHARED / "maps" / "depot.yaml")
    assert depot.occupied.shape == (307, 604)
    assert (int(depot.occupied.sum()), int(depot.unknown.sum())) == (5947, 0)  # 205 is free below 0.25
    sandbox = read_occupancy_map(SHARED / "maps" / "tb3_sandbox.yaml")
    assert (int(sandbox.occupied.sum()), int(sandbox.unknown.sum())) == (870, 138683)
