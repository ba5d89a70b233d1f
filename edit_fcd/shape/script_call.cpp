// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/shape/script_call.h"

#include <vcg_ext/base/words.h>

using vcg::fcd::detail::ToText;

std::string inPython(bool value) { return value ? "True" : "False"; }
std::string inPython(int value) { return std::to_string(value); }
std::string inPython(float value) { return ToText(value); }
std::string inPython(double value) { return ToText(value); }

std::string inPython(const std::string &value) {
    std::string all = "'";
    for (const char c : value)
        if (c == '\n')
            all += "\\n";
        else
            (all += c == '\'' || c == '\\' ? "\\" : "") += c;
    return all + "'";
}

std::string inPython(const Eigen::Vector3d &value) {
    return "numpy.array([" + ToText(value[0]) + ", " + ToText(value[1]) + ", " + ToText(value[2]) + "])";
}
