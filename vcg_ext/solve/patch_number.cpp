// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/patches/surface_patches.h>
#include <vcg_ext/solve/discretisation_error.h>
#include <vcg_ext/solve/patch_number.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

int PatchesFor(int patches, double error, int most, double gain) {
    const double usual = GraphParam().Patches();
    double wanted = fewPatches;
    if (error > 0) { // the number n at which one more patch lowers error (patches / n)^power by gain
        const double power = errorOrder / 2;
        wanted = patches * detail::Power(power * std::min(error, 1.0) / (gain * patches), 1 / (1 + power));
        wanted = wanted < usual ? std::sqrt(wanted * usual) : wanted;
    } else if (!(error <= 0))
        wanted = usual;
    return int(std::min(double(most), std::max(double(fewPatches), wanted)));
}

} // namespace vcg::fcd
