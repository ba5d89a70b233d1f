// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // before Qt

#include "save_files.h"

#include <filesystem>

#include <QFile>
#include <QFileInfo>
#include <QSaveFile>

using vcg::fcd::Error;

namespace {

/// The file that \p path names, after links.
QString placeOf(const QString &path) {
    QFileInfo file(path);
    for (int links = 0; file.isSymLink() && links < 100; ++links) // the system follows fewer
        file.setFile(file.symLinkTarget());
    const QString folder = QFileInfo(file.path()).canonicalFilePath(); // empty: it does not exist
    return folder.isEmpty() ? file.absoluteFilePath() : folder + "/" + file.fileName();
}

[[noreturn]] void failToWrite(const QString &path, const QString &reason) {
    throw Error("Cannot write '" + path.toStdString() + "': " + reason.toStdString() + ".");
}

/// Writes \p size bytes to \p file, which is a temporary one beside \p path until it is committed.
void write(QSaveFile &file, const QString &path, const char *data, std::size_t size) {
    if (!file.isOpen() && !file.open(QIODevice::WriteOnly | QIODevice::Unbuffered))
        failToWrite(path, file.errorString());
    for (std::size_t written = 0; written < size;) {
        // A full disk takes a part first, and reports an error with the next one.
        const qint64 more = file.write(data + written, qint64(size - written));
        if (more <= 0)
            failToWrite(path, file.errorString());
        written += std::size_t(more);
    }
}

} // namespace

bool isSameFile(const QString &a, const QString &b) {
    const auto isOne = [](const QString &x, const QString &y) {
        const auto path = [](const QString &s) { return std::filesystem::u8path(s.toStdString()); };
        std::error_code none; // ignored: the file may not exist yet
        return x == y || std::filesystem::equivalent(path(x), path(y), none);
    };
    const auto name = [](const QString &place) {
        return QFileInfo(place).fileName().normalized(QString::NormalizationForm_C).toCaseFolded();
    };
    const QString first = placeOf(a), second = placeOf(b);
    return isOne(first, second) ||
           (name(first) == name(second) && isOne(QFileInfo(first).path(), QFileInfo(second).path()));
}

struct FilesToSave::Replacement {
    QString path;
    QFile present;
    QSaveFile next, last; ///< the new content, and the old one to undo it
    bool isNew;

    Replacement(const QString &path, const QString &place)
        : path(path), present(place), next(place), last(place), isNew(!QFileInfo::exists(place)) {}
};

FilesToSave::FilesToSave() = default;
FilesToSave::~FilesToSave() = default;

FilesToSave::WriteAt FilesToSave::add(const QString &path) {
    replacements.push_back(std::make_unique<Replacement>(path, placeOf(path)));
    Replacement &r = *replacements.back();
    if (!r.isNew && !QFileInfo(r.present).isFile())
        failToWrite(path, "it is no ordinary file");
    write(r.next, path, nullptr, 0);
    return [&r](std::uint64_t at, const char *data, std::size_t size) {
        if (at != std::uint64_t(r.next.pos()) && !r.next.seek(qint64(at)))
            failToWrite(r.path, r.next.errorString());
        write(r.next, r.path, data, size);
    };
}

void FilesToSave::save() {
    for (const auto &each : replacements) {
        Replacement &r = *each;
        // The last file need not be undone.
        if (r.isNew || each == replacements.back())
            continue;
        if (!r.present.open(QIODevice::ReadOnly))
            failToWrite(r.path, r.present.errorString());
        write(r.last, r.path, nullptr, 0);
        while (!r.present.atEnd()) {
            const QByteArray content = r.present.read(1 << 20);
            if (r.present.error() != QFile::NoError)
                failToWrite(r.path, r.present.errorString());
            write(r.last, r.path, content.data(), std::size_t(content.size()));
        }
    }
    for (std::size_t i = 0; i < replacements.size(); ++i)
        if (!replacements[i]->next.commit()) {
            const QString reason = replacements[i]->next.errorString();
            for (std::size_t done = 0; done < i; ++done) {
                Replacement &r = *replacements[done];
                if (r.isNew)
                    r.present.remove();
                else
                    r.last.commit();
            }
            failToWrite(replacements[i]->path, reason);
        }
}

void saveFiles(const std::vector<FileContent> &files) {
    FilesToSave all;
    for (const FileContent &file : files)
        all.add(file.path)(0, file.text.data(), file.text.size());
    all.save();
}
