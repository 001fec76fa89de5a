// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/units.h"
#include "geometry/mesh_check.h"
#include "geometry/near_pairs.h"
#include "machines/touch.h"
#include "matter/cell_middle.h"
#include "matter/touch_points.h"
#include "sim/rest_surface.h"

namespace swage {

namespace {

// Middles of cells that lie on each other are half of both cells apart; these are nearer.
constexpr double kNearer = 0.45;
constexpr float kSolid = 0.5f;  // share of a cell, that its middle is in the body
// What lies on something does so a little deep [spacings].
constexpr double kDeep = 0.25;

struct SolidCells {
    std::vector<CellId> cell;
    std::vector<Vec3> middle, centroid;  // of the cell, of what of it is matter [m]
};

// How a body that nothing has deformed yet lies at this cell.
Pose world_from_reference(const Aggregate& matter, CellId cell) {
    const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
    const Vec3 low = matter.particle_position.at(corner[0]);
    Mat3 axes;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 side = matter.particle_position.at(corner[std::size_t(1) << axis]) - low;
        axes.col(axis) = side / matter.lattice.spacing;
    }
    const Quat turn(axes);
    return {turn, low - turn * matter.particle_reference.at(corner[0])};
}

SolidCells solid_cells(const Aggregate& matter) {
    SolidCells cells;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.cell_fill[c] < kSolid) continue;
        const Vec3 middle = cell_middle(matter, static_cast<CellId>(c));
        const Pose pose = world_from_reference(matter, static_cast<CellId>(c));
        const Vec3 off = matter.lattice.spacing * matter.cell_centroid[c].cast<double>();
        cells.cell.push_back(static_cast<CellId>(c));
        cells.middle.push_back(middle);
        cells.centroid.push_back(middle + pose.turn(off));
    }
    return cells;
}

// Whether a place lies well below the surface of a body with this cell.
bool is_deep_in(const Aggregate& matter, CellId near, const RestSurface& surface,
                const Vec3& place) {
    const Vec3 reference = world_from_reference(matter, near).inverse() * place;
    const Vec3 at = (reference - matter.lattice.origin) / matter.lattice.spacing;
    const Vec3 low(std::floor(at.x()), std::floor(at.y()), std::floor(at.z()));
    const Vec3i site = low.cast<int>();
    const CellId cell = matter.lattice.cell_at(site);
    if (cell < 0) return false;
    return !surface.is_rim(cell) || surface.at(cell, at - low).distance < -kDeep;
}

std::vector<Vec3> touching_points(const Aggregate& matter) {
    const TouchPoints touch(matter);
    std::vector<Vec3> points;
    for (int p = 0; p < static_cast<int>(touch.size()); ++p) {
        if (!touch.meets(p)) continue;
        points.push_back(
            touch.points().position(static_cast<std::size_t>(p), matter.particle_position));
    }
    return points;
}

// How a body stands to a plate that is drawn endless. The work-piece's middle says which of its
// sides is the right one; what lies on the other, or past the edge, has nothing to lie on.
struct Standing {
    std::string astray;  // empty: the body's middle is neither past the edge nor behind
    double deep = 0;     // [m] that the body reaches into the plate and beyond
};

Standing standing_at(const BoxShape& plate, const Pose& plate_from_world, const Vec3& work_piece,
                     const Vec3& middle, const std::vector<Vec3>& points) {
    int thin = 0;
    const double half = 0.5 * plate.size.minCoeff(&thin);
    const double side = (plate_from_world * work_piece)[thin] < 0 ? -1 : 1;
    const auto is_over = [&](const Vec3& at) {
        for (int axis = 0; axis < 3; ++axis) {
            if (axis != thin && std::abs(at[axis]) > 0.5 * plate.size[axis]) return false;
        }
        return true;
    };
    Standing standing;
    const Vec3 centre = plate_from_world * middle;
    if (!is_over(centre)) {
        standing.astray = "with its middle past the edge of";
    } else if (side * centre[thin] < -half) {
        standing.astray = "with its middle on the far side of";
    }
    for (const Vec3& point : points) {
        const Vec3 at = plate_from_world * point;
        if (is_over(at)) standing.deep = std::max(standing.deep, half - side * at[thin]);
    }
    return standing;
}

}  // namespace

