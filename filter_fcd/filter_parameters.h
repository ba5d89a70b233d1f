// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FILTER_PARAMETERS_H
#define FCD_FILTER_PARAMETERS_H

#include <layer_fcd/parameters.h> // before Qt

/// \file
/// The parameters of the filters as the host shows them, and the way back.

/// Lengths are relative to the current layer, if there is one.
RichParameterList toRichParameters(const BuildGraphParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const DeformMeshParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const FitMeshParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const StraightenMeshParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const SymmetrizeParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const CompensateLayerParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const SequenceParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const PoseParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const ResetPoseParam &param);
RichParameterList toRichParameters(const CopyParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const SaveDeformationParam &param, const MeshDocument &document);
RichParameterList toRichParameters(const TagParam &param, const MeshDocument &document);
/// Of the filters for scripts that do a part of it: tag the selection, or all by a file.
RichParameterList toRichParameters(const TagParam &param, bool fromFile);
RichParameterList toRichParameters(const SaveTagsParam &param, const MeshDocument &document);
/// The file of a session. \param saves it is written; otherwise, it is read
RichParameterList sessionParameters(bool saves);
/// The same, read. \throw vcg::fcd::Error when it is empty
QString sessionFile(const RichParameterList &list, bool saves);

/// \throw vcg::fcd::Error when a value makes no sense
BuildGraphParam buildGraphParam(const RichParameterList &list);
DeformMeshParam deformMeshParam(const RichParameterList &list, const MeshDocument &document);
FitMeshParam fitMeshParam(const RichParameterList &list, const MeshDocument &document);
StraightenMeshParam straightenMeshParam(const RichParameterList &list, const MeshDocument &document);
SymmetrizeParam symmetrizeParam(const RichParameterList &list);
CompensateLayerParam compensateParam(const RichParameterList &list, const MeshDocument &document);
SequenceParam sequenceParam(const RichParameterList &list, const MeshDocument &document);
PoseParam poseParam(const RichParameterList &given, const MeshDocument &document);
ResetPoseParam resetPoseParam(const RichParameterList &list);
CopyParam copyParam(const RichParameterList &list, const MeshDocument &document);
SaveDeformationParam saveDeformationParam(const RichParameterList &list, const MeshDocument &document);
TagParam tagParam(const RichParameterList &list, const MeshDocument &document);
TagParam tagParam(const RichParameterList &list, bool fromFile);
SaveTagsParam saveTagsParam(const RichParameterList &list, const MeshDocument &document);

/// The parameter that names HandleParam::likeLayer. Older scripts may lack it.
inline constexpr const char *handleLayer = "handle_layer";

#endif
