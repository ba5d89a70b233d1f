// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited.h"
#include "kept_graph.h"
#include "kept_tool.h"
#include "layer_labels.h"
#include "layer_state.h"
#include "measured_quality.h"

#include <algorithm>
#include <map>
#include <type_traits>

#include <QAction>
#include <QStringList>
#include <QVariant>

static_assert(std::is_trivial<PosedVertex>::value, "zero for new vertices");

namespace {

/// The name of this type changes with the layout of a state and its parts. So a library finds a state only if both have
/// the same layout. If you change a layout and no size below changes, increase the first number.
template <std::size_t...>
struct Layout {};
using StateLayout =
    Layout<4, sizeof(LayerState), sizeof(RestState), sizeof(KeptScan), sizeof(vcg::fcd::PoseSequence),
           sizeof(Deformation), sizeof(Prepared), sizeof(vcg::fcd::Deformer), sizeof(vcg::fcd::Deformer::Pose),
           EIGEN_MAX_ALIGN_BYTES, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
#ifdef _LIBCPP_VERSION
           1
#else
           0
#endif
           >;

/// Through this attribute, the mesh tells its state where vertices go. It has no memory, since hosts do not free
/// attributes of a deleted mesh, and no name, since filters of the host read values from the first attribute with one.
template <class Layout>
class Attribute final : public host::Follower {
  public:
    explicit Attribute(std::weak_ptr<LayerState> state) : state(std::move(state)) {}

    std::shared_ptr<LayerState> get() const { return state.lock(); }

    void Resize(std::size_t n) override {
        if (const auto known = get())
            known->resize(n);
    }
    void Reorder(std::vector<std::size_t> &newSlots) override {
        if (const auto known = get())
            known->reorder(newSlots);
    }

  private:
    std::weak_ptr<LayerState> state;
};
using StateAttribute = Attribute<StateLayout>;

bool holdsState(const vcg::PointerToAttribute &attribute) {
    return attribute._name.empty() && host::isCalled<StateAttribute>(attribute);
}

/// Removes the attribute of a state, if there is one.
void removeAttribute(CMeshO &mesh) {
    const auto attribute = std::find_if(mesh.vert_attr.begin(), mesh.vert_attr.end(), holdsState);
    if (attribute == mesh.vert_attr.end())
        return;
    delete attribute->_handle;
    mesh.vert_attr.erase(attribute);
}

/// The name of the property of a document that points at its states.
const char *propertyName() { return typeid(StateAttribute).name(); }

/// The states of a document's layers, by layer number.
using States = std::map<int, std::shared_ptr<LayerState>>;

/// The states of \p document, by a property of it; null: none. The connection that reports deleted layers owns them.
States *statesOf(const MeshDocument &document) {
    return static_cast<States *>(document.property(propertyName()).value<void *>());
}

/// In words: the kept parts of a layer that no mesh file, project or other layer can hold.
std::string listOf(const LayerState &state, bool hasTool) {
    QStringList all;
    if (state.rest)
        all << "rest shape";
    if (state.scan)
        all << "colours and quality of before the tags";
    if (!state.marks.empty())
        all << "marks";
    if (state.poses)
        all << "poses";
    if (hasTool)
        all << "handles and motions";
    if (state.fit && !state.fit->pairs.empty())
        all << "pairs of landmarks";
    if (state.fit && state.fit->isSet())
        all << "options of a fit";
    return all.join(", ").toStdString();
}

/// A layer was deleted. Others, such as one that it was merged into, inherit its state. The log tells what is lost.
void leaveTo(MeshDocument &document, LayerState &gone) {
    try {
        if (handDownScan(document, gone))
            gone.scan.reset();
        if (handDownRest(document, gone))
            gone.rest.reset();
        handDownGraph(document, gone);
        handDownMeasured(document, gone);
        for (const MeshModel *layer : host::layers(document)) { // what copies have is not lost
            const LayerState &copy = LayerState::known(*layer);
            if (gone.scan && copy.scan && inheritedScan(*layer, {&gone}))
                gone.scan.reset();
            if (gone.rest && copy.rest && inheritedRest(*layer, {&gone}))
                gone.rest.reset();
        }
    } catch (const std::bad_alloc &) { // its colours and rest shapes are lost; the program goes on
    }
    const std::string lost = listOf(gone, gone.tool != nullptr);
    if (!lost.empty())
        host::log(document, "FCD: a layer is gone, and with it these: " + lost +
                                ". If it was merged into another layer, that one has none of this.");
}

/// Makes the log tell, whenever a user saves a project, what is not in it.
void tellWhenProjectsAreSaved(MeshDocument &document) {
    const auto tell = [&document] {
        for (const MeshModel *layer : host::layers(document)) {
            const std::string lost = listOf(LayerState::known(*layer), toolOf(*layer) != nullptr);
            if (!lost.empty())
                host::log(document, "FCD: a project has no room for what is kept of " + inQuotes(*layer) + ": " + lost +
                                        ". 'FCD: Save Session' writes that to a file.");
        }
    };
    for (const QWidget *window : QApplication::topLevelWidgets())
        for (const QAction *action : window->findChildren<QAction *>())
            if (action->text().remove('&').startsWith("Save Project"))
                QObject::connect(action, &QAction::triggered, &document, tell); // after the host's own answer
}

States &madeStatesOf(const MeshDocument &document) {
    States *known = statesOf(document);
    if (known)
        return *known;
    const auto states = std::make_shared<States>();
    known = states.get();
    QObject::connect(&document, &MeshDocument::meshRemoved, [states, &document](int gone) {
        const auto entry = states->find(gone);
        if (entry == states->end())
            return;
        const std::shared_ptr<LayerState> state = entry->second;
        states->erase(entry);
        leaveTo(const_cast<MeshDocument &>(document), *state);
    });
    if (host::inWindow())
        tellWhenProjectsAreSaved(const_cast<MeshDocument &>(document));
    const_cast<MeshDocument &>(document).setProperty(propertyName(), QVariant::fromValue(static_cast<void *>(known)));
    return *known; // the connection owns them
}

/// Calls body(values) for all lists of values per vertex slot.
template <class Body>
void forColumns(LayerState &state, const Body &body) {
    const auto forShape = [&](Shape &shape) {
        body(shape.position);
        body(shape.normal);
    };
    if (state.rest) {
        forShape(*state.rest);
        body(state.rest->vertex);
        std::for_each(state.rest->earlier.begin(), state.rest->earlier.end(), forShape);
    }
    if (state.scan)
        body(state.scan->number);
    if (!state.marks.empty())
        body(state.marks);
    if (state.measured)
        body(state.measured->number);
}

const std::size_t none = std::numeric_limits<std::size_t>::max();

/// Moves each end of a pair to the vertex slotOf(its slot), or leaves it out.
template <class SlotOf>
void forPairs(LayerState &state, const SlotOf &slotOf) {
    if (!state.fit)
        return;
    auto fit = std::make_shared<FitToolState>(*state.fit);
    for (FitPair &each : fit->pairs)
        if (const std::size_t slot = each.slot ? slotOf(*each.slot) : none; slot != none)
            each.slot = slot;
        else
            each.slot.reset();
    state.fit = std::move(fit);
}

} // namespace

