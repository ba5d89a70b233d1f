// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_QUANTILES_H
#define VCG_FCD_QUANTILES_H

#include <vector>

namespace vcg::fcd {

/// The value at the fraction \p part of the sorted values, [0, 1]; 0 if there are none.
double Quantile(std::vector<double> values, double part);

/// The mean of the smallest values: of the fraction \p part of all, [0, 1], and at least of one; 0 if there are none.
double MeanOfSmallest(std::vector<double> values, double part);

} // namespace vcg::fcd

#endif
