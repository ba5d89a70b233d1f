// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/patches/surface_patches.h>
#include <vcg_ext/solve/discretisation_error.h>
#include <vcg_ext/solve/patch_number.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace vcg::fcd;

/// The error with \p patches if it is \p at100 with 100 and falls as expected.
static double ErrorWith(int patches, double at100) { return at100 * std::pow(100.0 / patches, errorOrder / 2); }

TEST(PatchesFor, IsTheSameWhateverNumberTheErrorWasEstimatedWith) {
    for (double error : {0.002, 0.004, 0.01})
        for (int patches : {150, 300, 900})
            EXPECT_NEAR(PatchesFor(patches, ErrorWith(patches, error)), PatchesFor(100, error), 1);
}

TEST(PatchesFor, OneMoreGainsWhatItHasTo) {
    const double error = 0.005, gain = 5e-6;
    const int n = PatchesFor(100, error, 5000, gain);
    EXPECT_GT(ErrorWith(n - 2, error) - ErrorWith(n - 1, error), gain);
    EXPECT_LT(ErrorWith(n + 1, error) - ErrorWith(n + 2, error), gain);
}

TEST(PatchesFor, MakesTheSumOfTheErrorsOfSeveralSurfacesTheLeast) {
    const double a = 0.004, b = 0.02;
    const int inA = PatchesFor(100, a, 5000), inB = PatchesFor(100, b, 5000);
    const auto sum = [&](int moved) { return ErrorWith(inA + moved, a) + ErrorWith(inB - moved, b); };
    EXPECT_LT(sum(0), sum(20));
    EXPECT_LT(sum(0), sum(-20));
}

TEST(PatchesFor, KeepsItsBounds) {
    EXPECT_EQ(PatchesFor(100, 0), fewPatches);
    EXPECT_EQ(PatchesFor(100, 1e-9), fewPatches);
    EXPECT_EQ(PatchesFor(100, 1), mostPatches);
    EXPECT_EQ(PatchesFor(100, std::numeric_limits<double>::infinity()), mostPatches);
    EXPECT_EQ(PatchesFor(100, 1, 700), 700);
    EXPECT_EQ(PatchesFor(100, 1, 30), 30);
    EXPECT_EQ(PatchesFor(100, std::numeric_limits<double>::quiet_NaN()), GraphParam().Patches());
}
