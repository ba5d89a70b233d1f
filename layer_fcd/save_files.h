// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVE_FILES_H
#define FCD_SAVE_FILES_H

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <QString>

/// A file to write.
struct FileContent {
    QString path;
    std::string text;
};

/// Whether \p a and \p b name one file. Links are followed, also to files that do not exist yet. Names that differ only
/// in case count as the same, as on some systems.
bool isSameFile(const QString &a, const QString &b);

/// Writes files in pieces, each beside an existing one, and replaces all of these at once.
class FilesToSave {
  public:
    FilesToSave();
    FilesToSave(const FilesToSave &) = delete;
    FilesToSave &operator=(const FilesToSave &) = delete;
    ~FilesToSave(); ///< discards what was not saved

    /// Writes bytes at an offset from the begin of the file. \throw as saveFiles
    using WriteAt = std::function<void(std::uint64_t at, const char *data, std::size_t size)>;

    /// Begins a file. \return writes to it while this object exists \throw as saveFiles
    WriteAt add(const QString &path);

    /// Replaces all files, or none. \throw as saveFiles
    void save();

  private:
    struct Replacement;
    std::vector<std::unique_ptr<Replacement>> replacements;
};

/// Writes all of \p files, or none: existing ones are replaced only when all is on the disk. Links stay links.
/// \throw vcg::fcd::Error with the file and the system's reason
void saveFiles(const std::vector<FileContent> &files);

#endif
