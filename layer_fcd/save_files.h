// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVE_FILES_H
#define FCD_SAVE_FILES_H

#include <string>
#include <vector>

#include <QString>

/// A file to write.
struct FileContent {
    QString path;
    std::string text;
};

/// Whether what is written to \p a and to \p b ends in one file: links are followed, also to where nothing is yet.
bool isSameFile(const QString &a, const QString &b);

/// Writes all of \p files, or leaves each as it was. What is there is replaced at once, and only when all is on the
/// disk. Links stay links. \throw vcg::fcd::Error naming the file and the system's reason
void saveFiles(const std::vector<FileContent> &files);

#endif
