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
/// The parameters of filters and tools. filter_fcd/filter_parameters.h declares them to the host.

/// Tells something that is worth knowing, but no error.
using Remark = std::function<void(const std::string &)>;

inline Eigen::Vector3d toVector(const Point3m &p) { return Eigen::Vector3d(p[0], p[1], p[2]); }
inline Point3m toPoint(const Eigen::Vector3d &v) { return Point3m(Scalarm(v[0]), Scalarm(v[1]), Scalarm(v[2])); }
/// A number rounded to S. (Through memory: GCC 12 omits the rounding if it computes two numbers at once.)
template <class S>
double rounded(double number) {
    const volatile S stored = S(number);
    return double(stored);
}
template <class S>
Eigen::Vector3d rounded(const Eigen::Vector3d &v) {
    return {rounded<S>(v[0]), rounded<S>(v[1]), rounded<S>(v[2])};
}

/// Parameters of "FCD: Build Deformation Graph".
struct BuildGraphParam {
    vcg::fcd::GraphParam graph;
    bool patchesLayer = true;  ///< also a copy of the mesh coloured by patch
    bool surfaceLayer = false; ///< also the graph as a surface
};

/// Where tags and motions of the handles come from. Motions are in world coordinates, after the layer's matrix.
struct HandleParam {
    /// Known: marks, or the tags that a filter wrote into the quality, whatever it is now; else all is free.
    enum Source { Quality, Selection, Attribute, Files, Known };
    enum Center { Barycenter, Origin, Point };

    Source source = Quality;
    QString tagAttribute = "fcd_tag"; ///< per-vertex scalar attribute (Attribute)
    QString tagFile;                  ///< .sel (Files)
    QString transformFile;            ///< .def, may be empty; read with every source
    QString transforms;               ///< as in vcg::fcd::ReadMotionText, may be empty; goes before transformFile
    bool mayLack = false;             ///< if no vertex has a tag, or the quality is no tags, all are free
    bool allFree = false;             ///< no tags are read: all vertices are free
    QString pointFile;                ///< .csv or .pp with point handles in addition to the tags, may be empty

    // The motion of handles that neither text nor file moves: likeLayer, then matrix, rotation and translation.
    const MeshModel *likeLayer = nullptr; ///< the motion from the layer to this one; the layer itself or null: none
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    Eigen::Vector3d rotationAxis = Eigen::Vector3d::UnitZ(); ///< any length but 0
    double rotationAngle = 0;                                ///< degrees
    Center rotationCenter = Barycenter;
    Eigen::Vector3d rotationPoint = Eigen::Vector3d::Zero(); ///< the pivot (Point)
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// Parameters of "FCD: Deform Mesh".
struct DeformMeshParam {
    enum Quality { Input, Stretch, Rotation, Contact };

    HandleParam handles;
    vcg::fcd::DeformationParam deformation; ///< without nodes
    bool useGraphLayer = false;             ///< take the nodes from graphLayer
    const MeshModel *graphLayer = nullptr;
    bool graphLayers = true;    ///< keep the rest and the deformed graph as layers
    Quality quality = Input;    ///< of the deformed layer
    bool displacement = false;  ///< also the attribute "fcd_displacement" of its vertices
    bool stopAtContact = false; ///< only as much of the motion as is free of contact
};

/// Parameters of "FCD: Fit to Layer".
struct FitMeshParam {
    enum Quality { Input, Distance, Matched };
    enum Weights { AllCounts, WeightsQuality, WeightsSelection, WeightsAttribute };
    /// The attribute for the weights that are painted with FCD: Fit.
    static constexpr const char *paintedAttribute = "fcd_weight";

