# SPDX-License-Identifier: GPL-3.0-or-later
#
# Copies to python/third_party what the method needs of others: of VCG what base/point_tree.cpp includes, and Eigen but for what is
# unsupported there. A source distribution then builds wherever there is a compiler.
find_package(Eigen3 REQUIRED NO_MODULE)
get_target_property(eigen Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
file(REMOVE_RECURSE "${third_party}")
foreach(header space/index/kdtree/kdtree.h space/index/kdtree/priorityqueue.h space/point3.h space/point4.h space/box3.h
        space/line3.h space/plane3.h math/base.h math/matrix44.h)
    get_filename_component(folder "${header}" DIRECTORY)
    file(COPY "${FCD_VCGLIB}/vcg/${header}" DESTINATION "${third_party}/vcglib/vcg/${folder}")
endforeach()
file(COPY "${FCD_VCGLIB}/LICENSE.txt" DESTINATION "${third_party}/vcglib")
file(COPY "${eigen}/Eigen" DESTINATION "${third_party}/eigen3" PATTERN CMakeLists.txt EXCLUDE)
message(STATUS "python/third_party has VCG's k-d tree and Eigen")
