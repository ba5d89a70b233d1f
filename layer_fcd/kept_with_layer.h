// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_WITH_LAYER_H
#define FCD_KEPT_WITH_LAYER_H

#include "meshlab_host.h"

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

/// \file
/// What belongs to a layer and goes with it. A host does not free what the attributes of a mesh hold when the mesh
/// goes: so the document keeps it, until the layer or the document itself goes, and the mesh has no more than a weak
/// pointer to its place.

/// The name of what is kept: it is no plain data, so only a library that was built in the same way may find it.
/// \param numbers what changes with the layout of what is kept
inline std::string nameOfKept(const std::string &what, std::initializer_list<std::size_t> numbers) {
    std::string name = what;
    for (const std::size_t number : numbers)
        name += "_" + std::to_string(number);
#ifdef _LIBCPP_VERSION
    name += "_libc++";
#endif
    return name;
}

/// What \p layer keeps by a name of nameOfKept, null where it keeps none.
template <class Kept>
std::shared_ptr<const Kept> keptWith(const MeshModel &layer, const std::string &name) {
    using Place = std::shared_ptr<const Kept>;
    const auto *known = host::meshAttribute<std::weak_ptr<Place>>(layer.cm, name);
    const std::shared_ptr<const Place> place = known ? known->lock() : nullptr;
    return place ? *place : nullptr;
}

/// Lets \p layer, of \p document, keep \p what by a name of nameOfKept, in the place of what it keeps by that name;
/// null: nothing.
template <class Kept>
void keepWith(const MeshDocument &document, MeshModel &layer, const std::string &name,
              std::shared_ptr<const Kept> what) {
    using Place = std::shared_ptr<const Kept>;
    const auto *known = host::meshAttribute<std::weak_ptr<Place>>(layer.cm, name);
    if (const std::shared_ptr<Place> place = known ? known->lock() : nullptr) {
        *place = std::move(what);
        return;
    }
    if (!what)
        return;
    const auto place = std::make_shared<Place>(std::move(what));
    host::madeMeshAttribute<std::weak_ptr<Place>>(layer.cm, name) = place;
    // What is connected holds the place, and goes with the document.
    QObject::connect(&document, &MeshDocument::meshRemoved, [place, number = layer.id()](int gone) {
        if (gone == number)
            place->reset();
    });
}

#endif
