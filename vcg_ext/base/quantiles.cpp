// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/quantiles.h>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace vcg::fcd {

double Quantile(std::vector<double> values, double part) {
    if (values.empty())
        return 0;
    const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double MeanOfSmallest(std::vector<double> values, double part) {
    if (values.empty())
        return 0;
    std::sort(values.begin(), values.end());
    const auto end = values.begin() + std::max<std::ptrdiff_t>(1, std::ptrdiff_t(part * double(values.size())));
    return std::accumulate(values.begin(), end, 0.0) / double(end - values.begin());
}

} // namespace vcg::fcd