std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies) {
    std::vector<SolidCells> cells_of;
    for (const NamedMatter& body : bodies) cells_of.push_back(solid_cells(*body.matter));
    std::vector<std::unique_ptr<RestSurface>> surface(bodies.size());
    std::vector<std::string> told;
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = a + 1; b < bodies.size(); ++b) {
            const double side_a = bodies[a].matter->lattice.spacing,
                         side_b = bodies[b].matter->lattice.spacing;
            const double reach = kNearer * (side_a + side_b);
            std::vector<Box> box;
            for (const Vec3& m : cells_of[b].middle) {
                box.push_back({m - Vec3::Constant(reach), m + Vec3::Constant(reach)});
            }
            std::vector<char> shared(cells_of[a].middle.size(), 0);
            for (const auto& [point, other] : near_pairs(cells_of[a].middle, box)) {
                const std::size_t p = static_cast<std::size_t>(point),
                                  q = static_cast<std::size_t>(other);
                const Vec3 way = cells_of[a].middle[p] - cells_of[b].middle[q];
                if (way.norm() >= reach || shared[p]) continue;
                if (!surface[b]) surface[b] = std::make_unique<RestSurface>(*bodies[b].matter);
                shared[p] = is_deep_in(*bodies[b].matter, cells_of[b].cell[q], *surface[b],
                                       cells_of[a].centroid[p]);
            }
            const auto cells = std::count(shared.begin(), shared.end(), 1);
            if (cells == 0) continue;
            told.push_back(
                fmt::format("\"{}\" and \"{}\" lie in each other at the start, about {} of them: "
                            "they will burst "
                            "apart; put them further apart with `at`",
                            bodies[a].name, bodies[b].name,
                            volume_text(static_cast<double>(cells) * side_a * side_a * side_a)));
        }
    }
    return told;
}

std::vector<std::string> tool_overlaps(const Machine& machine,
                                       const std::vector<NamedMatter>& bodies) {
    std::vector<std::string> told;
    if (bodies.size() < 2 || machine.apparatus.tool.empty()) return told;
    const std::vector<Pose> world_from_tool = drive_at(machine, 0, 1).world_from_tool;
    const Vec3 work_piece = machine.frame.world_from_work.translation;
    for (std::size_t b = 1; b < bodies.size(); ++b) {
        const std::vector<Vec3> points = touching_points(*bodies[b].matter);
        const Vec3 middle = box_of(points).center();
        for (std::size_t n = 0; n < world_from_tool.size(); ++n) {
            const Tool& tool = machine.apparatus.tool[n];
            const auto* plate = std::get_if<BoxShape>(&tool.shape);
            Standing standing;
            if (tool.finish == Finish::endless && plate != nullptr) {
                standing =
                    standing_at(*plate, world_from_tool[n].inverse(), work_piece, middle, points);
            } else {
                standing.deep = -nearest_distance(tool.shape, world_from_tool[n], points);
            }
            const std::string start = fmt::format("\"{}\" starts", bodies[b].name),
                              which = fmt::format(
                                  "the tool {} of the machine {}, which is set up "
                                  "by the work-piece alone",
                                  tool.name, machine.spec.name);
            if (!standing.astray.empty()) {
                told.push_back(fmt::format(
                    "{} {} {} and ends somewhere, although it is drawn endless: put the body "
                    "elsewhere with `at`, or make the tool larger or set it lower",
                    start, standing.astray, which));
            } else if (standing.deep > kDeep * bodies[b].matter->lattice.spacing) {
                told.push_back(fmt::format("{} {} deep in {}: put it elsewhere with `at`", start,
                                           quantity_text(standing.deep, Quantity::length), which));
            }
        }
    }
    return told;
}

}  // namespace swage
