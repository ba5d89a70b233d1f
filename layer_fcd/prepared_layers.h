// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_PREPARED_LAYERS_H
#define FCD_PREPARED_LAYERS_H

#include "meshlab_host.h"

#include <array>
#include <cstdint>
#include <list>
#include <memory>

#include <QObject>

/// A layer that is prepared to be deformed.
struct Prepared {
    std::shared_ptr<const vcg::fcd::Deformer> deformer;
    std::vector<char> moving;  ///< per vertex slot: whether it may move in some pose
    std::vector<char> turning; ///< whether a face of it may move (verticesBeside); set by the first pose that asks
    vcg::fcd::TagCount tags;
    double seconds = 0;      ///< time of preparing it; 0 once it has been used
    bool isOfOthers = false; ///< its nodes were given, and are not those of the graph that the parameters make
};

/// Keeps the deformers of the layers that were deformed last, for their next poses. The key of a deformer is a hash of
/// all that it was made from, so it is never used for anything else.
class PreparedLayers {
  public:
    struct Key {
        using Hash = std::array<std::uint64_t, 2>;
        Hash surface; ///< with the parameters
        Hash held;    ///< tags and point handles

        bool operator==(const Key &o) const { return surface == o.surface && held == o.held; }
    };

    /// The key of a surface with the tags and point handles of \p handles.
    static Key keyOf(const vcg::fcd::SurfaceView &surface, const vcg::fcd::Handles &handles,
                     const vcg::fcd::DeformerParam &param);

    /// The same key from a layer's mesh, without a copy.
    /// \param rest positions per vertex slot; null: those of the mesh \param faces facesOf the mesh
    static Key keyOf(const CMeshO &mesh, const Point3m *rest, std::uint64_t faces, const vcg::fcd::Handles &handles,
                     const vcg::fcd::DeformerParam &param);

    /// The deformer of a key; null: none.
    std::shared_ptr<Prepared> find(const Key &key);
    /// Prepares \p surface, of the layer with the number \p layer, and drops other deformers of the layer; regions that
    /// are the same are reused. Document and layer are not read. \pre follow()
    /// \throw vcg::fcd::Error no handle, nothing free, ... \throw vcg::fcd::Cancelled
    std::shared_ptr<Prepared> add(const Key &key, const MeshDocument &document, int layer,
                                  const vcg::fcd::SurfaceView &surface, const vcg::fcd::Handles &handles,
                                  const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress);
    /// Drops the deformers of deleted layers, and those of a document's layers when it is closed.
    void follow(const MeshDocument &document);
    void clear() { entries.clear(); }

  private:
    struct Entry {
        Key key;
        const MeshDocument *document; ///< of the layer; it outlives the entry
        int layer;                    ///< its number
        std::shared_ptr<Prepared> prepared;
    };
    QObject context;          // of the connections
    std::list<Entry> entries; ///< the latest first
};

#endif
