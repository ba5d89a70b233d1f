// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SCRIPT_CALL_H
#define FCD_SCRIPT_CALL_H

#include <Eigen/Core> // before Qt

#include <string>

/// \file
/// Writes the filter call with which a script repeats what a tool did.

// Values as Python has them.
std::string inPython(bool value);
std::string inPython(int value);
std::string inPython(float value);
std::string inPython(double value);
std::string inPython(const char *value) = delete; // it would become a bool
std::string inPython(const std::string &value);
std::string inPython(const Eigen::Vector3d &value);

class ScriptCall {
  public:
    explicit ScriptCall(const std::string &filter) : text("ms.apply_filter(" + inPython(filter)) {}

    template <class T>
    ScriptCall &with(const char *name, const T &value) {
        text += std::string(", ") + name + "=" + inPython(value);
        return *this;
    }
    /// Adds nothing if it is the usual value.
    template <class T>
    ScriptCall &with(const char *name, const T &value, const T &usual) {
        return value != usual ? with(name, value) : *this;
    }
    std::string end() const { return text + ")"; }

  private:
    std::string text;
};

#endif