    const MeshModel *target = nullptr;
    HandleParam handles;                        ///< fixed parts and handles
    QString landmarkFile;                       ///< .csv or .pp, may be empty
    QString targetFile;                         ///< .pp, paired with landmarkFile by name; may be empty
    std::vector<vcg::fcd::Landmark> landmarks;  ///< further ones
    QString curveFile;                          ///< .csv, as in vcg::fcd::ReadCurveText; may be empty
    std::vector<vcg::fcd::CurvePair> curves;    ///< further ones
    QString checkFile, checkTargetFile;         ///< landmarks that only check the fit, as the other two; may be empty
    bool leaveOneOut = false;                   ///< also fits without each of the landmarks
    bool landmarksOnly = false;                 ///< nothing is matched
    Weights weights = AllCounts;                ///< of the vertices: 0 is carried, 1 counts fully
    Weights targetWeights = AllCounts;          ///< of the target's vertices: 0 is as if it were not there
    QString weightAttribute = paintedAttribute; ///< per-vertex scalar attribute of both (WeightsAttribute)
    vcg::fcd::FitParam fit;                     ///< without nodes
    bool graphLayers = true;                    ///< keep the rest and the deformed graph as layers
    Quality quality = Input;                    ///< of the fitted layer
};

/// Parameters of "FCD: Symmetrize", world units.
struct SymmetrizeParam {
    enum Quality { Input, Asymmetry, Moved, Matched };

    QString pairsFile;                                        ///< .csv or .pp: left and right landmarks; may be empty
    QString midlineFile;                                      ///< .pp, .csv or .txt: points of the plane; may be empty
    Eigen::Vector3d planePoint = Eigen::Vector3d::Zero();     ///< on the plane of symmetry
    Eigen::Vector3d planeNormal = Eigen::Vector3d::Zero();    ///< 0: the plane is not given
    FitMeshParam::Weights weights = FitMeshParam::AllCounts;  ///< of the vertices
    QString weightAttribute = FitMeshParam::paintedAttribute; ///< (WeightsAttribute)
    bool mirrorMissing = false;                               ///< also a layer with the parts that are missing
    vcg::fcd::FitParam fit;                                   ///< without nodes
    bool graphLayers = true;                                  ///< keep the rest and the deformed graph as layers
    Quality quality = Asymmetry;                              ///< of the new layer
};

/// Parameters of "FCD: Compensate".
struct CompensateLayerParam {
    enum Quality { Input, Change };

    const MeshModel *scan = nullptr; ///< of the printed part
    vcg::fcd::CompensateParam compensation;
    Quality quality = Change; ///< of the new layer
};

/// Parameters of "FCD: Straighten Mesh", world units.
struct StraightenMeshParam {
    enum Shape { Straight, Arc, Line };
    enum Quality { Input, Place };

    const MeshModel *lineLayer = nullptr; ///< with edges; null, or the layer itself: not used
    QString lineFile;                     ///< .pp, .csv or .txt, may be empty; goes before lineLayer
    Eigen::Matrix3Xd line;                ///< 3 x n, points of the line; if not empty, goes before both
    double smoothing = 0;                 ///< as in FramedLine
    bool middle = false;                  ///< through the middles of the cross-sections instead
    Shape shape = Straight;
    double angle = 90;                                   ///< of the arc, degrees
    Eigen::Vector3d direction = Eigen::Vector3d::Zero(); ///< of the new line's middle; 0: from end to end
    Eigen::Vector3d towards = Eigen::Vector3d::Zero();   ///< the side that it bends to; 0: that of the old line
    const MeshModel *targetLayer = nullptr;              ///< with edges (Line)
    bool reverse = false;                                ///< begin at the end of that line
    double length = 0;                                   ///< of the new line; 0: as the old one
    bool untwist = false;
    vcg::fcd::StraightenParam bend; ///< without nodes
    bool graphLayers = true;        ///< keep the rest and the deformed graph as layers
    Quality quality = Input;        ///< of the straightened layer
};

/// Parameters of "FCD: Pose Sequence".
struct SequenceParam {
    enum Layers { None, KeyFrames, Frames };

