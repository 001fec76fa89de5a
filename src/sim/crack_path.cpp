// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crack_path.h"

#include <algorithm>
#include <cmath>

#include "base/principal_axes.h"
#include "sim/cell_volume.h"

namespace swage {

namespace {

constexpr double kNear = 2.3;    // cells
constexpr double kInLine = 0.8;  // least cosine between the pull and the way to a neighbour

// Cells. With 3.5 the last steps of an oblique crack turn it: at 11 degrees it leaves its line by 4
// spacings over 26, with 5.5 by 0.4 over 39.
constexpr double kTrackReach = 5.5;
constexpr double kPullReach = 2.5;
// The middles of cells that an oblique plane crosses lie off it by a quarter of a face's diagonal.
constexpr double kOnTrack = 0.35;
// At 8 a crack at 11 degrees leaves its line by 1.7 spacings over 46; the larger, the more a crack
// at 34 degrees asks (at 16 1.25 of its toughness).
constexpr double kOffTrack = 16;
constexpr double kMostSpared = 2;

// Calls `act` with run, number in it and way from `site`, of all cells no farther than `reach`.
template <typename Act>
void for_cells_near(const Lattice& lattice, const Vec3i& site, double reach, const Act& act) {
    const int most = static_cast<int>(reach);
    for (int k = std::max(0, site.z() - most);
         k <= std::min(lattice.cell_count.z() - 1, site.z() + most); ++k) {
        for (int j = std::max(0, site.y() - most);
             j <= std::min(lattice.cell_count.y() - 1, site.y() + most); ++j) {
            for (const CellRun& run : lattice.cell_runs(j, k)) {
                const int end = std::min(run.count, site.x() + most + 1 - run.i);
                for (int n = std::max(0, site.x() - most - run.i); n < end; ++n) {
                    const Vec3i way = Vec3i(run.i + n, j, k) - site;
                    if (way.squaredNorm() <= reach * reach) act(run, n, way);
                }
            }
        }
    }
}

bool is_sound(const Aggregate& matter, const CellRun& run, int n) {
    return cell_is_sound(matter, run.first + n, run.row_at(n));
}

Mat3 stretch_of(const Aggregate& matter, const CellRun& run, int n) {
    const Mat3 f = cell_gradient(matter, run, n);
    return f.transpose() * f;
}

Vec3 largest_direction(const Mat3& tensor) {
    return principal_axes(tensor).axis.col(2);
}

bool is_in_line(const Vec3i& way, const Vec3& pull) {
    const double length = way.cast<double>().norm();
    return length > 0 && length < kNear &&
           std::abs(way.cast<double>().dot(pull)) > kInLine * length;
}

}  // namespace

StrainedCell strained_cell(const Aggregate& matter, const CellRun& run, int n) {
    return {
        run.first + n, {run.i + n, run.j, run.k}, largest_direction(stretch_of(matter, run, n))};
}

bool is_beside_crack(const Aggregate& matter, const StrainedCell& cell) {
    if (matter.cell_cracked.empty()) return false;
    bool beside = false;
    for_cells_near(
        matter.lattice, cell.site, kNear, [&](const CellRun& run, int n, const Vec3i& way) {
            beside =
                beside || (matter.cell_cracked[run.first + n] != 0 && is_in_line(way, cell.pull));
        });
    return beside;
}

bool are_in_line(const StrainedCell& one, const StrainedCell& other) {
    return is_in_line(other.site - one.site, one.pull);
}

double off_track_factor(const Aggregate& matter, const FractureLaws& laws,
                        const StrainedCell& cell) {
    Vec3 way_to_broken = Vec3::Zero();
    int broken = 0;
    for_cells_near(matter.lattice, cell.site, kTrackReach,
                   [&](const CellRun& run, int n, const Vec3i& way) {
                       if (is_sound(matter, run, n)) return;
                       way_to_broken += way.cast<double>();
                       ++broken;
                   });
    if (broken == 0) return 1;
    way_to_broken /= broken;
    Mat3 pull = Mat3::Zero();
    for_cells_near(matter.lattice, cell.site, kPullReach,
                   [&](const CellRun& run, int n, const Vec3i&) {
                       if (!is_sound(matter, run, n)) return;
                       const PrincipalAxes c = principal_axes(stretch_of(matter, run, n));
                       const double most = c.value[2] - 1;
                       if (most <= 0) return;
                       const Vec3 along = c.axis.col(2);
                       pull += most * most * most * most * along * along.transpose();
                   });
    // It may be that nothing around it is drawn out: it has reached its strength off its middle.
    const Vec3 across = pull.isZero(0) ? cell.pull : largest_direction(pull);
    const auto off_track = [&](const Vec3& way) -> double {
        return std::max(0.0, std::abs((way_to_broken - way).dot(across)) - kOnTrack);
    };
    const double beyond = off_track(Vec3::Zero());
    const double factor = std::min(kMostSpared, 1 + kOffTrack * beyond * beyond);
    if (matter.inset.empty() || factor == 1) return factor;
    // Whether all that lies on the track holds on.
    const double own = laws.of_cell(matter, cell.cell).onset;
    int on_track = 0, holding = 0;
    for_cells_near(matter.lattice, cell.site, kPullReach,
                   [&](const CellRun& run, int n, const Vec3i& way) {
                       if (!is_sound(matter, run, n) || off_track(way.cast<double>()) > 0) return;
                       const double onset = laws.of_cell(matter, run.first + n).onset;
                       ++on_track;
                       holding += onset == 0 || onset > factor * own;
                   });
    return on_track > 0 && holding == on_track ? 1 : factor;
}

}  // namespace swage
