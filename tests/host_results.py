# SPDX-License-Identifier: GPL-3.0-or-later
"""What other filters leave of the results of filters, inside pymeshlab. FCD_PLUGIN names the libfilter_fcd.so of this pymeshlab."""
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

from host_pose import CHANGES, duplicate, without
from host_pymeshlab import COPY, DEFORM, RESET, clean_bone, same_points, set_quality
from host_straighten import line_file

FIT, SAVE = "generate_fcd_fitted_mesh", "save_fcd_deformation"
FEW = {"samples": 300, "initial_patches": 60}


def bone():
    ms = clean_bone()
    set_quality(ms, "0")
    return ms


def fitted(folder):
    """Half of the bone has a counterpart: the quality is 1 there, else 0."""
    ms = bone()
    points, faces = ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()
    ms.add_mesh(pymeshlab.Mesh(points + [0, 0, 0.02], faces[(points[faces][:, :, 0] < 0.5).all(1)]), "target")
    ms.apply_filter("meshing_remove_unreferenced_vertices")
    target = ms.current_mesh_id()
    ms.set_current_mesh(0)
    ms.apply_filter(FIT, target_layer=target, largest_distance=0.05, fit_quality=2, **FEW)
    return ms


def symmetrized(folder):
    ms = bone()
    ms.apply_filter("generate_fcd_symmetrized_mesh", symmetrized_quality=3, largest_distance=0.01, **FEW)
    return ms


def straightened(folder):
    ms = bone()
    box = ms.current_mesh().bounding_box()
    line = np.linspace(box.min(), box.max(), 9)
    line[:, 1:] = line[:, 1:].mean(0)
    ms.apply_filter("generate_fcd_straightened_mesh", line_file=line_file(folder / "line.csv", line), to=1, angle=20, initial_patches=60, straightened_quality=1)
    return ms


def compensated(folder):
    ms = bone()
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix() * [1.01, 1, 1], mesh.face_matrix()), "scan")
    scan = ms.current_mesh_id()
    ms.set_current_mesh(0)
    ms.apply_filter("generate_fcd_compensated_mesh", scan_layer=scan, samples=1000, degree=2)
    return ms


def tagged_bone():
    ms = bone()
    for condition, role in (("x < 0.25", 0), ("x > 0.75", 2)):
        ms.compute_selection_by_condition_per_vertex(condselect=condition)
        ms.apply_filter("compute_fcd_tags_from_selection", role=role)
    return ms


def test_new_vertices_that_nobody_has_tagged_are_told(tmp_path, capfd):
    """Subdivision by Loop's rule gives new vertices the quality 0, which is a tag: of a tagged layer, and of its result. (pymeshlab logs
    nothing after an error, hence this comes first.)"""
    for refine, times, is_told in (("loop", 0, True), ("midpoint", 0, False), ("loop", 2, True), ("midpoint", 1, False)):
        ms = tagged_bone()
        for _ in range(times):
            ms.apply_filter(DEFORM, graph_layers=False, initial_patches=60, translation=np.array([0, 0, 0.01]))
        before = ms.current_mesh().vertex_number()
        ms.apply_filter(f"meshing_surface_subdivision_{refine}", iterations=1)
        new = ms.current_mesh().vertex_number() - before
        if not is_told:
            set_quality(ms, "rint(q)")
        ms.set_verbosity(True)
        capfd.readouterr()
        ms.apply_filter(DEFORM, graph_layers=False, initial_patches=60, translation=np.array([0, 0, 0.1]))
        log = capfd.readouterr().err
        since = "'bone deformed 2' was made" if times else "'bone.ply' was tagged"
        assert (f"{new} vertices are new since {since}, and fixed" in log) == is_told, log


def fixed_again(ms):
    """How many vertices of the current layer the next fit takes for fixed ones."""
    current = ms.current_mesh_id()
    mesh = ms.current_mesh()
    ms.add_mesh(pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix()), "target")
    target = ms.current_mesh_id()
    ms.set_current_mesh(current)
    return ms.apply_filter(FIT, target_layer=target, graph_layers=False, **FEW)["fixed_vertices"]


def table():
    page = (Path(__file__).resolve().parents[1] / "docs" / "layers-changed.md").read_text(encoding="utf-8")
    rows = page[page.index("| changed | does the next fit"):].split("\n\n")[0].splitlines()[2:]
    return {row[0]: row[1:] for row in ([cell.strip() for cell in line.strip("|").split("|")] for line in rows)}


def is_moved(ms, change):
    rest = bone().current_mesh().vertex_matrix()
    return "merged" != change and not same_points(ms.mesh(0).vertex_matrix(), rest)


