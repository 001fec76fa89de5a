// SPDX-License-Identifier: GPL-3.0-or-later
// What every mold must keep of its mesh.
#pragma once

#include "mold/mold.h"
#include "mold/shares.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

namespace swage::test {

inline Aggregate mold_across(const TriMesh& mesh, int across) {
    MoldSettings settings;
    settings.across = across;
    return mold(mesh, {}, settings);
}

inline Pose some_turn() {
    return {
        Quat(Eigen::AngleAxisd(0.5236, Vec3::UnitZ()) * Eigen::AngleAxisd(0.349, Vec3::UnitY())),
        {0.3, -0.2, 0.71}};
}

// First moments of the mesh's inside over its volume.
inline Vec3 mesh_centroid(const TriMesh& mesh) {
    const Vec3 about = box_of(mesh.position).center();
    double volume = 0;
    Vec3 moment = Vec3::Zero();
    for (const Corners& t : mesh.triangle) {
        const Vec3 a = mesh.position[t[0]] - about, b = mesh.position[t[1]] - about,
                   c = mesh.position[t[2]] - about;
        const double v = a.dot(b.cross(c)) / 6;
        volume += v;
        moment += v / 4 * (a + b + c);
    }
    return about + moment / volume;
}

inline Vec3 matter_centroid(const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    double fill = 0;
    Vec3 moment = Vec3::Zero();
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const Vec3 site = lattice.cell_site(static_cast<CellId>(c)).cast<double>();
        const Vec3 centroid = matter.cell_centroid[c].cast<double>();
        fill += matter.cell_fill[c];
        moment += matter.cell_fill[c] * (site.array() + 0.5 + centroid.array()).matrix();
    }
    return lattice.origin + lattice.spacing * moment / fill;
}

// Volume, mass, surface and centroid are the mesh's; shares lie where they must.
inline void check_matter(const TriMesh& mesh, const Aggregate& matter) {
    const double volume = signed_volume(mesh);
    CHECK(matter.volume() == Approx(volume).epsilon(1e-6));
    CHECK(matter.mass() == Approx(volume * matter.material.density).epsilon(1e-6));
    double area = 0;
    double farthest = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        area += matter.surface.area(p);
        farthest =
            std::max(farthest, (matter.surface_position(p) - matter.surface_reference(p)).norm());
    }
    CHECK(area == Approx(surface_area(mesh)).epsilon(1e-9));
    CHECK(farthest < 1e-6 * (matter.lattice.spacing + box_of(mesh.position).high.norm()));
    CHECK((matter_centroid(matter) - mesh_centroid(mesh)).norm() < 1e-4 * matter.lattice.spacing);
    float least = 1, most = 0, off_center = 0;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        least = std::min(least, matter.cell_fill[c]);
        most = std::max(most, matter.cell_fill[c]);
        off_center = std::max(off_center, matter.cell_centroid[c].cwiseAbs().maxCoeff());
    }
    CHECK(least >= 0.999f * static_cast<float>(kLeastFill));
    CHECK(most <= 1.05);
    CHECK(off_center <= 0.5f);
    double lightest = 1;
    for (double m : matter.particle_mass) lightest = std::min(lightest, m);
    CHECK(lightest > 0);
}

}  // namespace swage::test
