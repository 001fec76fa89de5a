// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/stand.h"

#include <cmath>

#include "geometry/make_shape.h"
#include "mold/mold.h"

namespace swage {

namespace {

constexpr double kSettled = 1e-5;  // of the largest way gone: what one more frame may move
constexpr int kMostFrames = 200;

double dot(const Vec3Array& a, const Vec3Array& b) {
    double sum = 0;
    for (std::size_t p = 0; p < a.size(); ++p) sum += a.at(p).dot(b.at(p));
    return sum;
}

Vec3Array difference(const Vec3Array& a, const Vec3Array& b) {
    Vec3Array d = a;
    for (std::size_t p = 0; p < d.size(); ++p) d.set(p, a.at(p) - b.at(p));
    return d;
}

}  // namespace

Material unit_material(double poisson_ratio) {
    Material material;
    material.young_modulus = 1;
    material.poisson_ratio = poisson_ratio;
    material.density = 1;
    return material;
}

TriMesh bar_mesh(double length, double side) {
    return make_shape("bar", {{"length", length},
                              {"height", side},
                              {"width", side},
                              {"rounding", 0},
                              {"division", std::ceil(length / side)}})
        .mesh;
}

Aggregate unit_mold(const TriMesh& mesh, int across, const Material& material) {
    MoldSettings settings;
    settings.spacing = 1.0 / across;
    return mold(mesh, material, settings);
}

Aggregate block_of(const Vec3& size, double spacing, const Material& material) {
    MoldSettings settings;
    settings.spacing = spacing;
    return mold(make_shape("bar", {{"length", size.x()},
                                   {"height", size.y()},
                                   {"width", size.z()},
                                   {"rounding", 0},
                                   {"division", std::round(size.x() / spacing)}})
                    .mesh,
                material, settings);
}

Aggregate unit_bar(double length, int across, Material material) {
    return unit_mold(bar_mesh(length, 1), across, material);
}

TriMesh turned(TriMesh mesh, const Quat& rotation) {
    for (Vec3& p : mesh.position) p = rotation * p;
    return mesh;
}

std::vector<int> end_face(const Aggregate& matter, const Vec3& outward) {
    const SurfacePoints& surface = matter.surface;
    double farthest = -std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < surface.size(); ++p) {
        farthest = std::max(farthest, outward.dot(matter.surface_reference(p)));
    }
    const double slack = 0.05 * matter.lattice.spacing;
    std::vector<int> points;
    for (std::size_t p = 0; p < surface.size(); ++p) {
        if (outward.dot(surface.normal(p)) > 0.9 &&
            outward.dot(matter.surface_reference(p)) > farthest - slack) {
            points.push_back(static_cast<int>(p));
        }
    }
    return points;
}

double area_of(const Aggregate& matter, const std::vector<int>& points) {
    double area = 0;
    for (int p : points) area += matter.surface.area(p);
    return area;
}

Vec3 mean_position(const Aggregate& matter, const std::vector<int>& points) {
    Vec3 sum = Vec3::Zero();
    for (int p : points) sum += matter.surface.area(p) * matter.surface_position(p);
    return sum / area_of(matter, points);
}

Vec3 mean_move(const Aggregate& matter, const std::vector<int>& points) {
    Vec3 sum = Vec3::Zero();
    for (int p : points) {
        sum += matter.surface.area(p) * (matter.surface_position(p) - matter.surface_reference(p));
    }
    return sum / area_of(matter, points);
}

Drive at_time(double time, const std::vector<Pose>& world_from_tool) {
    Drive drive;
    drive.time = time;
    drive.world_from_tool = world_from_tool;
    return drive;
}

Stand::Stand(Aggregate body, double tolerance, const Vec3& gravity) : matter(std::move(body)) {
    apparatus.name = "verify";
    settings_.tolerance = tolerance;
    settings_.grip_stiffness = 100;
    settings_.gravity = gravity;
}

int Stand::grip(const std::vector<int>& points, const Vec3& hold) {
    Grip grip;
    grip.name = "grip " + std::to_string(apparatus.grip.size() + 1);
    grip.point = points;
    grip.hold = hold;
    const Pose pose{Quat::Identity(), mean_position(matter, points)};
    for (int p : points) grip.anchor.push_back(matter.surface_position(p) - pose.translation);
    apparatus.grip.push_back(std::move(grip));
    drive.world_from_grip.push_back(pose);
    return static_cast<int>(apparatus.grip.size()) - 1;
}

int Stand::load(const std::vector<int>& points, const Vec3& force) {
    Load load;
    load.name = "load " + std::to_string(apparatus.load.size() + 1);
    load.point = points;
    const double area = area_of(matter, points);
    for (int p : points) load.force.push_back(matter.surface.area(p) / area * force);
    apparatus.load.push_back(std::move(load));
    drive.load_strength.push_back(1);
    return static_cast<int>(apparatus.load.size()) - 1;
}

