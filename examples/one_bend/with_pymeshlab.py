import pymeshlab

pymeshlab.load_plugin('build/plugins/pymeshlab-2025.7/libfilter_fcd.so')
ms = pymeshlab.MeshSet()
ms.load_new_mesh('meshes/cylinder.ply')
ms.apply_filter('generate_fcd_deformed_mesh', handles='Files', tag_file='meshes/cylinder.sel',
                transforms='2: rotate 0 1 0 90 about 0 0 12 translate 4 0 -3')
ms.save_current_mesh('bent_pymeshlab.ply')
