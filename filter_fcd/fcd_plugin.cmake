# SPDX-License-Identifier: GPL-3.0-or-later
#
# What both plugins have in common, filter_fcd and edit_fcd beside it: sources that are compiled into each, and how it is built.
find_package(Threads REQUIRED)
find_path(FCD_XXHASH_INCLUDE xxhash.h REQUIRED) # the header of xxHash, which MeshLab does not have

set(FCD_COMMON_SOURCES
    fcd_aside.cpp fcd_aside.h
    fcd_copy.cpp fcd_copy.h
    fcd_deformation_file.cpp fcd_deformation_file.h
    fcd_layers.cpp fcd_layers.h
    fcd_mesh_copy.cpp fcd_mesh_copy.h
    fcd_normals.cpp fcd_normals.h
    fcd_parameters.cpp fcd_parameters.h
    fcd_picked_points.cpp fcd_picked_points.h
    fcd_points.cpp fcd_points.h
    fcd_pose.cpp fcd_pose.h
    fcd_prepared.cpp fcd_prepared.h
    fcd_rest.cpp fcd_rest.h
    fcd_save_files.cpp fcd_save_files.h
    fcd_tags.cpp fcd_tags.h
    fcd_window.cpp fcd_window.h)
list(TRANSFORM FCD_COMMON_SOURCES PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
set(FCD_EXPORTS "${CMAKE_CURRENT_LIST_DIR}/exports.map")

function(fcd_set_up_plugin plugin)
    target_link_libraries(${plugin} PRIVATE Threads::Threads)
    target_include_directories(${plugin} SYSTEM PRIVATE "${FCD_XXHASH_INCLUDE}")
    if(WIN32)
        target_compile_definitions(${plugin} PRIVATE NOMINMAX)
    endif()
    if(MSVC)
        target_compile_options(${plugin} PRIVATE /bigobj)
    endif()
    # Nothing but Qt's two plugin entry points is visible, so that the plugin's copies of vcg templates and the host's stay
    # apart; on Windows and macOS hidden visibility is enough. Its sources are compiled as one, since most of their time goes
    # to what they include.
    set_target_properties(${plugin} PROPERTIES
        UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0
        CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF AUTOMOC ON
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON WINDOWS_EXPORT_ALL_SYMBOLS OFF)
    # What only linkers for ELF know. nodelete: layers may own attributes that were made here, and they outlive an unloaded
    # plugin.
    if(UNIX AND NOT APPLE)
        target_link_options(${plugin} PRIVATE "LINKER:--version-script=${FCD_EXPORTS}" LINKER:-z,nodelete)
        set_property(TARGET ${plugin} PROPERTY LINK_DEPENDS "${FCD_EXPORTS}")
    endif()
endfunction()
