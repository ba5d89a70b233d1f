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

/// Whether \p a and \p b name one file. Links are followed, also to files that do not exist yet. Names that differ in
/// case alone count as the same, since some systems do not tell them apart.
bool isSameFile(const QString &a, const QString &b);

/// Files that are written bit by bit, each beside what is there, and take its place together.
class FilesToSave {
  public:
    FilesToSave();
    FilesToSave(const FilesToSave &) = delete;
    FilesToSave &operator=(const FilesToSave &) = delete;
    ~FilesToSave(); ///< what was not saved is gone

    /// Takes bytes that stand so many bytes from the beginning of the file. \throw vcg::fcd::Error as saveFiles
    using WriteAt = std::function<void(std::uint64_t at, const char *data, std::size_t size)>;

    /// Begins a file. \return what writes it, as long as this object is there \throw vcg::fcd::Error as saveFiles
    WriteAt add(const QString &path);

    /// Puts all in their places, or leaves each as it was. \throw vcg::fcd::Error as saveFiles
    void save();

  private:
    struct Replacement;
    std::vector<std::unique_ptr<Replacement>> replacements;
};

/// Writes all of \p files, or leaves each as it was. What is there is replaced at once, and only when all is on the
/// disk. Links stay links. \throw vcg::fcd::Error naming the file and the system's reason
void saveFiles(const std::vector<FileContent> &files);

#endif
