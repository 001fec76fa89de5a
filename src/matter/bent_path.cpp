// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/bent_path.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr double kFlat = 1e-3;     // cells, or radians, that do not count as bent
constexpr double kGoesOn = 0.1;    // cells that a plane may lie beside another's path
constexpr double kSupport = 1.25;  // cells along the path that tell of it
constexpr double kFew = 1e-3;      // of squared cells, so that few points do not bend it
constexpr int kTurns = 3;          // until it is seen from its foot

struct Member {
    Vec3 place, normal;  // as the first of its path looks
};

// Of two places of a circle the mean of the normals is square to the way between them.
bool goes_on(const Vec3& place, const Vec3& normal, const Vec3& to, const Vec3& normal_there) {
    return normal.dot(normal_there) > kOneWay &&
           std::abs((normal + normal_there).dot(to - place)) < 2 * kGoesOn;
}

CutPlane fit(const Vec3& place, const std::vector<Member>& path) {
    CutPlane plane{path[0].place, path[0].normal};
    plane.is_flat = false;
    Vec3 n = path[0].normal;
    for (int turn = 0; turn < kTurns; ++turn) {
        struct Seen {
            double weight, height;
            Vec3 along, slope;
        };
        thread_local std::vector<Seen> seen;
        seen.clear();
        double sum = 0;
        Vec3 middle = Vec3::Zero(), mean = Vec3::Zero();
        for (const Member& m : path) {
            const Vec3 way = m.place - place;
            const double height = n.dot(way), faces = n.dot(m.normal);
            const Vec3 along = way - height * n;
            const double left = 1 - along.squaredNorm() / (kSupport * kSupport);
            if (left <= 0 || faces < 0.5) continue;
            seen.push_back({left * left, height, along, n - m.normal / faces});
            sum += seen.back().weight;
            middle += seen.back().weight * along;
            mean += seen.back().weight * seen.back().slope;
        }
        if (sum < kFew) return plane;  // the path has ended before
        middle /= sum;
        mean /= sum;
        Mat3 spread = sum * kFew * Mat3::Identity(), turned = Mat3::Zero();
        for (const Seen& s : seen) {
            const Vec3 off = s.along - middle;
            spread += s.weight * off * off.transpose();
            turned += s.weight * (s.slope - mean) * off.transpose();
        }
        const Mat3 by = turned * spread.inverse(), bend = 0.5 * (by + by.transpose());
        const Vec3 slope = mean - bend * middle;
        double height = 0;
        for (const Seen& s : seen) {
            height += s.weight * (s.height - s.along.dot(slope + 0.5 * (bend * s.along)));
        }
        height /= sum;
        plane.place = place + height * n;
        plane.normal = n;
        plane.bend = bend;
        if (turn + 1 < kTurns) n = (n - slope).normalized();
    }
    return plane;
}

}  // namespace

bool bends(std::span<const CutPlane> planes, std::span<const CutPlane> near) {
    for (const CutPlane& plane : planes) {
        for (const CutPlane& other : near) {
            const double same = plane.normal.dot(other.normal);
            const Vec3 normal = same < 0 ? -other.normal : other.normal;
            if (!goes_on(plane.place, plane.normal, other.place, normal)) continue;
            const double off = std::abs(plane.normal.dot(other.place - plane.place));
            if (off > kFlat || (normal - plane.normal).squaredNorm() > kFlat * kFlat) return true;
        }
    }
    return false;
}

std::vector<CutPlane> bent_paths(const Vec3& place, std::span<const CutPlane> near,
                                 std::size_t most) {
    std::vector<std::vector<Member>> paths;
    for (const CutPlane& plane : near) {
        bool is_new = true;
        for (std::vector<Member>& path : paths) {
            for (const Member& m : path) {
                const Vec3 normal = m.normal.dot(plane.normal) < 0 ? -plane.normal : plane.normal;
                if (!goes_on(m.place, m.normal, plane.place, normal)) continue;
                path.push_back({plane.place, normal});
                is_new = false;
                break;
            }
            if (!is_new) break;
        }
        if (is_new && paths.size() < most) paths.push_back({{plane.place, plane.normal}});
    }
    std::vector<CutPlane> planes;
    for (const std::vector<Member>& path : paths) planes.push_back(fit(place, path));
    return planes;
}

}  // namespace swage
