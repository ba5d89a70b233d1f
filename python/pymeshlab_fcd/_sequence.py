# SPDX-License-Identifier: GPL-3.0-or-later
"""Named poses, and animations of them."""
from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import BinaryIO, Literal, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core, _files, _inputs
from ._deformer import Deformer, Transforms
from ._look import Companion, Look, look_of, other_of
from ._numbers import shown
from ._numbers import text as expected_text
from ._pose import Pose
from ._progress import Progress, report
from ._warnings import ContactWarning, DeformationWarning, FoldWarning, NotAtRestWarning, Told, triangles_turned, warn

EasingName = Literal["linear", "smooth", "hold"]
_EASINGS: tuple[EasingName, ...] = ("linear", "smooth", "hold")


@dataclass(frozen=True)
class KeyFrame:
    """The weights of the poses at one time."""

    time: float
    """Seconds, from 0."""
    weights: Mapping[str, float] = field(default_factory=dict)
    """Percent of each pose, by its name; missing ones have 0."""
    easing: EasingName = "linear"
    """How the weights change to the next key frame: `linear`, `smooth` (3 t^2 - 2 t^3), or `hold`: only there."""


class FrameContact(NamedTuple):
    """A frame in which the surface passes through itself, and did not at rest."""

    time: float
    """Seconds."""
    triangles: int
    """Number of triangles that pass through others."""
    depth: float
    """The largest depth, in units of the vertices."""


@dataclass(frozen=True)
class AnimationInfo:
    """The result of writing an animation."""

    frames: int
    """Number of frames that were written."""
    largest_difference: float
    """With `shapes="poses"`: the largest distance of a vertex, mixed linearly, from the frame; else 0."""
    converged: bool
    """Whether all frames came to rest."""
    jumps: bool
    """Whether the shape jumps between two frames, instead of changing continuously."""
    folded: int
    """Flipped triangles, the most of a frame."""
    contacts: tuple[FrameContact, ...]
    """The frames in which the surface passes through itself. Looked for in surfaces of at most 250 thousand triangles."""
    discretisation_error: float
    """[Pose.discretisation_error][pymeshlab_fcd.Pose.discretisation_error] of the frame with most energy."""


