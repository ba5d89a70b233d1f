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
/// Two comments of the header give the largest difference from the deformation at a vertex of the surface that was
/// sampled, in world units ("unknown" if it is), and a checksum: CRC-32 (ISO 3309, as of PNG and zip) of the file
/// without the checksum's line, 8 hexadecimal digits. (Faster hashes exist. But all languages have this one, so any
/// program can write and check such files, and it finds every change of up to 32 bits in a row.)
///
/// The reader takes exactly what the writer writes, so that each bit is checked, and files of version 1, which have
/// neither comment.

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
