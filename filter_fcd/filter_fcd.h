// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FILTER_FCD_H
#define FILTER_FCD_H

#include <layer_fcd/prepared_layers.h> // before Qt

#include "dialogs.h"

#include <layer_fcd/filter_host.h>
#include <layer_fcd/parameters.h>

/// Fast Centroidal Deformation: the filters that build a deformation graph and deform a mesh with it.
class FilterFcd : public HostFilterPlugin {
    Q_OBJECT
    FCD_PLUGIN_METADATA

  public:
    // clang-format off
    enum Filter {
        BuildGraph, DeformMesh, FitMesh, StraightenMesh, Symmetrize, Compensate, PoseSequence, PoseInPlace, ResetPose,
        CopyDeformation, SaveDeformation, Tag, ClearTags, SaveSession, LoadSession,
        TagSelection, TagsFromFiles, SaveTags // what Tag does, in three parts, for older scripts: not shown
    };
    // clang-format on

    FilterFcd();

    QString name() const override;
    QString filterName(int id) const override;
    QString scriptName(int id) const override;
    QString filterInfo(int id) const override;
    FilterClass menus(int id) const override;
    int changes(int id) const override;
    RichParameterList parameters(int id, const MeshDocument &document) const override;
    ReturnedValues run(int id, const RichParameterList &parameters, MeshDocument &document,
                       vcg::CallBackPos *callback) override;

    // The host's own overloads for QAction stay visible.
    using HostFilterPlugin::filterInfo;
    using HostFilterPlugin::filterName;

  private:
    static RichParameterList defaults(int id, const MeshDocument &document);
    ReturnedValues buildGraph(const RichParameterList &parameters, MeshDocument &document, MeshModel &layer,
                              const vcg::fcd::Progress &progress);
    ReturnedValues deformMesh(const RichParameterList &parameters, MeshDocument &document, MeshModel &current,
                              const vcg::fcd::Progress &progress);
    ReturnedValues pose(const RichParameterList &parameters, MeshDocument &document, MeshModel &layer,
                        const vcg::fcd::Progress &progress);
    ReturnedValues copy(const RichParameterList &parameters, MeshDocument &document, MeshModel &current,
                        const vcg::fcd::Progress &progress);
    ReturnedValues session(int id, const RichParameterList &parameters, const MeshDocument &document,
                           MeshModel &layer) const;
    ReturnedValues clearTags(const MeshDocument &document, MeshModel &layer) const;
    /// Logs a result with its warnings. \return its values
    template <class Made>
    ReturnedValues tell(const Made &made) const;
    /// The same with the surface, contact and values of made.result.
    template <class Made>
    ReturnedValues tellBent(const Made &made) const;
    void warn(const std::vector<std::string> &warnings) const {
        for (const std::string &warning : warnings)
            logLine(warning, GLLogStream::WARNING);
    }
    ReturnedValues report(const vcg::fcd::TagCount &tags) const;
    void warnOf(const vcg::fcd::PosePath &path, bool converged, double discretisationError) const;
    Remark toLog() const {
        return [this](const std::string &line) { logLine(line); };
    }
    static MeshModel &meant(int id, MeshModel &current, MeshDocument &document);
    QString shown() const;

    PreparedLayers preparedLayers;
    mutable LastValues lastValues; ///< const functions of the host forget values
    mutable QString shownLayer;    ///< the layer of the dialog that the host shows next
};

#endif
