// SPDX-License-Identifier: GPL-3.0-or-later
// Springs to fixed places, of which stress takes a part each.
#include "sim/soft_mode.h"

#include <cmath>

#include "base/noise.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr std::size_t kCount = 40, kWeakened = 17;

struct Springs {
    std::vector<double> mass, stiffness, left;  // the last as a share of the stiffness

    Springs() {
        for (std::size_t p = 0; p < kCount; ++p) {
            mass.push_back(2 + noise(p));
            stiffness.push_back(std::pow(10, 2 * noise(100 + p)));
            left.push_back(0.8 + 0.1 * noise(200 + p));
        }
    }

    double follow(SoftMode& mode) const {
        const auto of = [&](const Vec3Array& way, Vec3Array& to, bool whole) {
            to.resize(kCount);
            for (std::size_t p = 0; p < kCount; ++p) {
                to.set(p, stiffness[p] * (whole ? left[p] : 1) * way.at(p));
            }
        };
        return mode.follow(
            mass, stiffness, {}, [&](const auto& w, auto& to) { of(w, to, true); },
            [&](const auto& w, auto& to) { of(w, to, false); },
            [&](const Vec3Array& b, Vec3Array& x) {
                x.resize(kCount);
                for (std::size_t p = 0; p < kCount; ++p) x.set(p, b.at(p) / stiffness[p]);
            });
    }
};

}  // namespace

TEST_CASE("what stress takes most from is followed, however stiff and light it is") {
    Springs springs;
    springs.stiffness[kWeakened] = 1000;
    springs.mass[kWeakened] = 1e-3;
    SoftMode mode;
    for (double left : {0.5, 0.2, -0.2}) {
        springs.left[kWeakened] = left;
        const double found = springs.follow(mode);
        CAPTURE(left);
        CHECK(found >= left - 1e-12);
        CHECK(found == Approx(left).margin(0.02));
    }
    const Vec3Array& way = mode.motion();
    CHECK(springs.stiffness[kWeakened] * way.at(kWeakened).squaredNorm() == Approx(1).margin(0.02));
}

TEST_CASE("where the matter itself has no stiffness nothing is followed") {
    Springs springs;
    for (double& k : springs.stiffness) k = -1;
    SoftMode mode;
    CHECK(springs.follow(mode) == 1);
}
