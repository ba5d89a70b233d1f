# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacements on a grid: what they are, and their files as others read them."""
import re

import numpy as np
import pytest
from shapes import bar

from pymeshlab_fcd import Deformer, DisplacementGrid


@pytest.fixture(scope="module")
def ways():
    """There and back."""
    vertices, faces, tags, lift = bar()
    pose = Deformer(vertices, faces, tags).pose({2: lift})
    return pose.deformation(), pose.deformation(inverse=True)


def read_nrrd(path):
    """Position in LPS and displacement of each point, and what kind it is: a few lines of the format."""
    head, data = path.read_bytes().split(b"\n\n", 1)
    told = dict(re.findall(r"^([\w ]+):=? ?(.*)$", head.decode(), re.M))
    assert told["type"] == "float" and told["space"] == "left-posterior-superior" and told["kinds"] == "vector domain domain domain"
    three, *sizes = map(int, told["sizes"].split())
    none, *steps = told["space directions"].split()
    steps = np.array([eval(each) for each in steps])
    values = np.frombuffer(data, "<f4").reshape(3, *sizes, order="F")
    assert (three, none) == (3, "none")
    index = np.stack(np.meshgrid(*map(np.arange, sizes), indexing="ij"), 3)
    return np.array(eval(told["space origin"])) + index @ steps, np.moveaxis(values, 0, 3), told["displacement field type"]


@pytest.mark.parametrize("axes", ["LPS", "RAS"])
@pytest.mark.parametrize("back", [False, True])
def test_a_grid_carries_its_points_as_the_deformation_does(ways, tmp_path, axes, back):
    way = ways[back]
    grid = way.grid([0.5, 0.25, 0.3], axes=axes, kind="resampling" if back else "modeling")
    i = (3, 2, 1)
    point = np.array(grid.origin) + np.array(grid.spacing) * i
    assert abs(point + grid.displacements[i] - way([point])[0]).max() < 1e-12 and abs(grid.displacements).max() > 3 and grid.displacements.shape[2] > 1
    samples = way.samples
    last = np.array(grid.origin) + np.array(grid.spacing) * (np.array(grid.displacements.shape[:3]) - 1)
    assert (np.array(grid.origin) < samples.min(0)).all() and (last >= samples.max(0)).all()

    grid.save(tmp_path / "field.nrrd")
    places, displacements, kind = read_nrrd(tmp_path / "field.nrrd")
    flip = np.array([-1, -1, 1.0]) if axes == "RAS" else np.ones(3)
    own = (places * flip).reshape(-1, 3)
    assert abs(own + displacements.reshape(-1, 3) * flip - way(own)).max() < 2e-6 and kind == grid.kind
    grid.save(tmp_path / "field.vti")
    text, data = (tmp_path / "field.vti").read_bytes().split(b'encoding="raw">_', 1)
    shape = [int(each) + 1 for each in re.search(rb'WholeExtent="0 (\d+) 0 (\d+) 0 (\d+)"', text).groups()]
    assert np.frombuffer(data[:8], "<u8")[0] == 12 * np.prod(shape) and data[8 + 12 * np.prod(shape):].strip() == b"</AppendedData></VTKFile>"
    vectors = np.moveaxis(np.frombuffer(data[8:8 + 12 * np.prod(shape)], "<f4").reshape(3, *shape, order="F"), 0, 3)
    assert abs(vectors - grid.displacements).max() < 1e-6 and list(grid.displacements.shape[:3]) == shape
    assert repr(grid) == f"<DisplacementGrid of {' x '.join(map(str, shape))} points, {axes}, {grid.kind}>"


def test_vtk_reads_a_grid(ways, tmp_path):
    io = pytest.importorskip("vtkmodules.vtkIOXML", reason="VTK is not installed")
    convert = pytest.importorskip("vtkmodules.util.numpy_support", reason="VTK is not installed")
    grid = ways[0].grid(0.5)
    grid.save(tmp_path / "field.vti")
    reader = io.vtkXMLImageDataReader()
    reader.SetFileName(str(tmp_path / "field.vti"))
    reader.Update()
    image = reader.GetOutput()
    vectors = convert.vtk_to_numpy(image.GetPointData().GetVectors())
    points = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
    assert len(points) == grid.displacements[..., 0].size and abs(points + vectors - ways[0](points)).max() < 2e-6


@pytest.mark.parametrize("axes", ["LPS", "RAS"])
@pytest.mark.parametrize("back", [False, True])
def test_itk_carries_points_by_a_grid(ways, tmp_path, axes, back):
    itk = pytest.importorskip("SimpleITK", reason="SimpleITK is not installed")
    grid = ways[back].grid(0.25, axes=axes, kind="resampling" if back else "modeling")
    grid.save(tmp_path / "field.nrrd")
    image = itk.ReadImage(str(tmp_path / "field.nrrd"), itk.sitkVectorFloat64)
    assert image.GetMetaData("displacement field type") == grid.kind and image.GetSize() == grid.displacements.shape[:3]
    field = itk.DisplacementFieldTransform(image)
    inside = np.argwhere(np.ones(np.array(grid.displacements.shape[:3]) - 2)) + 1  # beyond the outermost points, ITK moves nothing
    points = np.array(grid.origin) + 0.25 * inside
    flip = np.array([-1, -1, 1.0]) if axes == "RAS" else np.ones(3)
    moved = np.array([field.TransformPoint(tuple(map(float, point * flip))) for point in points]) * flip
    assert len(points) > 300 and abs(moved - ways[back](points)).max() < 1e-5 and abs(moved - points).max() > 3


def test_a_grid_covers_a_box_and_says_what_is_wrong(ways, tmp_path):
    grid = ways[0].grid(0.1, low=[0, 0, 0], high=[1, 0.5, 0.3])
    assert grid.displacements.shape == (11, 6, 4, 3) and grid.origin == (0, 0, 0) and grid.axes == "LPS"
    assert (grid.displacements[0, 0, 0] == 0).all()  # there it is fixed
    for given, message in (({"spacing": 0}, "above 0"), ({"spacing": [1, 2]}, "three"), ({"spacing": 1e-5}, "500 million"),
                           ({"spacing": 1, "low": [1, 1, 1], "high": [0, 2, 2]}, "low must not be above"),
                           ({"spacing": np.nan}, "finite"), ({"spacing": 1, "axes": "LAS"}, "axes must be one of"),
                           ({"spacing": 1, "kind": "both"}, "kind must be one of"),
                           ({"spacing": 1, "low": [0, 0]}, "low must be 3 numbers; it is 2 of int64"), ({"spacing": 1, "high": [1, np.inf, 1]}, "high must be finite")):
        with pytest.raises(ValueError, match=message):
            ways[0].grid(**given)
    with pytest.raises(ValueError, match="and not as .mha"):
        grid.save(tmp_path / "field.mha")
    for odd in (1e39, np.nan):
        with pytest.raises(ValueError, match="the file holds displacements up to 3e38, in single precision"):
            DisplacementGrid(np.full((2, 2, 2, 3), odd), (0, 0, 0), (1, 1, 1), "LPS", "modeling").save(tmp_path / "field.vti")
    assert not list(tmp_path.iterdir())
