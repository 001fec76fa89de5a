// SPDX-License-Identifier: GPL-3.0-or-later
// Square bars in small bending and torsion.

#include "verify/case.h"
#include "verify/moduli.h"
#include "verify/stand.h"

namespace swage {

namespace {

struct Level {
    int across;
    double bound;
};

std::vector<Level> levels(std::vector<Level> all, bool brief) {
    if (brief) all.pop_back();
    return all;
}

void cantilever(bool brief, Values& values) {
    constexpr double kFiniteElements = 4010.5;  // E v / P of the bar of 1 x 1 x 10
    std::optional<Aggregate> rested;
    for (const auto& [across, bound] :
         levels({{1, 0.025}, {3, 0.02}, {7, 0.005}, {15, 0.001}}, brief)) {
        const double got = bending_compliance(unit_bar(10, across, unit_material()), Vec3::UnitX(),
                                              Vec3::UnitZ(), rested);
        values.add(relative("E v / P", across, kFiniteElements, got, bound));
    }
}

void torsion(bool brief, Values& values) {
    constexpr double kShear = 1 / 2.5, kSquare = 0.140577;
    for (const auto& [across, bound] : levels({{3, 0.09}, {7, 0.02}, {15, 0.005}}, brief)) {
        const double got =
            torsion_stiffness(unit_bar(10, across, unit_material()), Vec3::UnitX()) / kShear;
        values.add(relative("J", across, kSquare, got, bound));
    }
}

}  // namespace

void add_beam_cases(std::vector<Case>& cases) {
    cases.push_back({"cantilever", "a bar held at one end, pushed across at the other",
                     "CalculiX C3D20R 8x8x80", 1.5, true, cantilever});
    cases.push_back(
        {"torsion", "a square bar twisted a little", "Saint-Venant", 1.5, true, torsion});
}

}  // namespace swage
