# SPDX-License-Identifier: GPL-3.0-or-later
#
# Copies to python/third_party what the method needs of others: Eigen but for what is unsupported there. A source distribution then
# builds wherever there is a compiler.
find_package(Eigen3 REQUIRED NO_MODULE)
get_target_property(eigen Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
file(REMOVE_RECURSE "${third_party}")
file(COPY "${eigen}/Eigen" DESTINATION "${third_party}/eigen3" PATTERN CMakeLists.txt EXCLUDE)
message(STATUS "python/third_party has Eigen")