class PoseSequence:
    """Named poses, and key frames of them. A blend adds, each by its weight, the turns of a handle (of any angle), the paths of its middle and
    the logarithms of its scales. Arcs about one joint combine to one arc. [Pose sequences](sequences.md) tells more.

    Parameters
    ----------
    poses : Mapping[str, Union[Transforms, str]]
        The motions of each pose, by its name: `{tag: 4 x 4 matrix or Motion}`, or a text as in the filters' parameter `transforms`.
    keys : Sequence[KeyFrame], optional
        The key frames, ascending in time. None: the poses follow each other smoothly from rest, a second each.

    Raises
    ------
    ValueError
        There is no pose, a name is empty, times do not ascend, or a key frame names a pose that does not exist.
    """

    def __init__(self, poses: Mapping[str, Union[Transforms, str]], keys: Sequence[KeyFrame] | None = None) -> None:
        if not isinstance(poses, Mapping):
            raise TypeError(f"poses must be a mapping, {{name: {{tag: Motion}}}}; it is a {type(poses).__name__}")
        texts = [(expected_text("the name of a pose", str(name)), expected_text("poses", motions) if isinstance(motions, str) else
                  "; ".join(f"{tag}: {text}" for tag, text in _inputs.transforms(motions, None))) for name, motions in poses.items()]
        names = [name for name, _ in texts]
        if keys is None:
            keys = [KeyFrame(i, {} if i == 0 else {names[i - 1]: 100}, "smooth") for i in range(len(names) + 1)]
        told = []
        for key in keys:
            if not isinstance(key, KeyFrame):
                raise TypeError(f"keys must be KeyFrames, as KeyFrame(1, {{'bent': 100}}); there is a {type(key).__name__}")
            told.append((_inputs.number("time", key.time), _inputs.choice("easing", key.easing, _EASINGS), _weights(key.weights, names)))
        self._core = _core.Sequence(texts, told)

    @classmethod
    def parse(cls, text: str, name: str = "poses") -> PoseSequence:
        """Reads the table that [save][pymeshlab_fcd.PoseSequence.save] writes.

        Parameters
        ----------
        text : str
            The table.
        name : str, default 'poses'
            Its name in messages.

        Raises
        ------
        ValueError
            What is wrong, with the line.
        """
        made = cls.__new__(cls)
        made._core = _core.Sequence.parse(expected_text("text", text), shown(expected_text("name", name)))
        return made

    def __reduce__(self) -> tuple[Callable[[str], PoseSequence], tuple[str]]:
        return type(self).parse, (self._core.state(),)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PoseSequence:
        """Reads a file with such a table.

        Parameters
        ----------
        path : path
            The file, `.csv`.

        Raises
        ------
        OSError
            It cannot be read.
        ValueError
            What is wrong in it, with the line.
        """
        with open(os.fspath(path), encoding="utf-8-sig", newline="") as file:  # no number of an open file
            try:
                content = file.read()
            except UnicodeDecodeError as error:
                raise ValueError(f"{shown(path)} is no text in UTF-8 ({error.reason}): save it as such") from error
        return cls.parse(content, shown(path))

    def text(self, deformer: Deformer | None = None) -> str:
        """The table.

        Parameters
        ----------
        deformer : Deformer, optional
            The surface of the poses: using them with another one is then an error. None: any surface.
        """
        return self._core.text(None if deformer is None else _expected(deformer)._prepared)

    def save(self, path: str | os.PathLike[str], deformer: Deformer | None = None) -> None:
        """Writes the table to a file. An existing one is replaced once all is written.

        Parameters
        ----------
        path : path
            The file, `.csv`.
        deformer : Deformer, optional
            As in [text][pymeshlab_fcd.PoseSequence.text].

        Raises
        ------
        OSError
            It cannot be written; an existing one stays.
        """
        _files.write(path, self.text(deformer).encode())

    @property
    def poses(self) -> dict[str, str]:
        """The motions of each pose, by its name, as text for the filters' parameter `transforms`."""
        return dict(self._core.poses())

    @property
    def keys(self) -> list[KeyFrame]:
        """The key frames."""
        return [KeyFrame(time, self._named(weights), _EASINGS[easing]) for time, easing, weights in self._core.keys()]

    def weights_at(self, time: float) -> dict[str, float]:
        """The percentage of each pose at a time.

        Parameters
        ----------
        time : float
            Seconds. Times before the first key frame, or after the last, give that key frame.
        """
        return self._named(self._core.weights_at(_inputs.number("time", time)))

    def _named(self, weights: list[float]) -> dict[str, float]:
        return dict(zip(self.poses, weights))

    def blend(self, deformer: Deformer, weights: Mapping[str, float], *, check: bool = True, progress: Progress = None) -> Pose:
        """Blends the poses, each by its weight, from rest.

        Parameters
        ----------
        deformer : Deformer
            The surface that is posed.
        weights : Mapping[str, float]
            The percentage of each pose, by its name; missing ones have 0.
        check : bool, default True
            Whether to look for flipped triangles, and warn of them.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Raises
        ------
        ValueError
            There is no such pose, one moves a handle that the Deformer does not have, or they are of another surface.

        Warns
        -----
        DeformationWarning
            Flipped triangles, or the shape did not converge.
        """
        checked, share = _inputs.flag("check", check), _weights(weights, list(self.poses))
        sequencer = _core.Sequencer(_expected(deformer)._prepared, self._core)
        pose = self._posed(deformer, sequencer, share, progress)
        warn(_told_of(pose, checked, "The pose"), 2)
        return pose

    def frames(self, deformer: Deformer, *, rate: float = 24.0, check: bool = True) -> Iterator[tuple[float, Pose]]:
        """Yields the frames, each solved from the one before: its time in seconds, and the pose.

        Parameters
        ----------
        deformer : Deformer
            The surface that is posed.
        rate : float, default 24.0
            Frames a second. The last one is at the last key frame, or just after it.
        check : bool, default True
            Whether to look for flipped triangles, and warn of them.

        Raises
        ------
        ValueError
            A pose moves a handle that the Deformer does not have, or they are of another surface.

        Warns
        -----
        DeformationWarning
            Flipped triangles, or a frame did not converge: once for each, at the first such frame.
        """
        checked, times = _inputs.flag("check", check), self._core.times(_inputs.number("rate", rate))
        return self._frames(deformer, _core.Sequencer(_expected(deformer)._prepared, self._core), times, checked)

    def _frames(self, deformer: Deformer, sequencer: _core.Sequencer, times: list[float], check: bool) -> Iterator[tuple[float, Pose]]:
        told: set[type[DeformationWarning]] = set()
        for time in times:
            pose = self._posed(deformer, sequencer, self._core.weights_at(time), None)
            found = [each for each in _told_of(pose, check, f"The frame at {time:g} s") if each[0] not in told]
            told |= {kind for kind, _ in found}
            warn(found, 2)
            yield time, pose

    @staticmethod
    def _posed(deformer: Deformer, sequencer: _core.Sequencer, weights: list[float], progress: Progress) -> Pose:
        pose = Pose(deformer, sequencer.go(weights, report(progress)))
        pose._write(None, None, None)
        return pose

    def write(self, deformer: Deformer, *, gltf: str | os.PathLike[str] | None = None, pc2: str | os.PathLike[str] | None = None,
              mdd: str | os.PathLike[str] | None = None, rate: float = 24.0, shapes: Literal["frames", "poses"] = "frames", colors: ArrayLike | None = None,
              look: Look | None = None, name: str = "surface", others: Sequence[Companion] = (), progress: Progress = None) -> AnimationInfo:
        """Writes the animation, with the same bits as the filter `generate_fcd_pose_sequence`; one frame at a time is in memory. Files
        that are there are replaced together, when all is written; otherwise each is as it was.

        Parameters
        ----------
        deformer : Deformer
            The surface that is posed.
        gltf : path, optional
            A `.glb` file: glTF 2.0 with morph targets (shape keys) and their animation.
        pc2 : path, optional
            A `.pc2` file, a point cache: the positions of all vertices in each frame, in single precision.
        mdd : path, optional
            A `.mdd` file, a point cache of LightWave: the same, with the time of each frame.
        rate : float, default 24.0
            How many frames a second.
        shapes : {'frames', 'poses'}, default 'frames'
            The morph targets: each of the `frames`, or, by its name, each of the `poses`, which are mixed in straight lines.
        colors : array_like, optional
            n x 3 or n x 4: red, green, blue (and opacity) of each vertex, as they are seen (sRGB): whole numbers from 0 to 255, or others
            from 0 to 1. The `.glb` file has them. Short for `look=Look(colors=...)`.
        look : Look, optional
            Colours and textures of the mesh in the `.glb` file.
        name : str, default 'surface'
            What that file calls it.
        others : Sequence[Companion], optional
            Meshes and clouds that go along in the `.glb` file, in the same animation. Each vertex of theirs takes 104 bytes of memory.
        progress : Progress, optional
            Gets percent and stage; see [Progress][pymeshlab_fcd.Progress].

        Raises
        ------
        ValueError
            No file is given, two are one file (also by a link, or by names that differ in case alone), a pose moves a handle that the
            Deformer does not have, they are of another surface, a file would be larger than its format holds, or an array of a look or
            a companion has another shape or is out of range.
        OSError
            A texture cannot be read, or a file cannot be written; those that were there are still there.
        KeyboardInterrupt
            Ctrl-C, at once; nothing is written then.

        Warns
        -----
        DeformationWarning
            Flipped triangles, or a frame did not converge.
        """
        each = _inputs.choice("shapes", shapes, ("frames", "poses"))
        if colors is not None and look is not None:
            raise ValueError("colors and look are both given; give look=Look(colors=...)")
        told = look_of(Look(colors=colors) if look is None else look, name, len(_expected(deformer).vertices), deformer.faces)
        companions = [other_of(other) for other in others]
        paths = {kind: path for kind, path in (("gltf", gltf), ("pc2", pc2), ("mdd", mdd)) if path is not None}
        for one, other in combinations(paths, 2):
            if _files.same_file(paths[one], paths[other]):
                raise ValueError(f"{one} and {other} are the same file; give different files, whose names differ by more than case")
        with _files.written(list(paths.values())) as files:
            to = {kind: _writer(file) for kind, file in zip(paths, files)}
            made = self._core.write(deformer._prepared, _inputs.number("rate", rate), to.get("gltf"), each, to.get("pc2"), to.get("mdd"), told,
                                    companions, report(progress))
            contact = made.pop("contact_text")
            info = AnimationInfo(**{**made, "contacts": tuple(FrameContact(*each) for each in made["contacts"])})
        warn(_words(info.folded, info.converged, "A frame") + ([(ContactWarning, contact)] if contact else []), 2)
        return info

    def __repr__(self) -> str:
        return f"<PoseSequence of {', '.join(self.poses)}, {len(self._core.keys())} key frames>"


