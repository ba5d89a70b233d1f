// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_FILE_H
#define FCD_SESSION_FILE_H

#include "layer_state.h"

#include <QString>

/// \file
/// A session: the state of a layer (layer_state.h) in a file, for another run of the program. CBOR (RFC 8949), a map
/// that any CBOR library reads:
///
///     "format"   "FCD session"
///     "version"  2
///     "sha256"   of the bytes of "layer"
///     "layer"    the bytes of a map, encoded as CBOR:
///       "vertices", "faces"  numbers of live ones; all arrays have a value for each live vertex, in their order
///       "corners"            XXH3 of the live faces' corners, three vertices each, as unsigned 32 bits
///       "position", "normal" of the layer, 3 a vertex
///       "marks"              tags; this and the following only if there are any
///       "rest"               {"own_normals", "position", "normal", "earlier": [{"position", "normal"}, ...]}; if
///                            something else has moved or made vertices since the last pose, also "whereabouts": 0 for
///                            a new vertex, 1 where the pose put it, 2 elsewhere; and "posed": where the pose put it
///       "scan"               {"shown_color", "shown_quality": of the layer now; "colors", "qualities": before it was
///                            tagged, if "color", "quality" say so; "has_color": whether a vertex has the colour of
///                            its tag; "tag": the tag that its quality is, or the least int; and the other fields of
///                            KeptScan}
///       "poses"              a table, as in ReadPoseSequence
///       "tool"               settings of FCD: Bend: {"state": a text, as in bend_state.h; "posed": whether the layer
///                            has the pose of that text, not the shape that the pose begins from; "matrix": of the
///                            layer, column by column}
///       "pairs"              of FCD: Fit: [{"name"; "vertex": its number among the live ones, "place": on the
///                            target, world units, 3; each only if that end is set; "offset": from the vertex to
///                            the landmark at rest, layer units, 3, if it is no vertex}, ...]
///       "fit"                options of FCD: Fit: {"stiffness", "start", "largest_distance", "weights",
///                            "target_weights": as in FitOptions, enumerations by their numbers; "target": name of
///                            the layer that it is fitted to, or ""; "curves": file with curves, or ""; "painted":
///                            weights of the vertices, if there are any; "shown": 1 if the layer has the pose by its
///                            pairs, 2 if it is pulled onto the target, then with "matrix" as above}
///
/// Arrays are typed arrays (RFC 8746), little-endian.

/// The contents of a session, and what loading did.
struct SessionContents {
    bool marks = false, colors = false, rest = false;
    bool tool = false; ///< handles, motions and a line of FCD: Bend
    int earlier = 0;   ///< number of earlier rest shapes
    int poses = 0;
    int pairs = 0;           ///< number of pairs of landmarks of FCD: Fit
    bool fitOptions = false; ///< options of FCD: Fit
    bool fitted = false;     ///< the layer has the shape that FCD: Fit gave it
    std::string unfit;       ///< which of these do not suit the layers of the document; or empty
    int moved = 0;           ///< number of vertices that loading moved
    bool hasMatrix = false;  ///< loading gave the layer the saved matrix
};

/// The contents in words: a list, then what loading changed or left.
std::string describe(const SessionContents &contents);

/// Writes the state of \p layer. \throw vcg::fcd::Error there is none, or the file, then unchanged, cannot be written
SessionContents saveSession(const MeshModel &layer, const QString &file);

/// Reads a file of saveSession: \p layer is then as it was saved. It must have the saved shape, or the saved rest
/// shape, to 1e-6 of its diagonal. Newer colours and quality stay. Motions and fits of the tools are in world
/// coordinates, so a layer without a matrix gets the saved one. \throw vcg::fcd::Error what is wrong with the file, or
/// how the layer differs; it is then as it was
SessionContents loadSession(const MeshDocument &document, MeshModel &layer, const QString &file);

#endif
