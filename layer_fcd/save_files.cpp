// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // before Qt

#include "save_files.h"

#include <deque>
#include <filesystem>

#include <QFile>
#include <QFileInfo>
#include <QSaveFile>

using vcg::fcd::Error;

namespace {

/// Where a file is written that is called \p path.
QString placeOf(const QString &path) {
    QFileInfo file(path);
    for (int links = 0; file.isSymLink() && links < 100; ++links) // the system follows fewer
        file.setFile(file.symLinkTarget());
    const QString folder = QFileInfo(file.path()).canonicalFilePath(); // empty where there is none
    return folder.isEmpty() ? file.absoluteFilePath() : folder + "/" + file.fileName();
}

[[noreturn]] void failToWrite(const QString &path, const QString &reason) {
    throw Error("Cannot write '" + path.toStdString() + "': " + reason.toStdString() + ".");
}

/// Writes \p size bytes beside \p file.
void write(QSaveFile &file, const QString &path, const char *data, std::size_t size) {
    if (!file.open(QIODevice::WriteOnly | QIODevice::Unbuffered))
        failToWrite(path, file.errorString());
    for (std::size_t written = 0; written < size;) {
        // A full disk takes a part first, and says what is wrong with the next one.
        const qint64 more = file.write(data + written, qint64(size - written));
        if (more <= 0)
            failToWrite(path, file.errorString());
        written += std::size_t(more);
    }
}

} // namespace

bool isSameFile(const QString &a, const QString &b) {
    const auto path = [](const QString &s) { return std::filesystem::u8path(s.toStdString()); };
    std::error_code none; // where there is no file yet
    return placeOf(a) == placeOf(b) || std::filesystem::equivalent(path(a), path(b), none);
}

void saveFiles(const std::vector<FileContent> &files) {
    struct Replacement {
        QFile present;
        QSaveFile next, last; ///< the new content, and what undoes it
        bool isNew;

        explicit Replacement(const QString &place)
            : present(place), next(place), last(place), isNew(!QFileInfo::exists(place)) {}
    };
    std::deque<Replacement> replacements;
    for (const FileContent &file : files) {
        Replacement &r = replacements.emplace_back(placeOf(file.path));
        if (!r.isNew && !QFileInfo(r.present).isFile())
            failToWrite(file.path, "it is no ordinary file");
        write(r.next, file.path, file.text.data(), file.text.size());
        // The last file needs no way back.
        if (r.isNew || &file == &files.back())
            continue;
        if (!r.present.open(QIODevice::ReadOnly))
            failToWrite(file.path, r.present.errorString());
        const QByteArray content = r.present.readAll();
        if (r.present.error() != QFile::NoError)
            failToWrite(file.path, r.present.errorString());
        write(r.last, file.path, content.data(), std::size_t(content.size()));
    }
    for (std::size_t i = 0; i < files.size(); ++i)
        if (!replacements[i].next.commit()) {
            const QString reason = replacements[i].next.errorString();
            for (std::size_t done = 0; done < i; ++done) {
                Replacement &r = replacements[done];
                if (r.isNew)
                    r.present.remove();
                else
                    r.last.commit();
            }
            failToWrite(files[i].path, reason);
        }
}
