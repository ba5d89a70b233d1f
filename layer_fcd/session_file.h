// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_FILE_H
#define FCD_SESSION_FILE_H

#include "layer_state.h"

#include <QString>

/// \file
/// A session: what is known of a layer (layer_state.h), in a file, for another run of the program. CBOR (RFC 8949), a
/// map that any CBOR library reads:
///
///     "format"   "FCD session"
///     "version"  2
///     "sha256"   of the bytes of "layer"
///     "layer"    the bytes of a map, encoded as CBOR:
///       "vertices", "faces"  how many are live; all arrays have a value for each live vertex, in their order
///       "corners"            XXH3 of the live faces' corners, three vertices each, as unsigned 32 bits
///       "position", "normal" of the layer, 3 a vertex
///       "marks"              tags; only what there is, also of the following
///       "rest"               {"own_normals", "position", "normal", "earlier": [{"position", "normal"}, ...]}
///       "scan"               {"shown_color", "shown_quality": what the layer has; "colors", "qualities": what it had
///                            before it was tagged, where "color", "quality" say so; "has_color":
///                            whether a vertex has that of its tag; "tag": that its quality is, or the least int; and
///                            the other fields of KeptScan}
///       "poses"              a table, as ReadPoseSequence reads it
///       "tool"               what FCD: Bend knows besides: {"state": a text, as bend_text.h tells;
///                            "posed": whether the layer has the pose of that, and not the shape that it begins from;
///                            "matrix": of the layer, column by column}
///       "pairs"              of FCD: Fit: [{"name"; "vertex": its number among the live ones, "place": on the
///                            target, in the world, 3; each only where that end is there}, ...]
///       "fit"                its options: {"stiffness", "start", "largest_distance", "weights", "target_weights": as
///                            FitOptions has them, enumerations by their numbers; "target": name of the layer that
///                            it is fitted to, "curves": file with such, each or ""; "painted": weights of the
///                            vertices, where the layer has them; "shown": 1 or 2 where the layer has the pose by its
///                            pairs, or the one that is pulled onto the target, with "matrix" as the tool has it}
///
/// Arrays are typed arrays (RFC 8746), little-endian.

/// What a session has, or had.
struct SessionContents {
    bool marks = false, colors = false, rest = false;
    bool tool = false; ///< handles, motions and a line, as FCD: Bend knows them
    int earlier = 0;   ///< rest shapes
    int poses = 0;
    int pairs = 0;           ///< of landmarks, as FCD: Fit knows them
    bool fitOptions = false; ///< of that tool
    bool fitted = false;     ///< the layer has the shape that that tool gave it
    std::string unfit;       ///< what of these does not suit the layers of the document; or empty
    int moved = 0;           ///< number of vertices that loading moved
    bool hasMatrix = false;  ///< loading gave the layer the saved matrix
};

/// What that is, in words: a list, and then what loading changed, or left.
std::string describe(const SessionContents &contents);

/// Writes the state that the document keeps of \p layer. \throw vcg::fcd::Error when there is none, or the file cannot
/// be written; an existing file is then unchanged
SessionContents saveSession(const MeshModel &layer, const QString &file);

/// Reads what saveSession has written: \p layer is then as it was saved. It must have the saved shape, or the rest
/// shape, to 1e-6 of its diagonal. Newer colours and quality stay. Motions and fits of the tools are in world
/// coordinates, so a layer without a matrix gets the saved one. \throw vcg::fcd::Error what is wrong with the file, or
/// how the layer differs; it is then as it was
SessionContents loadSession(const MeshDocument &document, MeshModel &layer, const QString &file);

#endif
