# SPDX-License-Identifier: GPL-3.0-or-later
#
# How both plugins, filter_fcd and edit_fcd, and what they share, are built, also among MeshLab's own plugins
# (tests/pull_request.sh), which lists plugins only: the first one to be configured brings the library.
set(FCD_EXPORTS "${CMAKE_CURRENT_LIST_DIR}/exports.map")
set(FCD_LAYER_FOLDER "${CMAKE_CURRENT_LIST_DIR}")

# fcd_set_up TARGET: what all three have in common.
function(fcd_set_up target)
    if(WIN32)
        target_compile_definitions(${target} PRIVATE NOMINMAX)
    endif()
    if(MSVC)
        target_compile_options(${target} PRIVATE /bigobj)
    endif()
    # Nothing but Qt's two plugin entry points is visible, so that the plugin's copies of vcg templates and the host's stay
    # apart; on Windows and macOS hidden visibility is enough. Its sources are compiled as one, since most of their time goes
    # to what they include.
    set_target_properties(${target} PROPERTIES
        UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0
        CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

function(fcd_set_up_plugin plugin)
    if(NOT TARGET layer_fcd)
        add_subdirectory("${FCD_LAYER_FOLDER}" "${CMAKE_BINARY_DIR}/layer_fcd")
    endif()
    fcd_set_up(${plugin})
    target_link_libraries(${plugin} PRIVATE layer_fcd)
    # (Nothing that Qt's tool reads is made by what the plugin links, so it need not wait for that to be compiled.)
    set_target_properties(${plugin} PROPERTIES
        AUTOMOC ON AUTOGEN_ORIGIN_DEPENDS OFF WINDOWS_EXPORT_ALL_SYMBOLS OFF)
    # What only linkers for ELF know. nodelete: layers may own attributes that were made here, and they outlive an unloaded
    # plugin.
    if(UNIX AND NOT APPLE)
        target_link_options(${plugin} PRIVATE "LINKER:--version-script=${FCD_EXPORTS}" LINKER:-z,nodelete)
        set_property(TARGET ${plugin} PROPERTY LINK_DEPENDS "${FCD_EXPORTS}")
    endif()
endfunction()