    HandleParam handles;       ///< only its tags are read
    QString posesFile;         ///< .csv; empty: the poses that the layer keeps
    double rate = 24;          ///< frames a second
    Layers layers = KeyFrames; ///< new layers
    QString gltfFile;          ///< .glb, may be empty
    bool allVisible = false;   ///< the .glb file also has all other visible layers, carried along
    vcg::fcd::SequenceOutput::Shapes shapes = vcg::fcd::SequenceOutput::EachFrame;
    QString pc2File, mddFile; ///< point caches, may be empty
    QString saveFile;         ///< .csv, may be empty
    vcg::fcd::DeformationParam deformation;

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// Parameters of "FCD: Pose in Place".
struct PoseParam {
    HandleParam handles;
    vcg::fcd::DeformationParam deformation; ///< without nodes
    bool exactNormals = true;               ///< normals of faces are computed, not turned
    bool contact = false; ///< also look for contact: for 250 thousand triangles, three times as long as the pose
};

/// Parameters of "FCD: Reset Pose".
struct ResetPoseParam {
    enum To { LastShape, Loaded, InAnyCase };

    bool keepShape = false; ///< make the present shape the rest shape
    /// The shape to restore otherwise: that before the last pose; that of the file; or that of the file even if
    /// something else has moved vertices since, which is undone, too.
    To to = LastShape;
};

/// The layers of a deformation by "FCD: Deform Mesh"; null: none.
struct DeformationLayers {
    MeshModel *source = nullptr, *restGraph = nullptr, *deformedGraph = nullptr;
};

/// Parameters of "FCD: Apply Deformation to Layer".
struct CopyParam : DeformationLayers {
    QString file;              ///< of a saved deformation; empty: the three layers have it
    bool displacement = false; ///< also the attribute "fcd_displacement" of the new vertices
    bool allVisible = false;   ///< applies it to all other visible layers, not to the current one
};

/// Parameters of "FCD: Save Deformation".
struct SaveDeformationParam : DeformationLayers {
    QString file;         ///< .ply
    double accuracy = 0;  ///< as in vcg::fcd::FieldParam, world units
    bool inverse = false; ///< saves the inverse

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// Where a layer keeps its tags.
struct TagTarget {
    QString attribute;    ///< per-vertex scalar attribute; empty: the vertex quality
    bool colorize = true; ///< colour the vertices by tag
};

/// Parameters of saving tags and motions.
struct SaveTagsParam {
    HandleParam handles;   ///< not from files, and without files
    QString tagFile;       ///< .sel
    QString transformFile; ///< .def, may be empty

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// Parameters of "FCD: Tag".
struct TagParam {
    /// What the selection becomes. FromFile: all tags come from a file. AsTheyAre: tags stay.
    enum Role { Fixed, Free, Handle, Outside, FromFile, AsTheyAre };

    Role role = Handle;
    int handleNumber = 2; ///< the tag (Handle)
    QString tagFile;      ///< .sel (FromFile)
    TagTarget target;
    SaveTagsParam save; ///< files to write afterwards; its source is not read

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// The number that a user typed, if the host hands \p value over in single precision: the shortest decimal that rounds
/// to it, times 10^\p exponent. So it has the bits of scripts and panels, which have doubles.
double asTyped(double value, int exponent = 0);

/// \p param with its numbers rounded as a host hands them over to a filter.
vcg::fcd::DeformationParam asHandedOver(vcg::fcd::DeformationParam param);

/// The texts of a parameter, in dialogs and panels.
struct ParameterText {
    QString label, help;
    QStringList values{}; ///< of a choice; else none
};

/// Of "weights"; its values have the order of vcg::fcd::MappingWeights.
ParameterText weightsText();
ParameterText falloffText();  ///< of DeformerParam::falloff
ParameterText elasticText();  ///< of DeformerParam::elastic
ParameterText rigidityText(); ///< of SolverParam::rigidity, and of FitParam's

/// Of "FCD: Straighten Mesh"; the values of \p shape have the order of StraightenMeshParam::Shape.
struct StraightenTexts {
    ParameterText middle, shape, angle, direction, towards, target, reverse, length, untwist;
};
StraightenTexts straightenTexts();

#endif
