// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_SEQUENCED_H
#define PYMESHLAB_FCD_SEQUENCED_H

#include "posed.h"

#include <vcg_ext/sequence/sequence_frames.h>

#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// Named poses and key frames of them.
class Sequence {
  public:
    using Key = std::tuple<double, int, std::vector<double>>; ///< time, easing, weights

    Sequence(const std::vector<std::pair<std::string, std::string>> &poses, const std::vector<Key> &keys);
    Sequence(const std::string &text, const std::string &name) : sequence(vcg::fcd::ReadPoseSequence(text, name)) {}

    /// The table. \param prepared whose surface the table names; null: none
    std::string text(const Prepared *prepared) const;
    /// The table with the surface that was read, for pickles.
    std::string state() const { return PoseSequenceText(sequence); }
    std::vector<std::pair<std::string, std::string>> poses() const;
    std::vector<Key> keys() const;
    std::vector<double> weightsAt(double time) const { return sequence.WeightsAt(time); }
    std::vector<double> times(double rate) const { return FrameTimes(sequence, rate); }

    /// The motions of each pose. \throw BadInput \p prepared lacks a handle, or is another surface
    std::vector<std::map<int, vcg::fcd::Motion>> motionsOf(const Prepared &prepared) const;

    using Colors = Given<std::uint8_t, nb::shape<-1, 4>>;
    /// A mesh's name, colours of vertices, colours of faces, texture coordinates of the faces' corners, texture of each
    /// face, and textures: name and content.
    using Look =
        std::tuple<std::string, std::optional<Colors>, std::optional<Colors>,
                   std::optional<Given<float, nb::shape<-1, 6>>>, std::optional<Given<std::int32_t, nb::ndim<1>>>,
                   std::vector<std::pair<std::string, nb::bytes>>>;
    using Other = std::tuple<Rows, std::optional<Corners>, Look>; ///< a companion

    /// Writes frames. \param gltf, pc2, mdd called with an offset and bytes; or None
    nb::dict write(const std::shared_ptr<Prepared> &prepared, double rate, const nb::object &gltf, int shapes,
                   const nb::object &pc2, const nb::object &mdd, const Look &look, const std::vector<Other> &others,
                   const nb::object &report) const;

  private:
    vcg::fcd::PoseSequence sequence;
};

/// Poses a surface by weights of poses, each time from the last pose.
class Sequencer {
  public:
    Sequencer(std::shared_ptr<Prepared> prepared, const Sequence &sequence);

    std::unique_ptr<Posed> go(const std::vector<double> &weight, const nb::object &report);

  private:
    const std::shared_ptr<Prepared> prepared;
    vcg::fcd::SequenceSolver solver;
};

#endif
