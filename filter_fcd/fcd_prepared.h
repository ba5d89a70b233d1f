// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_PREPARED_H
#define FCD_PREPARED_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/centroidal_deformation.h>

#include "meshlab_host.h"

#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>

/// A layer that is prepared to be deformed.
struct Prepared {
    std::unique_ptr<vcg::fcd::Deformer> deformer;
    std::vector<char> moving; ///< per vertex slot: whether it may move in some pose
    vcg::fcd::TagCount tags;
    double seconds = 0; ///< that preparing it took; 0 once it has been used
};

/// The deformers of the layers that were deformed last, so that the next pose of one does not begin anew. Each is found
/// by a hash of all that it was made from, so that none is ever used for anything else.
class PreparedLayers {
  public:
    /// What is prepared for \p layer with the tags and point handles of \p handles, or else what \p prepare makes.
    /// \param rest positions per vertex slot, null where the layer is at rest
    std::shared_ptr<Prepared> get(const MeshDocument &document, const MeshModel &layer, const Point3m *rest,
                                  const vcg::fcd::Handles &handles, const vcg::fcd::DeformerParam &param,
                                  const std::function<std::unique_ptr<vcg::fcd::Deformer>()> &prepare);

  private:
    using Key = std::array<std::uint64_t, 2>;
    struct Entry {
        Key key;
        const MeshDocument *document; ///< of the layer, which may be gone
        int layer;                    ///< its number
        std::shared_ptr<Prepared> prepared;
    };
    static Key keyOf(const MeshModel &layer, const Point3m *rest, const vcg::fcd::Handles &handles,
                     const vcg::fcd::DeformerParam &param);
    void forget(const MeshDocument &document, int layer);

    std::list<Entry> entries; ///< the latest first
};

#endif
