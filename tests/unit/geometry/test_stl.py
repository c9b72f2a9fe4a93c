"""Reading, mending, and refusing triangle meshes."""

import numpy as np
import pytest

from flowgmo.geometry import Component, GeometryError, Limits, Piece, mesh_from, read_stl

CUBE = Component([Piece(limits=Limits((0, 1), (0, 1), (0, 1)))]).triangles()


def cube():
    vertices, faces = CUBE
    return vertices[faces]


def write_binary(path, corners, header=b"solid but binary", count=None, cut=0):
    record = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = corners
    data = header.ljust(80) + np.uint32(len(corners) if count is None else count).tobytes() + record.tobytes()
    path.write_bytes(data[: len(data) - cut])
    return path


def write_text(path, corners, end="endsolid cube\n"):
    lines = ["solid cube"]
    for triangle in corners:
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x:.9e} {y:.9e} {z:.9e}" for x, y, z in triangle]
        lines += ["    endloop", "  endfacet"]
    path.write_text("\n".join(lines) + "\n" + end)
    return path


@pytest.mark.parametrize("write", [write_binary, write_text])
def test_both_formats(tmp_path, write):
    mesh = read_stl(write(tmp_path / "cube.stl", cube()))
    assert (len(mesh.vertices), len(mesh.faces), mesh.notices) == (8, 12, ())
    found = Component([Piece(stl=mesh)]).mass_properties(2.0)
    np.testing.assert_allclose(found.mass, 2, rtol=1e-6)
    np.testing.assert_allclose(found.inertia, np.eye(3) / 3, atol=1e-6)


def test_flipped_facet_is_mended():
    corners = cube()
    corners[4] = corners[4][::-1]
    mesh = mesh_from(corners)
    assert len(mesh.notices) == 1 and "turned facet 5 around" in mesh.notices[0]
    np.testing.assert_allclose(Component([Piece(stl=mesh)]).mass_properties(1).volume, 1)


def test_inside_out_mesh_is_turned():
    mesh = mesh_from(cube()[:, ::-1])
    assert "(12 in all)" in mesh.notices[0]
    np.testing.assert_allclose(Component([Piece(stl=mesh)]).mass_properties(1).volume, 1)


def test_cavity_points_the_other_way():
    """A cube within a cube is a hole, whatever way its facets turn."""
    for inner in (cube() / 2 + 0.25, cube()[:, ::-1] / 2 + 0.25):
        body = Component([Piece(stl=mesh_from(np.vstack([cube(), inner])))])
        np.testing.assert_allclose(body.mass_properties(1).volume, 1 - 1 / 8)
        assert not body.inside(np.full((1, 3), 0.5))[0] and body.inside(np.full((1, 3), 0.1))[0]


def test_degenerate_and_repeated_facets_are_removed():
    corners = cube()
    point = corners[0, [0, 0, 1]]
    mesh = mesh_from(np.vstack([corners, point[None], corners[3:4]]))
    assert len(mesh.faces) == 12
    assert "facet 13 without area" in mesh.notices[0] and "facet 14 given twice" in mesh.notices[1]


def test_missing_facet_is_refused_by_number(tmp_path):
    path = write_binary(tmp_path / "open.stl", np.delete(cube(), 11, axis=0))
    with pytest.raises(
        GeometryError, match=r"open\.stl: the surface is not closed: 3 open edges.* at facets \d+, \d+, \d+$"
    ):
        read_stl(path)


def test_long_lists_are_cut():
    with pytest.raises(GeometryError, match=r"(\d+, ){10}\.\.\. \(24 in all\)"):
        mesh_from(np.vstack([cube() + 3 * k for k in range(24)])[np.arange(288) % 12 != 0][:, :, :][:264:11])


def test_crowded_edge_is_refused():
    fin = np.array([[[0, 0, 0], [1, 0, 0], [0.5, -1, -1]]])
    with pytest.raises(GeometryError, match="not closed"):
        mesh_from(np.vstack([cube(), fin]))


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda p: p, "no such file"),
        (lambda p: (p.write_bytes(b""), p)[1], "empty"),
        (lambda p: (p.write_bytes(b"hello"), p)[1], "neither"),
        (lambda p: (p.write_bytes(bytes(range(256))), p)[1], "need"),
        (lambda p: (p.write_text("solid x\nendsolid x\n"), p)[1], "no triangles"),
        (lambda p: write_binary(p, cube()[:0]), "no triangles"),
        (lambda p: write_binary(p, cube(), cut=70), "truncated: 12 triangles need 684 bytes, it has 614"),
        (lambda p: write_binary(p, cube(), count=11), "too long"),
        (lambda p: write_text(p, cube(), end=""), "incomplete"),
        (
            lambda p: (write_text(p, cube()), p.write_text(p.read_text().replace("vertex", "vertx", 1)), p)[2],
            "incomplete",
        ),
        (lambda p: (write_text(p, cube()), p.write_text(p.read_text().replace("1.0", "one", 1)), p)[2], "understood"),
        (
            lambda p: write_binary(p, np.where(np.arange(108).reshape(12, 3, 3) == 40, np.nan, cube())),
            "facet 5 .*finite",
        ),
        (lambda p: write_binary(p, np.zeros((12, 3, 3))), "same point"),
        (lambda p: (p.mkdir(), p)[1], "cannot be read"),
    ],
)
def test_damaged_files_are_refused(tmp_path, capfd, make, reason):
    """Only GeometryError comes out, naming the file; nothing is printed."""
    path = make(tmp_path / "bad.stl")
    with pytest.raises(GeometryError, match=rf"(?s)bad\.stl.*{reason}"):
        read_stl(path)
    assert capfd.readouterr() == ("", "")


def test_any_cut_of_a_file_is_refused(tmp_path):
    """Every length of a truncated file, both formats: GeometryError, nothing else."""
    for write, step in ((write_binary, 23), (write_text, 97)):
        data = write(tmp_path / "whole.stl", cube()).read_bytes()
        for length in range(0, len(data) - 20, step):
            path = tmp_path / "cut.stl"
            path.write_bytes(data[:length])
            with pytest.raises(GeometryError):
                read_stl(path)
