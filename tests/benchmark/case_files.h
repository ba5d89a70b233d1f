// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CASE_FILES_H
#define FCD_CASE_FILES_H

#include "benchmark_mesh.h"

#include <vcg_ext/handles/handle_file.h>

#include <wrap/io_trimesh/export_off.h>
#include <wrap/io_trimesh/import.h>

/// Meshes and how they are deformed, from and to files.
namespace benchmark {

inline std::string NameOf(const std::string &stem) { return stem.substr(stem.find_last_of('/') + 1); }

/// Reads STEM.off or STEM.ply, STEM.sel and STEM.def. \throw vcg::fcd::Error
inline void ReadCase(const std::string &stem, Mesh &mesh, vcg::fcd::Handles &handles) {
    if (vcg::tri::io::Importer<Mesh>::Open(mesh, (stem + ".off").c_str()) != 0 &&
        vcg::tri::io::Importer<Mesh>::Open(mesh, (stem + ".ply").c_str()) != 0)
        throw vcg::fcd::Error("cannot read '" + stem + "' (.off or .ply)");
    vcg::tri::UpdateBounding<Mesh>::Box(mesh);
    handles.tag = vcg::fcd::ReadTagFile(stem + ".sel");
    const auto transforms = vcg::fcd::ReadTransformFile(stem + ".def");
    for (std::size_t i = 0; i < transforms.size(); ++i)
        handles.motion[vcg::fcd::Index(2 + i)] = vcg::fcd::Motion(transforms[i]);
}

/// Writes a mesh with other positions.
inline void WriteOff(Mesh &mesh, const Eigen::Matrix3Xd &position, const std::string &path) {
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        mesh.vert[i].P() = vcg::Point3d(position(0, i), position(1, i), position(2, i));
    vcg::tri::io::ExporterOFF<Mesh>::Save(mesh, path.c_str());
}

} // namespace benchmark

#endif
