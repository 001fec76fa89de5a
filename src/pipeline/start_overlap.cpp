// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "base/units.h"
#include "geometry/mesh_check.h"
#include "geometry/near_pairs.h"
#include "machines/touch.h"
#include "matter/cell_middle.h"
#include "pipeline/rounded_text.h"
#include "pipeline/touching_points.h"
#include "sim/rest_surface.h"

namespace swage {

namespace {

// Middles of cells that lie on each other are half of both cells apart; these are nearer.
constexpr double kNearer = 0.45;
constexpr float kSolid = 0.5f;  // share of a cell, that its middle is in the body
// What lies on something does so a little deep [spacings].
constexpr double kDeep = 0.25;
// What touches as it is molded is not as deep, however its mesh is rounded [spacings].
constexpr double kTouches = 0.05;

// Of which bodies it is told that they start in tools, and from which depth on [spacings].
struct TellingOfTools {
    explicit TellingOfTools(bool to_move_as_molded)
        : first(to_move_as_molded ? 0 : 1), deep(to_move_as_molded ? kTouches : kDeep) {}
    std::size_t first;
    double deep;
};

struct MatterCells {
    std::vector<Vec3> middle, centroid;  // of each cell, of what of it is matter [m]
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

MatterCells matter_cells(const Aggregate& matter) {
    MatterCells cells;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const Vec3 middle = cell_middle(matter, static_cast<CellId>(c));
        const Pose pose = world_from_reference(matter, static_cast<CellId>(c));
        const Vec3 off = matter.lattice.spacing * matter.cell_centroid[c].cast<double>();
        cells.middle.push_back(middle);
        cells.centroid.push_back(middle + pose.turn(off));
    }
    return cells;
}

// How a body stands to a plate that is drawn endless. The work-piece's middle says which of its
// sides is the right one; what lies on the other, or past the edge, has nothing to lie on.
struct Standing {
    std::string astray;  // where the body's middle is; empty: neither past the edge nor behind
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
        standing.astray = "past the edge of";
    } else if (side * centre[thin] < -half) {
        standing.astray = "on the far side of";
    }
    for (const Vec3& point : points) {
        const Vec3 at = plate_from_world * point;
        if (is_over(at)) standing.deep = std::max(standing.deep, half - side * at[thin]);
    }
    return standing;
}

Standing standing_at(const Tool& tool, const Pose& world_from_tool, const Vec3& work_piece,
                     const Vec3& middle, const std::vector<Vec3>& points) {
    const auto* plate = std::get_if<BoxShape>(&tool.shape);
    if (tool.finish == Finish::endless && plate != nullptr) {
        return standing_at(*plate, world_from_tool.inverse(), work_piece, middle, points);
    }
    return {{}, -nearest_distance(tool.shape, world_from_tool, points)};
}

// A body that nothing has deformed yet, and what is found of it where another comes near.
class Starting {
  public:
    explicit Starting(const NamedMatter& body)
        : name(body.name),
          matter(*body.matter),
          cells(matter_cells(matter)),
          point(touching_points(matter)),
          box(box_of(point)),
          reference_from_world_(world_from_reference(matter, 0).inverse()) {}

    double spacing() const { return matter.lattice.spacing; }
    bool is_solid(std::size_t cell) const { return matter.cell_fill[cell] >= kSolid; }
    // How deep a place lies below its surface, a spacing where that is more; outside about as far
    // as it is away, or this.
    static constexpr double kFar = -1;
    double depth_at(const Vec3& place) {
        const Vec3 at = (reference_from_world_ * place - matter.lattice.origin) / spacing();
        const Vec3 low(std::floor(at.x()), std::floor(at.y()), std::floor(at.z()));
        const CellId cell = matter.lattice.cell_at(low.cast<int>());
        if (cell < 0) return kFar * spacing();
        if (!surface_) surface_ = std::make_unique<RestSurface>(matter);
        return spacing() * (surface_->is_rim(cell) ? -surface_->at(cell, at - low).distance : 1);
    }

    std::string name;
    const Aggregate& matter;
    MatterCells cells;
    std::vector<Vec3> point;
    Box box;

