"""The staff of one metre."""

import math

import pytest
import trimesh
import viser

from app.render.staff import Staff


def test_the_foot_of_the_staff_is_a_disc(server: viser.ViserServer) -> None:
    Staff(server)
    foot = server.scene._handle_from_node_name["/staff/foot"]
    mesh = trimesh.Trimesh(foot.vertices, foot.faces)
    assert mesh.area == pytest.approx(12.0 * math.sin(math.pi / 12.0), rel=1e-5)
    assert (mesh.face_normals[:, 2] > 0.999).all()
