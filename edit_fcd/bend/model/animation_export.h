// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ANIMATION_EXPORT_H
#define FCD_BEND_ANIMATION_EXPORT_H

#include <vcg_ext/sequence/sequence_frames.h> // before Qt

#include <QString>

/// How an animation is exported.
struct AnimationExport {
    double rate = 24;                                                              ///< frames a second
    double from = 0, to = 0;                                                       ///< range of the key frames, seconds
    vcg::fcd::SequenceOutput::Shapes shapes = vcg::fcd::SequenceOutput::EachFrame; ///< of glTF
    QString file;                                                                  ///< .glb, .pc2 or .mdd

    bool isPc2() const { return file.endsWith(".pc2", Qt::CaseInsensitive); }
    bool isMdd() const { return file.endsWith(".mdd", Qt::CaseInsensitive); }
    bool isGltf() const { return !isPc2() && !isMdd(); }
};

#endif
