// SPDX-License-Identifier: GPL-3.0-or-later
//
// A host whose user cancels, which MeshLab's own users cannot: loads the plugin and cancels each filter at every call
// of the progress callback in turn. Each time, the document must be what it was.
//   host_cancel libfilter_fcd.so
#include <common/ml_document/mesh_document.h>
#include <common/mlexception.h>
#include <common/plugins/interfaces/filter_plugin.h>

#include <QCoreApplication>
#include <QPluginLoader>

#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

static int calls, stopAt;
static bool callback(const int, const char *) { return ++calls != stopAt; }

/// All that a filter could change.
struct State {
    int current = -1;
    std::vector<int> id, mask;
    std::vector<QString> label;
    std::vector<bool> visible;
    std::vector<Scalarm> number;

    explicit State(const MeshDocument &document) : current(document.mm()->id()) {
        for (const MeshModel &layer : document.meshIterator()) {
            id.push_back(layer.id());
            mask.push_back(layer.dataMask());
            label.push_back(layer.label());
            visible.push_back(layer.isVisible());
            for (const CVertexO &v : layer.cm.vert)
                for (Scalarm x : {v.IsD() ? 0 : v.cP()[0], v.cP()[1], v.cP()[2], v.cN()[0], v.cN()[1], v.cN()[2],
                                  Scalarm(v.cQ()), Scalarm(v.cC()[0]), Scalarm(v.cFlags())})
                    number.push_back(x);
            number.push_back(Scalarm(layer.cm.face.size()));
            number.push_back(Scalarm(layer.cm.vert_attr.size()));
        }
    }
    bool operator==(const State &o) const {
        return current == o.current && id == o.id && mask == o.mask && label == o.label && visible == o.visible &&
               number == o.number;
    }
};

/// A sheet with tags in the quality and holes, and a second layer.
static void fill(MeshDocument &document) {
    const int n = 40;
    CMeshO &mesh = document.addNewMesh("", "sheet")->cm;
    document.mm()->updateDataMask(MeshModel::MM_VERTQUALITY);
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, n * n);
    for (int i = 0; i < n * n; ++i) {
        mesh.vert[i].P() = Point3m(i % n, i / n, std::sin(0.3 * i));
        mesh.vert[i].Q() = i < 8 * n ? 0 : i < 32 * n ? 1 : 2;
    }
    for (int i = 0; i < n * (n - 1); ++i)
        if (i % n + 1 < n) {
            vcg::tri::Allocator<CMeshO>::AddFace(mesh, i, i + 1, i + n);
            vcg::tri::Allocator<CMeshO>::AddFace(mesh, i + 1, i + n + 1, i + n);
        }
    for (CFaceO &face : mesh.face)
        for (int k = 0; k < 3 && !face.IsD(); ++k)
            if ((face.V(k) - &mesh.vert[0]) % 17 == 0)
                vcg::tri::Allocator<CMeshO>::DeleteFace(mesh, face);
    for (int i = 0; i < n * n; i += 17) {
        mesh.vert[i].P()[0] = std::numeric_limits<Scalarm>::quiet_NaN();
        vcg::tri::Allocator<CMeshO>::DeleteVertex(mesh, mesh.vert[i]);
    }
    document.mm()->updateBoxAndNormals();
    document.addNewMesh("", "other", false);
}

/// Whether \p deformed has the live vertices and faces of \p rest, the fixed ones where they were.
static bool follows(const CMeshO &deformed, const CMeshO &rest) {
    if (deformed.vn != rest.vn || deformed.fn != rest.fn || deformed.vert.size() != std::size_t(rest.vn))
        return false;
    auto vertex = deformed.vert.begin();
    for (const CVertexO &v : rest.vert)
        if (!v.IsD()) {
            for (int d = 0; d < 3; ++d)
                if (!std::isfinite(vertex->cP()[d]))
                    return false;
            if (v.cQ() == 0 && vertex->cP() != v.cP())
                return false;
            ++vertex;
        }
    return true;
}

int main(int argc, char **argv) {
    QCoreApplication application(argc, argv);
    QPluginLoader loader(argc > 1 ? argv[1] : "");
    FilterPlugin *plugin = qobject_cast<FilterPlugin *>(loader.instance());
    if (!plugin) {
        std::cerr << loader.errorString().toStdString() << "\n";
        return 2;
    }
    int failures = 0;
    for (const QAction *action : plugin->actions()) {
        const std::string name = plugin->pythonFilterName(action).toStdString();
        if (name.compare(0, 8, "generate") != 0)
            continue; // the others take no time, and do not report progress
        MeshDocument document;
        fill(document);
        const State before(document);
        for (stopAt = 1;; ++stopAt) {
            calls = 0;
            unsigned mask = 0;
            try {
                plugin->applyFilter(action, plugin->initParameterList(action, document), document, mask, callback);
                break; // it reported less often
            } catch (const MLException &e) {
                if (std::string(e.what()) != "Cancelled." || calls != stopAt || !(State(document) == before)) {
                    std::cerr << name << ", cancelled at call " << stopAt << " of the callback: '" << e.what()
                              << "' after " << calls << " calls, the document "
                              << (State(document) == before ? "is what it was\n" : "has changed\n");
                    ++failures;
                }
            }
        }
        const MeshModel *made = nullptr;
        for (const MeshModel &layer : document.meshIterator())
            if (layer.label() == "sheet patches" || layer.label() == "sheet deformed")
                made = &layer;
        if (!made || !follows(made->cm, document.getMesh(unsigned(before.id[0]))->cm)) {
            std::cerr << name << " makes a wrong layer, or none\n";
            ++failures;
        }
        std::cout << name << " was cancelled " << stopAt - 1 << " times\n";
    }
    return failures != 0;
}
