// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/bent_faces.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace swage {

namespace {

constexpr double kTouch = 0.05;    // cells that a path may seem to go into one beside it
constexpr double kSeen = 3.3;      // cells from corners
constexpr double kSamePath = 0.7;  // cosine between tangent planes at two corners

}  // namespace

std::array<const std::vector<CutPlane>*, 8> PathsAtCorners::of(const Vec3i& site) {
    std::array<const std::vector<CutPlane>*, 8> all;
    for (int c = 0; c < 8; ++c) {
        const Vec3i corner = site + corner_step(c);
        const auto [known, is_new] = seen_.try_emplace(key_of(corner));
        if (is_new) known->second = cuts_->around(corner.cast<double>(), kSeen);
        all[c] = &known->second;  // stays where it is
    }
    return all;
}

// Of a whole cell as it looks at them, of others to either side.
BentFaces::Faces BentFaces::faces_of(const Vec3i& site, const std::vector<CutPlane>* near,
                                     PathsAtCorners& paths) {
    const Vec3 middle = site.cast<double>() + Vec3::Constant(0.5);
    const auto outward = [&](const CutPlane& plane) -> Vec3 {
        return plane.height(middle) < 0 ? plane.normal : -plane.normal;
    };
    Faces all;
    const auto at_corner = paths.of(site);
    for (int c = 0; c < 8; ++c) {
        for (const CutPlane& plane : *at_corner[c]) {
            Vec3 n = outward(plane);
            const auto along = [&](const Face& face) {
                return face.slope[std::size_t(std::countr_zero(unsigned(face.known)))].dot(n);
            };
            auto face = std::ranges::find_if(all, [&](const Face& one) {
                return (near != nullptr ? along(one) : std::abs(along(one))) > kSamePath;
            });
            if (face == all.end()) {
                if (near != nullptr && std::ranges::none_of(*near, [&](const CutPlane& one) {
                        return outward(one).dot(n) > kSamePath;
                    })) {
                    continue;
                }
                face = all.emplace(all.end());
            } else if (face->known >> c & 1) {
                continue;
            } else if (along(*face) < 0) {
                n = -n;
            }
            face->known |= 1 << c;
            face->depth[c] = n.dot((site + corner_step(c)).cast<double>() - plane.place);
            face->slope[c] = n;
        }
    }
    for (Face& face : all) {  // corners that do not see it, from the nearest that do
        for (int c = 0; c < 8; ++c) {
            if (face.known >> c & 1) continue;
            int from = -1;
            const auto steps = [&](int other) { return std::popcount(unsigned(other ^ c)); };
            for (int other = 0; other < 8; ++other) {
                if ((face.known >> other & 1) == 0) continue;
                if (from < 0 || steps(other) < steps(from)) from = other;
            }
            const Vec3 way = (corner_step(c) - corner_step(from)).cast<double>();
            face.depth[c] = face.depth[from] + face.slope[from].dot(way);
            face.slope[c] = face.slope[from];
        }
    }
    return all;
}

int BentFaces::add(const Vec3i& site, const std::vector<CutPlane>& near, PathsAtCorners& paths) {
    Faces faces = faces_of(site, &near, paths);
    std::erase_if(faces,
                  [](const Face& face) { return *std::ranges::max_element(face.depth) > kTouch; });
    if (faces.empty()) return -1;
    face_.push_back(std::move(faces));
    site_.push_back(site);
    return static_cast<int>(site_.size()) - 1;
}

void BentFaces::add_beside(const Lattice& lattice, const std::vector<char>& is_whole,
                           PathsAtCorners& paths) {
    std::unordered_map<std::uint64_t, int> number;  // looked up only
    for (const Vec3i& site : site_) {
        beside_.emplace_back().fill(-1);
        for (int n = 0; n < 27; ++n) {
            const Vec3i at = site + neighbor_step(n);
            const CellId cell = lattice.cell_at(at);
            if (cell < 0 || is_whole[cell]) continue;
            const auto [known, is_new] =
                number.try_emplace(key_of(at), static_cast<int>(face_.size()));
            if (is_new) face_.push_back(faces_of(at, nullptr, paths));
            beside_.back()[n] = known->second;
        }
    }
}

SurfaceDepth BentFaces::Face::at(const Vec3& p) const {
    const Vec3 q = Vec3::Ones() - p;
    SurfaceDepth all{0, Vec3::Zero()};
    for (int c = 0; c < 8; ++c) {
        const Vec3i step = corner_step(c);
        const Vec3 w(step.x() ? p.x() : q.x(), step.y() ? p.y() : q.y(), step.z() ? p.z() : q.z());
        const double weight = w.prod();
        const double here = depth[c] + 0.5 * slope[c].dot(p - step.cast<double>());
        const Vec3 rise((step.x() ? 1 : -1) * w.y() * w.z(), (step.y() ? 1 : -1) * w.z() * w.x(),
                        (step.z() ? 1 : -1) * w.x() * w.y());
        all.distance += weight * here;
        all.gradient += here * rise + 0.5 * weight * slope[c];
    }
    return all;
}

SurfaceDepth BentFaces::at(int number, const Vec3& place) const {
    const Vec3i out = (place.array() > 1).cast<int>() - (place.array() < 0).cast<int>();
    const int there = beside_[number][13 + out.x() + 3 * out.y() + 9 * out.z()];
    SurfaceDepth nearest;
    bool is_first = true;
    for (const Face& face : face_[number]) {
        const Face* told = nullptr;
        double same = kSamePath;
        for (std::size_t n = 0; there >= 0 && n < face_[there].size(); ++n) {
            const double along = face_[there][n].slope[0].dot(face.slope[0]);
            if (std::abs(along) <= std::abs(same)) continue;
            same = along;
            told = &face_[there][n];
        }
        SurfaceDepth depth =
            told != nullptr ? told->at(place - out.cast<double>()) : face.at(place);
        if (same < 0) depth = {-depth.distance, -depth.gradient};
        if (is_first || depth.distance > nearest.distance) nearest = depth;
        is_first = false;
    }
    return nearest;
}

}  // namespace swage
