// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_FILE_H
#define VCG_FCD_DEFORMATION_FILE_H

#include <vcg_ext/field/deformation_field.h>

#include <string>

/// \file
/// A saved deformation: a binary little-endian PLY file (G. Turk, The PLY polygon file format, 1994) of the surface
/// with the samples, in world coordinates. Any program that reads PLY shows that surface.
///
///     vertex   x y z          double  position at rest
///              ux uy uz       double  displacement
///              uxx uxy ... uzz float  its gradient, row by row: uxy is how ux changes along y
///     face     vertex_indices list of 3, repeated for an edge or a point; a cloud has no faces
///
/// The header has two comments. One is the largest error at a vertex of the sampled surface, in world units, or
/// "unknown". The other is a checksum: CRC-32 (ISO 3309, as in PNG and zip) of the file without the checksum's line, 8
/// hexadecimal digits. (All languages have this hash, so any program can write and check such files. It finds every
/// change of up to 32 bits in a row.)
///
/// The reader takes exactly what the writer writes: it checks each bit. It also takes files of version 1, without these
/// comments.

namespace vcg::fcd {

/// The content of the file of a deformation.
std::string DeformationText(const FieldSamples &samples);

/// Reads what DeformationText writes, to the bit. \param name of the file, for messages \throw BadInput for anything
/// else, with the place. Each number is checked before it is used
FieldSamples ReadDeformationText(const std::string &text, const std::string &name);

/// ReadDeformationText of a file. \throw BadInput the same, and if it cannot be read
FieldSamples ReadDeformationFile(const std::string &path);

} // namespace vcg::fcd

#endif