LayerState *LayerState::of(const CMeshO &mesh) {
    for (const vcg::PointerToAttribute &attribute : mesh.vert_attr)
        if (holdsState(attribute))
            if (LayerState *state = static_cast<const StateAttribute *>(attribute._handle)->get().get())
                return state; // the document owns it
    return nullptr;
}

const LayerState &LayerState::known(const MeshModel &layer) {
    static const LayerState nothing;
    const LayerState *state = of(layer);
    return state ? *state : nothing;
}

LayerState &LayerState::made(const MeshDocument &document, MeshModel &layer) {
    LayerState *const present = of(layer);
    if (present)
        return *present;
    States &states = madeStatesOf(document);
    // A host that closes all layers at once sends no signal.
    for (auto each = states.begin(); each != states.end();) {
        const MeshModel *there = document.getMesh(each->first);
        each = there && of(*there) == each->second.get() ? std::next(each) : states.erase(each);
    }
    const auto state = std::make_shared<LayerState>();
    CMeshO &mesh = layer.cm;
    removeAttribute(mesh); // of a state that is gone
    vcg::PointerToAttribute attribute;
    attribute._handle = new StateAttribute(state);
    attribute._sizeof = 0; // hosts take values of the size of a number or a point for one
    attribute._padding = 0;
    attribute._type = typeid(StateAttribute);
    attribute.n_attr = ++mesh.attrn;
    mesh.vert_attr.insert(attribute);
    states[layer.id()] = state;
    return *state;
}

bool LayerState::isEmpty() const {
    return !rest && !scan && marks.empty() && !measured && appliedName.empty() && !poses && !deformation && !tool &&
           !fit && !graph && !result;
}

void LayerState::tidy(MeshModel &layer) {
    if (const LayerState *state = of(layer); state && state->isEmpty())
        removeAttribute(layer.cm);
}

std::vector<const LayerState *> LayerState::ofOthers(const MeshDocument &document, const MeshModel &layer) {
    std::vector<const LayerState *> all;
    if (const States *states = statesOf(document))
        for (const auto &[number, state] : *states)
            if (number != layer.id())
                all.push_back(state.get());
    return all;
}

/// Vertices are deleted: another layer, into which they were copied, may still ask for them.
template <class IsGone>
void LayerState::leave(const IsGone &isGone) {
    for (std::size_t i = 0; scan && rest && i < scan->number.size(); ++i)
        if (isGone(i) && scan->number[i] != 0 && rest->vertex[i].isKnown())
            scan->gone.emplace_back(toPoint(rest->vertex[i].place()), scan->number[i]);
    for (std::size_t i = 0; measured && i < measured->number.size(); ++i)
        if (isGone(i) && measured->number[i] != 0)
            measured->gone.push_back(measured->number[i]);
}

void LayerState::resize(std::size_t n) {
    if (n == 0) { // the mesh is deleted, or gets other vertices; copies may still ask for what it had
        leave([](std::size_t) { return true; });
        isCleared = true;
        return;
    }
    if (isCleared)
        forColumns(*this, [](auto &values) { values.clear(); });
    forPairs(*this, [&](std::size_t slot) { return isCleared || slot >= n ? none : slot; });
    isCleared = false;
    forColumns(*this, [n](auto &values) {
        const std::size_t before = values.size();
        values.resize(n);
        for (std::size_t i = before; i < n; ++i) // a point has no value of its own
            if constexpr (std::is_same<decltype(values[i]), Point3m &>::value)
                values[i].SetZero();
    });
}

void LayerState::reorder(const std::vector<std::size_t> &newSlots) {
    leave([&](std::size_t slot) { return slot < newSlots.size() && newSlots[slot] == none; });
    try {
        if (rest && std::find(newSlots.begin(), newSlots.end(), none) != newSlots.end())
            whole = rest;
    } catch (const std::bad_alloc &) { // a moved part has no rest shape; the program goes on
        whole.reset();
    }
    forColumns(*this, [&](auto &values) {
        for (std::size_t i = 0; i < values.size() && i < newSlots.size(); ++i)
            if (newSlots[i] != none)
                values[newSlots[i]] = values[i];
    });
    forPairs(*this, [&](std::size_t slot) { return slot < newSlots.size() ? newSlots[slot] : slot; });
}