int Stand::press(const std::vector<int>& points, double pressure, bool closed) {
    Load load;
    load.name = "load " + std::to_string(apparatus.load.size() + 1);
    load.point = points;
    load.pressure = pressure;
    load.closed = closed;
    apparatus.load.push_back(std::move(load));
    drive.load_strength.push_back(1);
    return static_cast<int>(apparatus.load.size()) - 1;
}

FrameReport Stand::move(const Drive& to) {
    if (!simulation_) simulation_ = std::make_unique<Simulation>(matter, apparatus, settings_);
    FrameReport report = simulation_->advance(drive, to);
    drive = to;
    return report;
}

void Stand::start_from(const Aggregate& coarse) {
    const Lattice& lattice = coarse.lattice;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 at = (matter.particle_reference.at(p) - lattice.origin) / lattice.spacing;
        const Vec3i site =
            at.array().floor().cast<int>().max(0).min(lattice.cell_count.array() - 1);
        const CellId cell = lattice.cell_at(site);
        if (cell < 0) continue;
        const Vec3 local = at - site.cast<double>();
        const auto corner = lattice.cell_corners(cell);
        Vec3 x = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
            double weight = 1;
            for (int axis = 0; axis < 3; ++axis) {
                weight *= c >> axis & 1 ? local[axis] : 1 - local[axis];
            }
            x += weight * coarse.particle_position.at(corner[c]);
        }
        matter.particle_position.set(p, x);
    }
}

FrameReport Stand::settle() {
    FrameReport report;
    Vec3Array last;
    bool jumps = true;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& material = matter.material_at(m);
        jumps = jumps && std::isinf(material.yield_stress) && !material.breaks();
    }
    for (int frame = 0; frame < kMostFrames; ++frame) {
        const Vec3Array before = matter.particle_position;
        report = move(drive);
        Vec3Array way = difference(matter.particle_position, before);
        const Vec3Array whole =
            difference(matter.particle_position, matter.particle_reference.all());
        const double square = dot(way, way);
        if (square <= kSettled * kSettled * dot(whole, whole)) break;
        // What is left shrinks by about the same share a frame: go to where that ends.
        const double share = last.size() ? dot(way, last) / dot(last, last) : 0;
        if (jumps && share > 0.02 && share < 0.98) {
            for (std::size_t p = 0; p < way.size(); ++p) {
                matter.particle_position.add(p, share / (1 - share) * way.at(p));
            }
            way.resize(0);
        }
        last = std::move(way);
    }
    return report;
}

namespace {

// Surface points of the slice within `half` of s, along the axis at molding.
std::vector<int> points_near(const Aggregate& matter, const Vec3& along, double s, double half) {
    std::vector<int> points;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const double at = along.dot(matter.surface_reference(p));
        if (std::abs(at - s) <= half) points.push_back(static_cast<int>(p));
    }
    return points;
}

}  // namespace

Mat3 mean_gradient(const Aggregate& matter, const Vec3& along, double s, double half) {
    const SurfacePoints& surface = matter.surface;
    const std::vector<int> points = points_near(matter, along, s, half);
    const Vec3 to = mean_position(matter, points), from = to - mean_move(matter, points);
    Mat3 square = Mat3::Zero(), mixed = Mat3::Zero();
    for (int p : points) {
        const Vec3 r = matter.surface_reference(p) - from;
        square += surface.area(p) * r * r.transpose();
        mixed += surface.area(p) * (matter.surface_position(p) - to) * r.transpose();
    }
    return mixed * square.inverse();
}

Slice slice_of(const Aggregate& matter, const Vec3& along, double s, double half,
               const Vec3& about) {
    const std::vector<int> points = points_near(matter, along, s, half);
    const Vec3 from = mean_position(matter, points) - mean_move(matter, points);
    const Mat3 f = mean_gradient(matter, along, s, half);
    const Vec3 e1 = about.unitOrthogonal(), e2 = about.cross(e1);
    return {along.dot(from),
            std::atan2(e2.dot(f * e1) - e1.dot(f * e2), e1.dot(f * e1) + e2.dot(f * e2))};
}

double turn_rate(const Aggregate& matter, const Vec3& along, double s, double half,
                 const Vec3& about) {
    const Slice low = slice_of(matter, along, -s, half, about);
    const Slice high = slice_of(matter, along, s, half, about);
    return (high.angle - low.angle) / (high.place - low.place);
}

double middle_curvature(const Aggregate& bar) {
    return turn_rate(bar, Vec3::UnitX(), 1.5, 0.5, -Vec3::UnitY());
}

}  // namespace swage
