// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ANIMATION_EXPORT_H
#define FCD_BEND_ANIMATION_EXPORT_H

#include <vcg_ext/sequence/sequence_frames.h> // before Qt

#include <layer_fcd/parameters.h>
#include <layer_fcd/save_files.h>

/// How an animation is exported: as layers, or as a file.
struct AnimationExport {
    double rate = 24;                                                              ///< frames a second
    double from = 0, to = 0;                                                       ///< range of the key frames, seconds
    vcg::fcd::SequenceOutput::Shapes shapes = vcg::fcd::SequenceOutput::EachFrame; ///< of glTF
    SequenceParam::Layers layers = SequenceParam::None;                            ///< None: to the file
    QString file;                                                                  ///< .glb, .pc2 or .mdd

    bool isFile() const { return layers == SequenceParam::None; }
    bool isPc2() const { return file.endsWith(".pc2", Qt::CaseInsensitive); }
    bool isMdd() const { return file.endsWith(".mdd", Qt::CaseInsensitive); }
    bool isGltf() const { return isFile() && !isPc2() && !isMdd(); }
};

/// An exported animation.
struct ExportedAnimation {
    /// A frame that is to become a layer, as TakeFrame gets it.
    struct Frame {
        QString what;
        Eigen::Matrix3Xd position;
        std::vector<Eigen::Matrix3f> linear;
    };

    vcg::fcd::SequenceReport report;
    FilesToSave files; ///< written, not yet saved
    std::vector<Frame> frames;
};

#endif