  private:
    Pose reference_from_world_;
    std::unique_ptr<RestSurface> surface_;
};

// Whether a solid cell of the first lies well in the second.
bool shares_cells(const Starting& a, Starting& b) {
    const double reach = kNearer * (a.spacing() + b.spacing());
    std::vector<Box> box;
    for (std::size_t q = 0; q < b.cells.middle.size(); ++q) {
        const Vec3& m = b.cells.middle[q];
        box.push_back(b.is_solid(q) ? Box{m - Vec3::Constant(reach), m + Vec3::Constant(reach)}
                                    : Box{});
    }
    for (const auto& [point, other] : near_pairs(a.cells.middle, box)) {
        const std::size_t p = static_cast<std::size_t>(point), q = static_cast<std::size_t>(other);
        if (!a.is_solid(p) || (a.cells.middle[p] - b.cells.middle[q]).norm() >= reach) continue;
        if (b.depth_at(a.cells.centroid[p]) > kDeep * b.spacing()) return true;
    }
    return false;
}

// Of the first body, what lies in the second, about [m3]: of each cell as if its matter were a
// layer that the other's surface is parallel to.
double shared_volume(const Starting& a, Starting& b) {
    double cells = 0;
    for (std::size_t p = 0; p < a.cells.centroid.size(); ++p) {
        const double fill = a.matter.cell_fill[p];
        if (!(fill > 0)) continue;
        const double depth = b.depth_at(a.cells.centroid[p]) / a.spacing();
        cells += fill * std::clamp(0.5 + depth / fill, 0.0, 1.0);
    }
    const double all = cells * a.spacing() * a.spacing() * a.spacing();
    return std::min({all, a.matter.volume(), b.matter.volume()});
}

// By how much either lies in the other [m]; 0 where that is nothing to tell of.
double shared_depth(Starting& a, Starting& b) {
    const double least = kTouches * std::min(a.spacing(), b.spacing());
    const Vec3 both = a.box.high.cwiseMin(b.box.high) - a.box.low.cwiseMax(b.box.low);
    if ((both.array() < least).any()) return 0;
    double deepest = least;
    for (const Vec3& point : b.point) deepest = std::max(deepest, a.depth_at(point));
    for (const Vec3& point : a.point) deepest = std::max(deepest, b.depth_at(point));
    return deepest > least ? deepest : 0;
}

// Rounded first, for surfaces are known as floats: a little less than 1 mm is no 1000 um.
std::string depth_text(double depth) { return rounded_text(depth, Quantity::length, 3); }

// What is worst of its kind, and how many there are.
struct Worst {
    std::string who;
    double value = 0, rank = 0;
    int count = 0;

    void add(const std::string& name, double found, double worse) {
        if (++count == 1 || worse > rank) who = name, value = found, rank = worse;
    }
    // ", and so do 3 other bodies".
    std::string others(const char* one, const char* many) const {
        if (count < 2) return {};
        return fmt::format(", as {} {} other {}", count == 2 ? "does" : "do", count - 1,
                           count == 2 ? one : many);
    }
};

}  // namespace

std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies) {
    if (bodies.size() < 2) return {};
    std::vector<Starting> start(bodies.begin(), bodies.end());
    Worst volume, depth;
    for (std::size_t a = 0; a < start.size(); ++a) {
        for (std::size_t b = a + 1; b < start.size(); ++b) {
            const std::string both = fmt::format("\"{}\" and \"{}\"", start[a].name, start[b].name);
            if (shares_cells(start[a], start[b])) {
                const double shared = shared_volume(start[a], start[b]);
                volume.add(both, shared, shared);
            } else if (const double deep = shared_depth(start[a], start[b]); deep > 0) {
                depth.add(both, deep, deep);
            }
        }
    }
    std::vector<std::string> told;
    if (volume.count > 0) {
        told.push_back(
            fmt::format("{} overlap at the start, by a volume of about {}{}: they will burst "
                        "apart; move them apart with `at`",
                        volume.who, volume_text(volume.value), volume.others("pair", "pairs")));
    }
    if (depth.count > 0) {
        told.push_back(fmt::format(
            "{} start {} deep in each other{}, which throws them apart; move them apart with `at`",
            depth.who, depth_text(depth.value), depth.others("pair", "pairs")));
    }
    return told;
}

