# SPDX-License-Identifier: GPL-3.0-or-later
#
# find_package(fcd) gives fcd::vcg_ext. VCG is not installed with it. Only centroidal_deformation.h, which reads VCG meshes, needs it:
# FCD_VCGLIB names its folder if that is not in the include path. deformer.h, for plain arrays, does without.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Eigen3)
include("${CMAKE_CURRENT_LIST_DIR}/fcdTargets.cmake")
find_path(FCD_VCGLIB vcg/complex/complex.h DOC "vcglib, for what reads VCG meshes")
if(FCD_VCGLIB)
    target_include_directories(fcd::vcg_ext SYSTEM INTERFACE "${FCD_VCGLIB}")
endif()
