// SPDX-License-Identifier: GPL-3.0-or-later
//
// A host in which things go wrong that MeshLab's own users cannot bring about: loads the plugin, cancels the filters
// that make layers at every call of the progress callback in turn, and lets them run with too little memory, a little
// more each time. Each time, the document must be what it was, and no file written.
//   MALLOC_ARENA_MAX=1 host_faults libfilter_fcd.so
// One arena: the C library ends the process where a new thread finds no room for an arena of its own.
#include <layer_fcd/filter_host.h>
#include "load_plugin.h"

#include <vcg/complex/algorithms/update/bounding.h>
#include <vcg/complex/algorithms/update/normal.h>

#include <QCoreApplication>
#include <QFile>
#include <QTemporaryDir>
#include <QTemporaryFile>

#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

static int calls, stopAt;
static bool callback(const int, const char *) { return ++calls != stopAt; }

/// The file that a filter saves what it was given in, where it does.
static QString savedFile() {
    static const QTemporaryDir folder;
    return folder.filePath("saved.csv");
}

/// All that a filter could change.
struct State {
    bool hasFile = QFile::exists(savedFile());
    int current = -1;
    std::vector<int> id, mask;
    std::vector<QString> label;
    std::vector<bool> visible;
    std::vector<Scalarm> number;

    explicit State(const MeshDocument &document) : current(document.mm()->id()) {
        for (const MeshModel *layer : host::layers(document)) {
            id.push_back(layer->id());
            mask.push_back(layer->dataMask());
            label.push_back(layer->label());
            visible.push_back(layer->isVisible());
            for (const CVertexO &v : layer->cm.vert)
                for (Scalarm x : {v.IsD() ? 0 : v.cP()[0], v.cP()[1], v.cP()[2], v.cN()[0], v.cN()[1], v.cN()[2],
                                  Scalarm(v.cQ()), Scalarm(v.cC()[0]), Scalarm(v.cFlags())})
                    number.push_back(x);
            number.push_back(Scalarm(layer->cm.face.size()));
            number.push_back(Scalarm(layer->cm.vert_attr.size()));
        }
    }
    bool operator==(const State &o) const {
        return hasFile == o.hasFile && current == o.current && id == o.id && mask == o.mask && label == o.label &&
               visible == o.visible && number == o.number;
    }
};

