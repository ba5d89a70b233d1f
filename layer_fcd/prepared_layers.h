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
    std::vector<char> turning; ///< and whether a face of it may, once a pose has asked (verticesBeside)
    vcg::fcd::TagCount tags;
    double seconds = 0;      ///< that preparing it took; 0 once it has been used
    bool isOfOthers = false; ///< known: its nodes were given, and are not those of the graph that is made without
};

/// The deformers of the layers that were deformed last, so that the next pose of one does not begin anew. Each is found
/// by a hash of all that it was made from, so that none is ever used for anything else.
class PreparedLayers {
  public:
    struct Key {
        using Hash = std::array<std::uint64_t, 2>;
        Hash surface; ///< with the parameters
        Hash held;    ///< tags and point handles

        bool operator==(const Key &o) const { return surface == o.surface && held == o.held; }
    };

    /// What a surface, with the tags and point handles of \p handles, is found by.
    static Key keyOf(const vcg::fcd::SurfaceView &surface, const vcg::fcd::Handles &handles,
                     const vcg::fcd::DeformerParam &param);

    /// The same number from a layer's mesh, of which nothing is copied.
    /// \param rest positions per vertex slot, null where the vertices' own count \param faces facesOf the mesh
    static Key keyOf(const CMeshO &mesh, const Point3m *rest, std::uint64_t faces, const vcg::fcd::Handles &handles,
                     const vcg::fcd::DeformerParam &param);

    /// What is prepared, null where nothing is.
    std::shared_ptr<Prepared> find(const Key &key);
    /// Prepares \p surface, which is that of the layer of a number; what else was prepared of the layer goes, except
    /// regions that are the same. Nothing of document and layer is read. \pre follow() \throw vcg::fcd::Error no
    /// handle, nothing free, ... \throw vcg::fcd::Cancelled
    std::shared_ptr<Prepared> add(const Key &key, const MeshDocument &document, int layer,
                                  const vcg::fcd::SurfaceView &surface, const vcg::fcd::Handles &handles,
                                  const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress);
    /// What is prepared of a document's layers goes with it.
    void follow(const MeshDocument &document);
    /// Drops what was prepared of layers that are gone.
    void dropRemoved();
    void clear() { entries.clear(); }

  private:
    struct Entry {
        Key key;
        const MeshDocument *document; ///< of the layer; it is there as long as the entry is
        int layer;                    ///< its number
        std::shared_ptr<Prepared> prepared;
    };
    QObject context;          // of connections, which end with it
    std::list<Entry> entries; ///< the latest first
};

#endif
