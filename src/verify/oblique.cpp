// SPDX-License-Identifier: GPL-3.0-or-later
// Bars that lie across the lattice, so that hardly a cell of their surface is whole.
#include <algorithm>
#include <array>

#include "geometry/make_shape.h"
#include "verify/case.h"
#include "verify/moduli.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kLength = 10, kShear = 1 / 2.5;

struct Section {
    TriMesh mesh;       // along x
    double compliance;  // E v / P of the cantilever by finite elements
    double torsion;     // J
};

Section square_section() { return {bar_mesh(kLength, 1), 4010.5, 0.140577}; }

// The mesh is a prism of many flat sides: what is expected of the round rod is scaled to its area.
Section round_section() {
    TriMesh mesh =
        make_shape("rod", {{"length", kLength}, {"diameter", 1}, {"division", 320}}).mesh;
    const double round = kPi / 4, share = signed_volume(mesh) / kLength / round;
    return {std::move(mesh), 6797.7 / (share * share), kPi / 32 * share * share};
}

void oblique(const Section& section, bool brief, Values& values) {
    const Quat turn(Eigen::AngleAxisd(20 * kPi / 180, Vec3::UnitY()) *
                    Eigen::AngleAxisd(30 * kPi / 180, Vec3::UnitZ()));
    const TriMesh mesh = turned(section.mesh, turn);
    const Vec3 along = turn * Vec3::UnitX();
    const double volume = signed_volume(mesh);
    std::array<std::optional<Aggregate>, 2> rested;
    struct Level {
        int across;
        double bending, torsion;
    };
    for (const auto& [across, bending, torsion] :
         {Level{4, 0.06, 0.08}, Level{8, 0.017, 0.025}, Level{16, 0.005, 0.007}}) {
        if (brief && across > 4) break;
        const Aggregate bar = unit_mold(mesh, across, unit_material());
        values.add(
            relative("mass at " + std::to_string(across) + " cells", 0, volume, bar.mass(), 1e-6));
        values.add(
            relative("E", across, 1, stretch(bar, along, volume / kLength).young_modulus, 1e-3));
        for (const bool upright : {false, true}) {
            const Vec3 axis = upright ? Vec3::UnitZ() : Vec3::UnitY();
            const std::string plane = upright ? "E v / P, in xz" : "E v / P, in xy";
            values.add(relative(plane, across, section.compliance,
                                bending_compliance(bar, along, turn * axis, rested[upright]),
                                bending));
        }
        values.add(relative("J", across, section.torsion, torsion_stiffness(bar, along) / kShear,
                            torsion));
    }
}

void isotropy(bool, Values& values) {
    constexpr int kAcross = 8;
    double low = 1e300, high = 0;
    for (int n = 0; n < 27; ++n) {
        const Vec3 way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        if (way.isZero()) continue;
        const Quat turn = turn_onto(Vec3::UnitX(), way);
        const Aggregate bar = unit_mold(turned(bar_mesh(4, 1), turn), kAcross, unit_material());
        const double modulus = stretch(bar, turn * Vec3::UnitX(), 1).young_modulus;
        low = std::min(low, modulus);
        high = std::max(high, modulus);
    }
    values.add(as_share("spread of E over 26 directions", kAcross, 0, high / low - 1, 0.03));
}

}  // namespace

void add_oblique_cases(std::vector<Case>& cases) {
    const std::string lies = " turned by 30 degrees about z, then 20 about y";
    cases.push_back({"oblique-bar", "a square bar" + lies, "CalculiX C3D20R, Saint-Venant", 0,
                     false,
                     [](bool brief, Values& values) { oblique(square_section(), brief, values); }});
    cases.push_back({"oblique-rod", "a round rod" + lies, "CalculiX C3D20R, Saint-Venant", 0, false,
                     [](bool brief, Values& values) { oblique(round_section(), brief, values); }});
    cases.push_back({"isotropy", "bars along 26 directions of the lattice pulled", "exact", 0,
                     false, isotropy});
}

}  // namespace swage