@pytest.mark.parametrize("change", CHANGES)
def test_what_becomes_of_a_result(tmp_path, change):
    assert list(table()) == list(CHANGES)
    ms = fitted(tmp_path)
    CHANGES[change](ms)
    found = ["yes" if fixed_again(ms) > 0 else "no"]
    ms.set_current_mesh(0)
    CHANGES[change](ms)
    try:
        ms.apply_filter(SAVE, deformation_file=str(tmp_path / "d.ply"))
        found.append("saves it as it was" if is_moved(ms, change) else "saves it")
    except pymeshlab.PyMeshLabException as error:
        assert "was changed since" in str(error)
        found.append("refuses")
    assert found == table()[change]


def split(ms):
    ms.compute_selection_by_condition_per_face(condselect="x0 > 0.3")
    ms.apply_filter("generate_from_selected_faces")


def copy_alone(ms):
    duplicate(ms)
    copy = ms.current_mesh_id()
    ms.set_current_mesh(copy - 1)
    ms.delete_current_mesh()
    ms.set_current_mesh(copy)


def moved_and_copied(ms):
    CHANGES["some moved"](ms)
    duplicate(ms)


def moved_and_copied_alone(ms):
    CHANGES["some moved"](ms)
    copy_alone(ms)


def moved_copied_and_moved(ms):
    moved_and_copied(ms)
    copy = ms.current_mesh_id()
    ms.set_current_mesh(copy - 1)
    CHANGES["all moved alike"](ms)
    ms.set_current_mesh(copy)


@pytest.mark.parametrize("change, result", [(split, fitted), (copy_alone, fitted), (moved_and_copied, fitted), (moved_and_copied_alone, fitted),
                                            (moved_copied_and_moved, fitted), (split, symmetrized), (copy_alone, symmetrized), (moved_and_copied, symmetrized)])
def test_parts_and_copies_of_a_result_know_that_it_was_measured(tmp_path, change, result):
    ms = result(tmp_path)
    change(ms)
    assert set(ms.current_mesh().vertex_scalar_array()) == {0, 1}
    assert fixed_again(ms) == 0
    set_quality(ms, "vi < 100 ? 0 : 1")
    assert fixed_again(ms) == 100, "new tags are tags"


@pytest.mark.parametrize("result", [fitted, symmetrized, straightened, compensated])
def test_a_result_has_no_pose_and_its_own_deformation(tmp_path, result):
    ms = result(tmp_path)
    with pytest.raises(pymeshlab.PyMeshLabException, match="has not been posed in place"):
        ms.apply_filter(RESET)
    if result is not compensated:  # which has no graph
        ms.apply_filter(SAVE, deformation_file=str(tmp_path / "before.ply"))
        without(ms, "vi < 50")
        CHANGES["some moved"](ms)
        ms.apply_filter(SAVE, deformation_file=str(tmp_path / "after.ply"))
        assert (tmp_path / "before.ply").read_bytes() == (tmp_path / "after.ply").read_bytes()


@pytest.mark.parametrize("change", ["some moved", "all moved alike", "frozen matrix"])
def test_a_deformation_is_saved_as_it_was_whatever_has_moved_its_source(tmp_path, capfd, change):
    """To the bit, in the place where the source lay then."""
    files = []
    for moved in False, True:
        ms = tagged_bone()
        ms.apply_filter("compute_matrix_from_translation_rotation_scale", translationx=2.0, rotationz=30.0, freeze=False)
        ms.apply_filter(DEFORM, initial_patches=60, translation=np.array([0, 0, 0.1]))
        graph = dict(source_layer=0, rest_graph=1, deformed_graph=2)
        ms.set_current_mesh(0)
        if moved:
            CHANGES[change](ms)
        ms.set_verbosity(True)
        capfd.readouterr()
        files.append(tmp_path / f"{moved}.ply")
        ms.apply_filter(SAVE, deformation_file=str(files[-1]), **graph)
        assert ("has moved 'bone.ply' since it was deformed" in capfd.readouterr().err) == moved
    with pytest.raises(pymeshlab.PyMeshLabException, match="It was only moved: 'FCD: Save Deformation'"):
        ms.apply_filter(COPY, **graph)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_the_deformation_of_another_layer_is_not_taken(tmp_path):
    """Of one with the same faces, say."""
    ms = tagged_bone()
    ms.apply_filter(DEFORM, initial_patches=60, translation=np.array([0, 0, 0.1]))
    duplicate(ms)
    with pytest.raises(pymeshlab.PyMeshLabException, match="was changed since"):
        ms.apply_filter(SAVE, source_layer=ms.current_mesh_id(), rest_graph=1, deformed_graph=2, deformation_file=str(tmp_path / "d.ply"))
