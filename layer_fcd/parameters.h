// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_PARAMETERS_H
#define FCD_LAYER_PARAMETERS_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/compensate.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/sequence/sequence_frames.h>
#include <vcg_ext/straighten.h>

#include "meshlab_host.h"

#include <Eigen/Core>

#include <functional>

/// \file
/// What the filters, and the tool, are asked for. How a host shows it is the filters' (filter_fcd/filter_parameters.h).

/// Says something that is worth knowing but no error.
using Remark = std::function<void(const std::string &)>;

inline Eigen::Vector3d toVector(const Point3m &p) { return Eigen::Vector3d(p[0], p[1], p[2]); }
inline Point3m toPoint(const Eigen::Vector3d &v) { return Point3m(Scalarm(v[0]), Scalarm(v[1]), Scalarm(v[2])); }
/// A number that was rounded to S. (By way of memory: GCC 12 leaves out the way from double to float and back where it
/// computes two numbers at once.)
template <class S>
double rounded(double number) {
    const volatile S stored = S(number);
    return double(stored);
}
template <class S>
Eigen::Vector3d rounded(const Eigen::Vector3d &v) {
    return {rounded<S>(v[0]), rounded<S>(v[1]), rounded<S>(v[2])};
}

/// What "FCD: Build Deformation Graph" is asked for.
struct BuildGraphParam {
    vcg::fcd::GraphParam graph;
    bool patchesLayer = true;  ///< also a copy of the mesh coloured by patch
    bool surfaceLayer = false; ///< also the graph as a surface
};

/// Where tags and motions of the handles come from. Motions are in world coordinates: as seen on the screen, that is
/// after the layer's matrix.
struct HandleParam {
    /// Known: marks, or what a filter for tags wrote into the quality; else all is free.
    enum Source { Quality, Selection, Attribute, Files, Known };
    enum Center { Barycenter, Origin, Point };

    Source source = Quality;
    QString tagAttribute = "fcd_tag"; ///< per-vertex scalar attribute (Attribute)
    QString tagFile;                  ///< .sel (Files)
    QString transformFile;            ///< .def, may be empty; read with every source
    QString transforms;               ///< as vcg::fcd::ReadMotionText reads it, may be empty; goes before transformFile
    bool mayLack = false;             ///< where no vertex has a tag, or the quality is no tags, all are free
    bool allFree = false;             ///< no tags are read: all vertices are free
    QString pointFile;                ///< .csv or .pp with point handles in addition to the tags, may be empty

    // The motion of handles that neither of these moves: first as the layer, then matrix, rotation and translation.
    const MeshModel *likeLayer = nullptr; ///< from the layer that is deformed to this one; itself or null: not used
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    Eigen::Vector3d rotationAxis = Eigen::Vector3d::UnitZ(); ///< any length but 0
    double rotationAngle = 0;                                ///< degrees
    Center rotationCenter = Barycenter;
    Eigen::Vector3d rotationPoint = Eigen::Vector3d::Zero(); ///< centre of rotation (Point)
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// What "FCD: Deform Mesh" is asked for.
struct DeformMeshParam {
    enum Quality { Input, Stretch, Rotation, Contact };

    HandleParam handles;
    vcg::fcd::DeformationParam deformation; ///< without nodes
    bool useGraphLayer = false;             ///< take the nodes from graphLayer
    const MeshModel *graphLayer = nullptr;
    bool graphLayers = true;    ///< keep the rest and the deformed graph as layers
    Quality quality = Input;    ///< of the deformed layer
    bool displacement = false;  ///< also an attribute of its vertices: how far they went
    bool stopAtContact = false; ///< only so much of the motion that the surface does not pass through itself
};

/// What "FCD: Fit to Layer" is asked for.
struct FitMeshParam {
    enum Quality { Input, Distance, Matched };
    enum Weights { AllCounts, WeightsQuality, WeightsSelection, WeightsAttribute };
    /// Where the tool FCD: Fit keeps what its brush has painted.
    static constexpr const char *paintedAttribute = "fcd_weight";