def _writer(file: BinaryIO) -> Callable[[int, bytes], None]:
    def put(at: int, data: bytes) -> None:
        file.seek(at)
        file.write(data)

    return put


def _expected(deformer: object) -> Deformer:
    if not isinstance(deformer, Deformer):
        raise TypeError(f"deformer must be a Deformer; it is a {type(deformer).__name__}")
    return deformer


def _told_of(pose: Pose, check: bool, what: str) -> list[Told]:
    return _words(pose._check()["folded"] if check else 0, pose._told["converged"], what)


def _words(folded: int, converged: bool, what: str) -> list[Told]:
    found: list[Told] = []
    if folded > 0:
        found.append((FoldWarning, f"{what} has folds: {triangles_turned(folded)}, where the surface is squeezed or twisted too much. Move the "
                                   "handles less, or leave more free surface between them."))
    if not converged:
        found.append((NotAtRestWarning, f"{what} did not converge: raise max_iterations, or tolerance."))
    return found


def _weights(given: Mapping[str, float], names: list[str]) -> list[float]:
    if not isinstance(given, Mapping):
        raise TypeError(f"weights must be a mapping, {{name of a pose: percent}}; it is a {type(given).__name__}")
    for name in given:
        if name not in names:
            raise ValueError(f"there is no pose {name!r}; the poses are {', '.join(map(repr, names))}")
    return [_inputs.number(f"the weight of {name!r}", given[name]) if name in given else 0.0 for name in names]
