# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformations as displacements on a grid, for programs that deform volumes."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from . import _files

GridKind = Literal["modeling", "resampling"]
Axes = Literal["RAS", "LPS"]


@dataclass(frozen=True, eq=False)
class DisplacementGrid:
    """Displacements at the points of a grid, as [Deformation.grid][pymeshlab_fcd.Deformation.grid] makes them. Its points are
    `origin + spacing * (i, j, k)`."""

    displacements: NDArray[np.float64]
    """a x b x c x 3: the displacement of each point, by its numbers along x, y and z."""
    origin: tuple[float, float, float]
    """The first point."""
    spacing: tuple[float, float, float]
    """Distances of neighbouring points along x, y and z."""
    axes: Axes
    """The directions of the axes: `RAS` is right, front and up, `LPS` is left, back and up."""
    kind: GridKind
    """`modeling`: displacements of points at rest. `resampling`: from each point of the resulting volume to where its value is taken."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file, in single precision. An existing one is replaced once all is on the disk; if that fails, it stays.

        Parameters
        ----------
        path : path
            `.nrrd`, for ITK and Slicer: the grid and its vectors in LPS, with its `displacement field type`. `.vti`, for VTK and ParaView: the
            point data `displacement`, in the grid's axes.

        Raises
        ------
        ValueError
            The name has another ending, or the displacements exceed single precision.
        OSError
            It cannot be written, for example since the disk is full.
        """
        ending = os.path.splitext(os.fsdecode(path))[1].lower()
        if ending not in (".nrrd", ".vti"):
            raise ValueError(f"a grid is written as .nrrd or .vti, and not as {ending or 'a file without an ending'}")
        # In both formats, x runs fastest.
        flip = np.array([-1.0, -1.0, 1.0]) if ending == ".nrrd" and self.axes == "RAS" else np.ones(3)
        with np.errstate(over="ignore"):
            data = np.ascontiguousarray((self.displacements * flip).transpose(2, 1, 0, 3), "<f4")
        if not np.isfinite(data).all():
            raise ValueError("the file holds displacements up to 3e38, in single precision, and there are longer ones, or some that are no numbers")
        head = self._nrrd(flip) if ending == ".nrrd" else self._vti(data.nbytes)
        with _files.written([path]) as files:
            files[0].write(head)
            files[0].write(data.tobytes())
            if ending == ".vti":
                files[0].write(b"</AppendedData></VTKFile>\n")

    def _nrrd(self, flip: NDArray[np.float64]) -> bytes:
        def vector(numbers: NDArray[np.float64]) -> str:
            return "(" + ",".join(repr(float(each)) for each in numbers) + ")"

        size = " ".join(map(str, self.displacements.shape[:3]))
        steps = " ".join(map(vector, np.diag(flip * self.spacing)))
        return ("NRRD0005\ntype: float\ndimension: 4\nspace: left-posterior-superior\n"
                f"sizes: 3 {size}\nspace directions: none {steps}\nkinds: vector domain domain domain\nendian: little\nencoding: raw\n"
                f"space origin: {vector(flip * self.origin)}\ndisplacement field type:={self.kind}\n\n").encode()

    def _vti(self, count: int) -> bytes:
        def numbers(of: tuple[float, float, float]) -> str:
            return " ".join(repr(float(each)) for each in of)

        extent = " ".join(f"0 {each - 1}" for each in self.displacements.shape[:3])
        text = ('<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
                f'<ImageData WholeExtent="{extent}" Origin="{numbers(self.origin)}" Spacing="{numbers(self.spacing)}">\n'
                f'<Piece Extent="{extent}"><PointData Vectors="displacement">\n'
                '<DataArray type="Float32" Name="displacement" NumberOfComponents="3" format="appended" offset="0"/>\n'
                '</PointData></Piece></ImageData>\n<AppendedData encoding="raw">_')
        return text.encode() + np.array(count, "<u8").tobytes()

    def __repr__(self) -> str:
        return f"<DisplacementGrid of {' x '.join(map(str, self.displacements.shape[:3]))} points, {self.axes}, {self.kind}>"