    const MeshModel *target = nullptr;
    HandleParam handles;                        ///< regions that stay, or move as they are told
    QString landmarkFile;                       ///< .csv or .pp, may be empty
    QString targetFile;                         ///< .pp, to be matched with the other by name; may be empty
    std::vector<vcg::fcd::Landmark> landmarks;  ///< besides these
    QString curveFile;                          ///< .csv, as vcg::fcd::ReadCurveText; may be empty
    std::vector<vcg::fcd::CurvePair> curves;    ///< besides these
    QString checkFile, checkTargetFile;         ///< pairs that are kept back, as of the other two; may be empty
    bool leaveOneOut = false;                   ///< also fits without each of the landmarks
    bool landmarksOnly = false;                 ///< nothing else of the target counts
    Weights weights = AllCounts;                ///< how much the vertices count: 0 is carried, 1 counts fully
    Weights targetWeights = AllCounts;          ///< those of the target: 0 is as if it were not there
    QString weightAttribute = paintedAttribute; ///< per-vertex scalar attribute of both (WeightsAttribute)
    vcg::fcd::FitParam fit;                     ///< without nodes
    bool graphLayers = true;                    ///< keep the rest and the deformed graph as layers
    Quality quality = Input;                    ///< of the fitted layer
};

/// What "FCD: Symmetrize" is asked for. All in the world.
struct SymmetrizeParam {
    enum Quality { Input, Asymmetry, Moved, Matched };

    QString pairsFile;                                        ///< .csv or .pp: left and right landmarks; may be empty
    QString midlineFile;                                      ///< .pp, .csv or .txt: points of the plane; may be empty
    Eigen::Vector3d planePoint = Eigen::Vector3d::Zero();     ///< on the plane of symmetry
    Eigen::Vector3d planeNormal = Eigen::Vector3d::Zero();    ///< 0: the plane is not given
    FitMeshParam::Weights weights = FitMeshParam::AllCounts;  ///< how much the vertices count
    QString weightAttribute = FitMeshParam::paintedAttribute; ///< (WeightsAttribute)
    bool mirrorMissing = false;                               ///< also a layer with what is missing on the other side
    vcg::fcd::FitParam fit;                                   ///< without nodes
    bool graphLayers = true;                                  ///< keep the rest and the deformed graph as layers
    Quality quality = Asymmetry;                              ///< of the new layer
};

/// What "FCD: Compensate" is asked for.
struct CompensateLayerParam {
    enum Quality { Input, Change };

    const MeshModel *scan = nullptr; ///< of the printed part
    vcg::fcd::CompensateParam compensation;
    Quality quality = Change; ///< of the new layer
};

/// What "FCD: Straighten Mesh" is asked for. All in the world.
struct StraightenMeshParam {
    enum Shape { Straight, Arc, Line };
    enum Quality { Input, Place };

    const MeshModel *lineLayer = nullptr; ///< with edges; the layer that is straightened, or null: not used
    QString lineFile;                     ///< .pp, .csv or .txt, may be empty; goes before lineLayer
    Eigen::Matrix3Xd line; ///< 3 x n, its points, as a layer would have them; goes before both, where there are any
    double smoothing = 0;  ///< as FramedLine takes it
    bool middle = false;   ///< through the middles of the cross-sections instead
    Shape shape = Straight;
    double angle = 90;                                   ///< of the arc, degrees
    Eigen::Vector3d direction = Eigen::Vector3d::Zero(); ///< of its middle; 0: from end to end
    Eigen::Vector3d towards = Eigen::Vector3d::Zero();   ///< where it bends to; 0: where the line does
    const MeshModel *targetLayer = nullptr;              ///< with edges (Line)
    bool reverse = false;                                ///< from the end of that line
    double length = 0;                                   ///< of the line, then; 0: kept
    bool untwist = false;
    vcg::fcd::StraightenParam bend; ///< without nodes
    bool graphLayers = true;        ///< keep the rest and the deformed graph as layers
    Quality quality = Input;        ///< of the straightened layer
};

/// What "FCD: Pose Sequence" is asked for.
struct SequenceParam {
    enum Layers { None, KeyFrames, Frames };