std::vector<std::string> tool_overlaps(const Machine& machine,
                                       const std::vector<NamedMatter>& bodies,
                                       bool to_move_as_molded) {
    const TellingOfTools telling(to_move_as_molded);
    const std::size_t first = telling.first;
    std::vector<std::string> told;
    if (bodies.size() <= first || machine.apparatus.tool.empty()) return told;
    const std::vector<Pose> world_from_tool = drive_at(machine, 0, 1).world_from_tool;
    const Vec3 work_piece = machine.frame.world_from_work.translation;
    const auto set_up = [&](std::size_t tool) {
        return fmt::format("tool {} of machine {}", machine.apparatus.tool[tool].name,
                           machine.spec.name);
    };
    std::vector<Worst> deep(world_from_tool.size());
    std::map<std::pair<std::size_t, std::string>, Worst> astray;
    for (std::size_t b = first; b < bodies.size(); ++b) {
        const double least = telling.deep * bodies[b].matter->lattice.spacing;
        const std::vector<Vec3> points = touching_points(*bodies[b].matter);
        const Vec3 middle = box_of(points).center();
        for (std::size_t n = 0; n < world_from_tool.size(); ++n) {
            const Standing standing = standing_at(machine.apparatus.tool[n], world_from_tool[n],
                                                  work_piece, middle, points);
            if (!standing.astray.empty() && b > 0) {
                astray[{n, standing.astray}].add(bodies[b].name, 0, 0);
            } else if (standing.deep > least) {
                deep[n].add(bodies[b].name, standing.deep, standing.deep);
            }
        }
    }
    for (const auto& [where, some] : astray) {
        const std::string others = some.others("body", "bodies");
        told.push_back(fmt::format(
            "\"{}\" starts with its middle{} {} {}, which is placed by the work-piece alone and is "
            "finite, although it is drawn endless: move the {} with `at`, or make the tool larger "
            "or lower",
            some.who, others.empty() ? "" : others + ",", where.second, set_up(where.first),
            some.count == 1 ? "body" : "bodies"));
    }
    for (std::size_t n = 0; n < deep.size(); ++n) {
        if (deep[n].count == 0) continue;
        // The machine goes where the work-piece does.
        const bool is_work_piece = deep[n].who == bodies.front().name;
        told.push_back(fmt::format("\"{}\" starts {} deep in {}{}{}: {}", deep[n].who,
                                   depth_text(deep[n].value), set_up(n),
                                   is_work_piece ? "" : ", which is placed by the work-piece alone",
                                   deep[n].others("body", "bodies"),
                                   is_work_piece        ? "move the tool further away"
                                   : deep[n].count == 1 ? "move it with `at`, or move the tool"
                                                        : "move them with `at`, or move the tool"));
    }
    return told;
}

std::vector<char> start_deep(const Machine& machine, const std::vector<NamedMatter>& bodies,
                             const std::vector<double>& overlaps, bool to_move_as_molded) {
    const TellingOfTools telling(to_move_as_molded);
    const std::vector<Pose> world_from_tool = drive_at(machine, 0, 1).world_from_tool;
    const Vec3 work_piece = machine.frame.world_from_work.translation;
    std::vector<char> deep(bodies.size(), 0);
    for (std::size_t b = telling.first; b < bodies.size(); ++b) {
        const std::vector<Vec3> points = touching_points(*bodies[b].matter);
        const Vec3 middle = box_of(points).center();
        double deepest = to_move_as_molded ? overlaps[b] : 0;
        for (std::size_t n = 0; n < world_from_tool.size(); ++n) {
            deepest = std::max(deepest, standing_at(machine.apparatus.tool[n], world_from_tool[n],
                                                    work_piece, middle, points)
                                            .deep);
        }
        deep[b] = deepest > telling.deep * bodies[b].matter->lattice.spacing;
    }
    return deep;
}

}  // namespace swage