/// A sheet with tags in the quality and holes, and a second layer: a cloud above it.
static void fill(MeshDocument &document, int n) {
    CMeshO &mesh = document.addNewMesh("", "sheet")->cm;
    document.mm()->updateDataMask(MeshModel::MM_VERTQUALITY);
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, n * n);
    for (int i = 0; i < n * n; ++i) {
        mesh.vert[i].P() = Point3m(i % n, i / n, std::sin(0.3 * i));
        mesh.vert[i].Q() = 5 * i < n * n ? 0 : 5 * i < 4 * n * n ? 1 : 2;
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
    vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
    vcg::tri::UpdateNormal<CMeshO>::PerVertexAngleWeighted(mesh);
    CMeshO &other = document.addNewMesh("", "other", false)->cm;
    for (const CVertexO &v : mesh.vert)
        if (!v.IsD())
            vcg::tri::Allocator<CMeshO>::AddVertex(other, v.cP() + Point3m(0, 0, 1));
    vcg::tri::UpdateBounding<CMeshO>::Box(other);
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

/// A file with poses of the handle.
static QString poses() {
    static QTemporaryFile file;
    if (file.open()) // once
        file.write("time,easing,up,turned\nmotions,,2: translate 0 0 5,2: rotate 1 0 0 30\n");
    file.close();
    return file.fileName();
}

static float angle; // degrees, of the handle
static void bend(RichParameterList &parameters) {
    if (parameters.hasParameter("fit_steps"))
        parameters.setValue("fit_steps", IntValue(5)); // which are alike
    if (parameters.hasParameter("poses_file"))
        parameters.setValue("poses_file", host::RichFileParam("poses_file", poses(), QStringList(), "", "").value());
    if (parameters.hasParameter("save_poses_file"))
        parameters.setValue("save_poses_file",
                            host::RichSaveFileParam("save_poses_file", savedFile(), "*.csv", "", "").value());
    if (parameters.hasParameter("rotation_angle"))
        parameters.setValue("rotation_angle", FloatValue(angle));
}

#ifdef FCD_MESHLAB_2020
using Plugin = MeshFilterInterface;
static std::string apply(Plugin &plugin, QAction *action, MeshDocument &document) {
    RichParameterList parameters;
    plugin.initParameterSet(action, document, parameters);
    bend(parameters);
    return plugin.applyFilter(action, document, parameters, callback) ? "" : plugin.errorMsg().toStdString();
}
#else
using Plugin = FilterPlugin;
/// The error, or nothing.
static std::string apply(Plugin &plugin, QAction *action, MeshDocument &document) {
    unsigned mask = 0;
    try {
        RichParameterList parameters = plugin.initParameterList(action, document);
        bend(parameters);
        plugin.applyFilter(action, parameters, document, mask, callback);
        return "";
    } catch (const MLException &e) {
        return e.what();
    }
}
#endif

static int failures;
static void fail(const QAction *action, const std::string &what) {
    std::cerr << action->text().toStdString() << ": " << what << "\n";
    ++failures;
}

/// After all the faults, the filter must still do what it is for.
static void checkResult(const QAction *action, const MeshDocument &document, const MeshModel *sheet) {
    for (const MeshModel *layer : host::layers(document))
        if (layer->label() == "sheet patches" || layer->label() == "sheet deformed" ||
            layer->label() == "sheet fitted" || layer->label() == "sheet key frame 2") {
            if (!follows(layer->cm, sheet->cm))
                fail(action, "a wrong layer");
            return;
        }
    fail(action, "no layer");
}

static void cancel(Plugin &plugin, QAction *action) {
    MeshDocument document;
    fill(document, 40);
    const State before(document);
    const MeshModel *sheet = document.mm();
    for (stopAt = 1;; ++stopAt) {
        calls = 0;
        const std::string error = apply(plugin, action, document);
        if (error.empty())
            break; // it reported less often
        if (error != "Cancelled." || calls != stopAt || !(State(document) == before)) {
            fail(action, "cancelled at call " + std::to_string(stopAt) + " of the callback: '" + error + "' after " +
                             std::to_string(calls) + " calls, or the document has changed");
            break; // what follows would begin with another document
        }
    }
    if (action->text() != "FCD: Pose in Place")
        checkResult(action, document, sheet);
    else if (State(document) == before)
        fail(action, "no pose");
    std::cout << action->text().toStdString() << " was cancelled " << stopAt - 1 << " times\n";
}

/// Lets the filter run with a little more memory each time, until it is done.
/// \param step kB \return the last message
static std::string squeeze(Plugin &plugin, QAction *action, MeshDocument &document, rlim_t step, int &times) {
    const State before(document);
    stopAt = 0;
    rlimit limit;
    getrlimit(RLIMIT_AS, &limit);
    const rlimit unlimited = limit;
    std::string message;
    for (rlim_t spare = step; spare < 1024 * 1024; spare += step) { // kB
        rlim_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        limit.rlim_cur = pages * rlim_t(sysconf(_SC_PAGESIZE)) + (spare << 10);
        setrlimit(RLIMIT_AS, &limit);
        const std::string error = apply(plugin, action, document);
        setrlimit(RLIMIT_AS, &unlimited);
        if (error.empty())
            break;
        ++times;
        message = error;
        if (error.find("Out of memory") == std::string::npos || !(State(document) == before))
            fail(action, "with " + std::to_string(spare) + " kB: '" + error + "', or the document has changed");
    }
    return message;
}

static void runOutOfMemory(Plugin &plugin, QAction *action) {
    MeshDocument document;
    fill(document, 150);
    const MeshModel *sheet = document.mm();
    int times = 0;
    const std::string message = squeeze(plugin, action, document, 256, times);
    checkResult(action, document, sheet);
    std::cout << action->text().toStdString() << " ran out of memory " << times << " times: " << message << "\n";
}

/// A layer is posed twice: from rest, and from a pose, which is not lost where the next one finds no memory.
static void poseInVain(Plugin &plugin, QAction *action) {
    MeshDocument document;
    fill(document, 150);
    int first = 0, second = 0;
    angle = 20;
    squeeze(plugin, action, document, 256, first);
    const State posed(document);
    angle = -30;
    const std::string message = squeeze(plugin, action, document, 64, second);
    if (State(document) == posed)
        fail(action, "no pose");
    angle = 0;
    std::cout << action->text().toStdString() << " ran out of memory " << first << " and " << second
              << " times: " << message << "\n";
}

int main(int argc, char **argv) {
    mallopt(M_MMAP_THRESHOLD, 1 << 15); // what is freed goes back, and is not there for the next try
    mallopt(M_TRIM_THRESHOLD, 1 << 15);
    QCoreApplication application(argc, argv);
    Plugin *plugin = loadPlugin<Plugin>(argc > 1 ? argv[1] : "");
    if (!plugin)
        return 2;
    for (QAction *action : plugin->actions())
        if (action->text() == "FCD: Build Deformation Graph" || action->text() == "FCD: Deform Mesh" ||
            action->text() == "FCD: Fit to Layer" || action->text() == "FCD: Pose Sequence") {
            cancel(*plugin, action); // the other filters take no time, and do not report progress
            runOutOfMemory(*plugin, action);
        } else if (action->text() == "FCD: Pose in Place") {
            angle = 20;
            cancel(*plugin, action);
            poseInVain(*plugin, action);
        }
    return failures != 0;
}
