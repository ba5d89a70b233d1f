// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAGS_H
#define FCD_TAGS_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/handles.h>

#include "fcd_layers.h"
#include "fcd_parameters.h"

/// Where a layer keeps its tags.
struct TagTarget {
    QString attribute;    ///< per-vertex scalar attribute; empty: the vertex quality
    bool colorize = true; ///< colour the vertices by tag
};

/// What "FCD: Tag Selection" is asked for.
struct TagSelectionParam {
    enum Role { Fixed, Free, Handle, Outside };

    Role role = Handle;
    int handleNumber = 2; ///< the tag (Handle)
    TagTarget target;

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// What "FCD: Tags from Files" is asked for.
struct TagsFromFilesParam {
    QString tagFile; ///< .sel
    TagTarget target;

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// What "FCD: Save Tags" is asked for.
struct SaveTagsParam {
    HandleParam handles;   ///< not from files, and without files
    QString tagFile;       ///< .sel
    QString transformFile; ///< .def, may be empty

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// The parameters of the filters as the host shows them.
RichParameterList toRichParameters(const TagSelectionParam &param);
RichParameterList toRichParameters(const TagsFromFilesParam &param);
RichParameterList toRichParameters(const SaveTagsParam &param, const MeshDocument &document);

/// The way back. \throw vcg::fcd::Error when a value makes no sense
TagSelectionParam tagSelectionParam(const RichParameterList &list);
TagsFromFilesParam tagsFromFilesParam(const RichParameterList &list);
SaveTagsParam saveTagsParam(const RichParameterList &list, const MeshDocument &document);

/// The tags that \p layer has, one per slot of its vertices; all free where it has none yet. \throw vcg::fcd::Error
/// when what is kept there are no tags
std::vector<int> presentTags(const MeshModel &layer, const TagTarget &target);

/// The colour that shows a tag.
vcg::Color4b colorOfTag(int tag);

/// Gives \p layer the tags, one per slot of its vertices. \throw vcg::fcd::Error before anything is changed
vcg::fcd::TagCount writeTags(MeshModel &layer, const std::vector<int> &tag, const TagTarget &target);

/// Tags the selected vertices, and the vertices of selected faces; the others keep their tags, or are free where the
/// layer has none yet. \throw vcg::fcd::Error, and leaves the layer as it was
vcg::fcd::TagCount tagSelection(MeshModel &layer, const TagSelectionParam &param);

/// Tags all vertices as a file says. \throw vcg::fcd::Error, and leaves the layer as it was
vcg::fcd::TagCount tagFromFiles(MeshModel &layer, const TagsFromFilesParam &param);

/// Writes the tags, and the motions in world coordinates if asked for. \throw vcg::fcd::Error; the files are then as
/// they were
vcg::fcd::TagCount saveTags(const MeshDocument &document, const MeshModel &layer, const SaveTagsParam &param,
                            const Remark &remark);

#endif
