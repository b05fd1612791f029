"""Robots read from URDF and SDF files: where their links are, and files that are refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from own_robot import go2_urdf, write_go2

from surefoot.errors import InputError
from surefoot.robots import quadruped
from surefoot.robots.legs import JOINTS, legs
from surefoot.robots.quadruped import FEET
from surefoot.viewer.robots.files import read_robot
from surefoot.viewer.robots.mesh_files import parts_of

SDF = """<sdf version="1.6"><model name="arm">
  <link name="a"><pose>0 0 1 0 0 0</pose><visual name="v"><pose>0 0 0.5 0 0 0</pose>
    <geometry><box><size>0.1 0.1 0.2</size></box></geometry></visual></link>
  <link name="b"><pose>1 0 1 0 0 1.5707963</pose></link>
  <link name="c"><pose>1 1 1 0 0 0</pose></link>
  <joint name="ab" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="bc" type="revolute"><parent>b</parent><child>c</child><axis><xyz>0 0 2</xyz></axis></joint>
  <joint name="loop" type="revolute"><parent>a</parent><child>c</child><axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>"""


def test_the_links_of_a_urdf_are_where_the_legs_in_closed_form_have_them(tmp_path: Path) -> None:
    model, leg = read_robot(write_go2(tmp_path), tmp_path), legs(quadruped("go2"))
    angles = np.random.default_rng(3).uniform(leg.limits_rad[..., 0], leg.limits_rad[..., 1], (50, 4, 3))
    poses = model.link_poses({name: angles.reshape(50, 12)[:, k] for k, name in enumerate(JOINTS)})
    for number, name in enumerate(FEET):
        assert poses[f"{name}_foot"][:, :3, 3] == pytest.approx(leg.feet_m(angles)[:, number], abs=1e-12)
    assert (model.root, len(model.joints), len(model.visuals)) == ("base", 20, 13)


def test_meshes_are_scaled_and_coloured_and_simplified(tmp_path: Path) -> None:
    parts = parts_of(read_robot(write_go2(tmp_path), tmp_path))
    trunk = next(part for part in parts if part.link == "base")
    assert trunk.rgb == pytest.approx((0.8, 0.3, 0.1))
    assert np.ptp(trunk.vertices_m, axis=0) == pytest.approx([0.4, 0.1, 0.1])
    foot = next(part for part in parts if part.link == "FL_foot")
    assert foot.vertices_m.max() == pytest.approx(0.02)
    assert foot.faces.shape == (4, 3)


def test_the_faces_of_a_mirrored_mesh_look_outwards(tmp_path: Path) -> None:
    path = write_go2(tmp_path)
    path.write_text(path.read_text().replace('scale="2 2 2"', 'scale="2 2 -2"', 1))
    volumes = [
        np.einsum("fi,fi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
        for part in parts_of(read_robot(path, tmp_path))
        if part.link.endswith("foot")
        for corners in [part.vertices_m[part.faces]]
    ]
    assert len(volumes) == 4
    assert min(volumes) > 0


def test_poses_in_an_sdf_are_those_of_the_model_and_loops_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "arm.sdf").write_text(SDF)
    model = read_robot(tmp_path / "arm.sdf", tmp_path)
    assert (model.root, [joint.name for joint in model.joints]) == ("a", ["ab", "bc"])
    still = model.link_poses({"ab": np.zeros(1)})
    assert still["c"][0, :3, 3] == pytest.approx([1.0, 1.0, 0.0])
    turned = model.link_poses({"ab": np.array([np.pi / 2])})
    assert turned["c"][0, :3, 3] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)
    assert parts_of(model)[0].vertices_m[:, 2].max() == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda text: "<!DOCTYPE a [<!ENTITY b 'c'>]>" + text, "declares XML entities"),
        (lambda text: text[:-9], "is no XML"),
        (lambda text: text.replace("package://example-robot-data", "package://.."), "is outside of"),
        (lambda text: text.replace('<parent link="base"/>', "", 1), "has no <parent>"),
        (lambda text: text.replace('axis xyz="1 0 0"', 'axis xyz="1 0 nan"', 1), "are not 3 numbers"),
        (lambda text: text.replace("<box", "<torus", 1), "looks like neither a mesh nor a box"),
    ],
)
def test_what_is_no_robot_is_refused_in_one_sentence(
    change: Callable[[str], str], complaint: str, tmp_path: Path
) -> None:
    path = tmp_path / "bad.urdf"
    path.write_text(change(go2_urdf()))
    with pytest.raises(InputError, match=complaint) as refused:
        read_robot(path, tmp_path)
    assert "bad.urdf" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_mesh_that_is_none_is_refused(tmp_path: Path) -> None:
    path = write_go2(tmp_path)
    (tmp_path / "example-robot-data" / "tip.stl").write_bytes(b"solid nothing")
    with pytest.raises(InputError, match="holds no triangles"):
        parts_of(read_robot(path, tmp_path))
