// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/motion_vectors.h"

#include <optional>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 512;

// In pixels, y up; none where it is not before the eye.
std::optional<Vec2> pixel_of(const Vec3& place, const View& view, const Lens& lens, int width,
                             int height) {
    const Vec3 seen = view.in_view(place);
    if (!(seen.z() < 0)) return std::nullopt;
    return Vec2(0.5 * width * (seen.x() / (-seen.z() * lens.tangent_x)),
                0.5 * height * (seen.y() / (-seen.z() * lens.tangent_y)));
}

// Shares of the corners in a place on the triangle.
Vec3 weights_at(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = (b - a).cross(c - a);
    const double area2 = normal.squaredNorm();
    if (!(area2 > 0)) return Vec3::Constant(1.0 / 3);
    const double of_b = (place - a).cross(c - a).dot(normal) / area2;
    const double of_c = (b - a).cross(place - a).dot(normal) / area2;
    return {1 - of_b - of_c, of_b, of_c};
}

// Where `place`, of that triangle of the item, is in the other still.
Vec3 moved_place(const Vec3& place, const DrawItem& item, int triangle, const MovedItem& then) {
    const Pose& pose = item.world_from_mesh;
    const Vec3 own = pose.inverse() * place;
    Vec3 shift = Vec3::Zero();
    if (!then.position.empty() && triangle >= 0) {
        const std::vector<Vec3>& here = item.position ? *item.position : item.mesh->position;
        const Corners& corner = item.mesh->triangle.at(std::size_t(triangle));
        const Vec3 weight = weights_at(own, here[corner[0]], here[corner[1]], here[corner[2]]);
        for (int c = 0; c < 3; ++c)
            shift += weight[c] * (then.position[corner[c]] - here[corner[c]]);
    }
    // What stands still does so to the last bit.
    const bool is_there = then.pose.translation == pose.translation &&
                          then.pose.rotation.coeffs() == pose.rotation.coeffs();
    return is_there ? place + pose.turn(shift) : then.pose * (own + shift);
}

}  // namespace

std::vector<Eigen::Vector4f> motion_of(const Layers& layers, const Picture& picture,
                                       const View& view, const Lens& lens,
                                       const MovedPicture* after, const MovedPicture* before) {
    const int width = layers.width, height = layers.height;
    std::vector<Eigen::Vector4f> motion(layers.item.size(), Eigen::Vector4f::Zero());
    parallel_each(motion.size(), 8 * kChunk, [&](std::size_t i) {
        const int item = layers.item[i];
        if (item == kNothingThere) return;
        const double x = static_cast<double>(i % std::size_t(width)) + 0.5,
                     y = static_cast<double>(i / std::size_t(width)) + 0.5;
        const Vec3 ahead(lens.tangent_x * (2 * x / width - 1),
                         lens.tangent_y * (1 - 2 * y / height), -1);
        const Vec3 place = view.eye + double(layers.depth[i]) * (view.world_from_view * ahead);
        const std::optional<Vec2> from = pixel_of(place, view, lens, width, height);
        for (const MovedPicture* then : {after, before}) {
            if (then == nullptr || !from) continue;
            const Vec3 moved =
                item == kGroundThere
                    ? place
                    : moved_place(place, picture.item.at(std::size_t(item)), layers.triangle.at(i),
                                  then->item.at(std::size_t(item)));
            const std::optional<Vec2> to = pixel_of(moved, then->view, lens, width, height);
            if (!to) continue;
            motion[i].segment<2>(then == after ? 0 : 2) = (*to - *from).cast<float>();
        }
    });
    return motion;
}

}  // namespace swage
