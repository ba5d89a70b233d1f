// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_FILE_H
#define VCG_FCD_DEFORMATION_FILE_H

#include <vcg_ext/field/deformation_field.h>

#include <string>

/// \file
/// A saved deformation: a binary little-endian PLY file (G. Turk, The PLY polygon file format, 1994) of the surface
/// that the deformation was sampled on, in world coordinates. Any program that reads PLY shows that surface; this one
/// needs no library for it, with or without MeshLab around it.
///
///     vertex   x y z          double  position at rest
///              ux uy uz       double  displacement
///              uxx uxy ... uzz float  its gradient, row by row: uxy is how ux changes along y
///     face     vertex_indices list of 3, equal ones for an edge or a point; a cloud has no faces
///
/// Two comments of the header tell the largest difference from the deformation at a vertex of what was sampled, in
/// world units, and a checksum: CRC-32 (ISO 3309; that of PNG and zip) of the file without the line that tells it, 8
/// hexadecimal digits. (Not one of the faster hashes: the libraries of all languages have this one, so that any program
/// can write and check such files, and it finds whatever changes up to 32 bits in a row.)
///
/// The reader takes what the writer writes and nothing else, so that each bit of it is checked. Files of version 1,
/// which have neither comment, are read, too.

namespace vcg::fcd {

/// The content of the file of a deformation.
std::string DeformationText(const FieldSamples &samples);

/// Reads what DeformationText writes, to the bit. \param name what messages call it
/// \throw BadInput for anything else, naming the place; no number in it is trusted before it has been checked
FieldSamples ReadDeformationText(const std::string &text, const std::string &name);

/// ReadDeformationText of a file. \throw BadInput also when it is not readable
FieldSamples ReadDeformationFile(const std::string &path);

} // namespace vcg::fcd

#endif