    HandleParam handles;       ///< where the tags are; the poses tell how they move
    QString posesFile;         ///< .csv; empty: the poses that the layer keeps
    double rate = 24;          ///< frames a second
    Layers layers = KeyFrames; ///< that are made
    QString gltfFile;          ///< .glb, may be empty
    bool allVisible = false;   ///< it has all visible layers, which go along
    vcg::fcd::SequenceOutput::Shapes shapes = vcg::fcd::SequenceOutput::EachFrame;
    QString cacheFile; ///< .pc2, may be empty
    QString saveFile;  ///< .csv, may be empty
    vcg::fcd::DeformationParam deformation;

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// What "FCD: Pose in Place" is asked for.
struct PoseParam {
    HandleParam handles;
    vcg::fcd::DeformationParam deformation; ///< without nodes
    bool exactNormals = true;               ///< computed from the faces instead of turned, where they are these
    bool contact = false; ///< also look for contact; of 250 thousand triangles it takes three times as long as the pose
};

/// What "FCD: Reset Pose" is asked for.
struct ResetPoseParam {
    enum To { LastShape, Loaded, InAnyCase };

    bool keepShape = false; ///< make the present shape the rest shape
    /// Otherwise: the shape before the last pose; the shape as loaded; or the first one even if something else has
    /// moved vertices since, which is undone, too.
    To to = LastShape;
};

/// What "FCD: Apply Deformation to Layer" is asked for.
struct CopyParam {
    MeshModel *source = nullptr, *restGraph = nullptr, *deformedGraph = nullptr;
    QString file;              ///< of a saved deformation; empty: the layers have it
    bool displacement = false; ///< also an attribute of the new vertices: how far they went
    bool allVisible = false;   ///< to all visible layers but these, instead of to the current one
};

/// What "FCD: Save Deformation" is asked for.
struct SaveDeformationParam {
    MeshModel *source = nullptr, *restGraph = nullptr, *deformedGraph = nullptr;
    QString file;         ///< .ply
    double accuracy = 0;  ///< as of vcg::fcd::FieldParam, in the world
    bool inverse = false; ///< the way back

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// Where a layer keeps its tags.
struct TagTarget {
    QString attribute;    ///< per-vertex scalar attribute; empty: the vertex quality
    bool colorize = true; ///< colour the vertices by tag
};

/// Which tags and motions are written to files.
struct SaveTagsParam {
    HandleParam handles;   ///< not from files, and without files
    QString tagFile;       ///< .sel
    QString transformFile; ///< .def, may be empty

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// What "FCD: Tag" is asked for.
struct TagParam {
    /// What the selection becomes; or that the file has all tags, or that they stay as they are.
    enum Role { Fixed, Free, Handle, Outside, FromFile, AsTheyAre };

    Role role = Handle;
    int handleNumber = 2; ///< the tag (Handle)
    QString tagFile;      ///< .sel (FromFile)
    TagTarget target;
    SaveTagsParam save; ///< what is written then; no files: nothing. Its source is not read

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// The number that was typed, where a host hands \p value over, in single precision: the shortest decimal that it is
/// rounded from, times 10^\p exponent. It has then the bits that scripts and panels have, which take it in double.
double asTyped(double value, int exponent = 0);

/// \p param with its numbers as they are when a host has handed them over to a filter.
vcg::fcd::DeformationParam asHandedOver(vcg::fcd::DeformationParam param);

/// A parameter as people read it, in a dialog and in a panel.
struct ParameterText {
    QString label;
    QStringList values; ///< of a choice; else none
    QString help;
};

/// That of "weights"; its values stand in the order of vcg::fcd::MappingWeights.
ParameterText weightsText();
ParameterText falloffText();  ///< of DeformerParam::falloff
ParameterText elasticText();  ///< of DeformerParam::elastic
ParameterText rigidityText(); ///< of SolverParam::rigidity, and of FitParam's

/// Those of "FCD: Straighten Mesh"; the values of \p shape stand in the order of StraightenMeshParam::Shape.
struct StraightenTexts {
    ParameterText middle, shape, angle, direction, towards, target, reverse, length, untwist;
};
StraightenTexts straightenTexts();

#endif
