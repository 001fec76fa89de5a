// SPDX-License-Identifier: GPL-3.0-or-later
// Where what is seen goes in the picture.
#include "pipeline/motion_vectors.h"

#include "geometry/box_mesh.h"
#include "pipeline/surface_match.h"
#include "skin/divided_mesh.h"
#include "tests/render/drawn.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

constexpr int kWidth = 160, kHeight = 120;

// From the eye at z = 5 along -z.
RenderSettings from_ahead() {
    RenderSettings settings = small_picture();
    settings.passes = {PicturePass::motion};
    settings.ground = false;
    settings.camera[0].eye = Vec3(0, 0.5, 5);
    settings.camera[0].target = Vec3(0, 0.5, 0);
    return settings;
}

View view_of(const RenderSettings& settings) {
    return look_at(*settings.camera[0].eye, *settings.camera[0].target);
}

Layers layers_of_picture(const RenderSettings& settings, const Picture& picture) {
    Renderer renderer(settings, kAction, 0);
    Layers layers;
    renderer.draw(picture, &layers);
    return layers;
}

// Pixels a metre at a depth.
double scale_at(const RenderSettings& settings, double depth) {
    return 0.5 * kHeight / (depth * std::tan(0.5 * settings.field_of_view));
}

TriMesh box() { return box_mesh(Vec3(-0.4, -0.3, -0.25), Vec3(0.4, 0.3, 0.25)); }

std::vector<Vec3> moved_by(std::vector<Vec3> place, const Vec3& way) {
    for (Vec3& p : place) p += way;
    return place;
}

}  // namespace

TEST_CASE("what goes to the right and up has motion so, in pixels, and what stands has none") {
    if (!can_draw()) return;
    const RenderSettings settings = from_ahead();
    const TriMesh mesh = box();
    const Vec3 way(0.1, 0.07, 0);
    // A tool, by its pose, and a skin, by its places.
    const bool is_tool = GENERATE(false, true);
    const std::vector<Vec3> here = moved_by(mesh.position, {0, 0.5, 0});
    const Pose pose{Quat::Identity(), {0, 0.5, 0}};
    Picture picture;
    picture.item = {is_tool ? DrawItem{&mesh, nullptr, pose, {}} : DrawItem{&mesh, &here, {}, {}}};
    const View view = view_of(settings);
    const auto then = [&](const Vec3& by) {
        MovedItem item;
        if (is_tool) {
            item.pose = {Quat::Identity(), pose.translation + by};
        } else {
            item.position = moved_by(here, by);
        }
        return MovedPicture{view, {item}};
    };
    const MovedPicture after = then(way), before = then({0, -0.2, 0}), still = then({0, 0, 0});
    const Layers layers = layers_of_picture(settings, picture);
    const std::vector<Eigen::Vector4f> motion =
        motion_of(layers, picture, view, lens_of(settings), &after, &before);
    const double scale = scale_at(settings, 5 - 0.25);
    int seen = 0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
        if (layers.item[i] == kNothingThere) {
            REQUIRE(motion[i] == Eigen::Vector4f::Zero());
            continue;
        }
        ++seen;
        CHECK(motion[i][0] == Approx(way.x() * scale).epsilon(1e-4));
        CHECK(motion[i][1] == Approx(way.y() * scale).epsilon(1e-4));
        CHECK(motion[i][2] == Approx(0).margin(1e-4));
        CHECK(motion[i][3] == Approx(-0.2 * scale).epsilon(1e-4));
    }
    CHECK(seen > 700);
    for (const Eigen::Vector4f& one :
         motion_of(layers, picture, view, lens_of(settings), &still, nullptr)) {
        REQUIRE(one == Eigen::Vector4f::Zero());
    }
}

TEST_CASE("motion leads to the pixel of the next still that shows the same place") {
    if (!can_draw()) return;
    // A ball of few faces that turns and is drawn along, a tool that turns, ground, and a camera
    // that goes round.
    RenderSettings settings = small_picture();
    settings.passes = {PicturePass::motion};
    settings.camera[0].eye = Vec3(0.3, 1.6, 4);
    settings.camera[0].target = Vec3(0, 0.3, 0);
    const TriMesh ball = test::sphere_mesh(0.35, 0), tool = box();
    const auto places = [&](double turn) {
        std::vector<Vec3> all;
        const Quat by(Eigen::AngleAxisd(turn, Vec3::UnitY()));
        for (const Vec3& p : ball.position) {
            all.push_back(by * Vec3(p.x() * (1 + turn), p.y(), p.z()) + Vec3(-0.5, 0.4, turn));
        }
        return all;
    };
    const auto pose = [](double turn) {
        return Pose{Quat(Eigen::AngleAxisd(1 + turn, Vec3(1, 1, 0).normalized())),
                    {0.6 - turn, 0.5, 0}};
    };
    const std::vector<Vec3> here = places(0), there = places(0.1);
    const Picture now{{{&ball, &here, {}, {}}, {&tool, nullptr, pose(0), {}}}, 0};
    const Picture next{{{&ball, &there, {}, {}}, {&tool, nullptr, pose(0.1), {}}}, 0};
    RenderSettings later = settings;
    later.camera[0].eye = Vec3(0.6, 1.5, 3.9);
    const Layers layers = layers_of_picture(settings, now), shown = layers_of_picture(later, next);
    const MovedPicture after{view_of(later), {{{}, there}, {pose(0.1), {}}}};
    const std::vector<Eigen::Vector4f> motion =
        motion_of(layers, now, view_of(settings), lens_of(settings), &after, nullptr);
    int count[3] = {}, right[3] = {};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const std::size_t i = std::size_t(y) * kWidth + std::size_t(x);
            const int item = layers.item[i];
            if (item == kNothingThere) continue;
            const int tx = static_cast<int>(std::floor(double(x) + 0.5 + double(motion[i][0])));
            const int ty = static_cast<int>(std::floor(double(y) + 0.5 - double(motion[i][1])));
            if (tx < 0 || ty < 0 || tx >= kWidth || ty >= kHeight) continue;
            const std::size_t j = std::size_t(ty) * kWidth + std::size_t(tx);
            const std::size_t kind = item == kGroundThere ? 2 : std::size_t(item);
            ++count[kind];
            right[kind] += shown.item[j] == item &&
                           (item < 0 || kind == 1 || layers.triangle[i] == shown.triangle[j]);
        }
    }
    for (std::size_t kind = 0; kind < 3; ++kind) {
        INFO(kind << ": " << right[kind] << " of " << count[kind]);
        CHECK(count[kind] > 600);
        // But for what is hidden then, and pixels that a triangle's edge goes through.
        CHECK(right[kind] > 0.8 * count[kind]);
    }
}

TEST_CASE("a skin that is another in the next frame moves as its places do") {
    const TriMesh now = box(), finer = divide_edges(now, 0.1);
    const auto bent = [](const TriMesh& mesh) {
        std::vector<Vec3> place;
        for (const Vec3& p : mesh.position) place.push_back(p + Vec3(0, 0.3 * p.x() + 2, 0));
        return place;
    };
    REQUIRE(finer.position.size() > 2 * now.position.size());
    for (const auto& [one, other] : {std::pair(&now, &finer), {&finer, &now}}) {
        const std::vector<Vec3> here = moved_by(one->position, {0.2, 0, 0}), there = bent(*other),
                                right = bent(*one),
                                carried = carried_places(*one, here, *other, there);
        REQUIRE(carried.size() == one->position.size());
        for (std::size_t i = 0; i < carried.size(); ++i) {
            CHECK((carried[i] - right[i]).norm() < 1e-12);
        }
        // Molded anew where it stood: `here` is where the other was mounted.
        TriMesh anew = *other;
        anew.position = moved_by(other->position, {0.2, 0, 0});
        const std::vector<Vec3> from_there = carried_places(*one, here, anew, there);
        for (std::size_t i = 0; i < carried.size(); ++i) {
            CHECK((from_there[i] - right[i]).norm() < 1e-12);
        }
    }
}

TEST_CASE("a skin without faces, or of which none was before, has nowhere to move to") {
    const TriMesh now = box();
    TriMesh none = now;
    none.triangle.clear();
    CHECK(carried_places(none, none.position, now, now.position) == none.position);
    CHECK(carried_places(now, now.position, none, none.position) == now.position);
}

TEST_CASE("faces of pieces that lay on each other move each with its own piece") {
    const TriMesh left = box_mesh(Vec3(-1, 0, 0), Vec3(0, 1, 1)),
                  right = box_mesh(Vec3(0, 0, 0), Vec3(0.6, 1, 1));
    const TriMesh whole = box_mesh(Vec3(-1, 0, 0), Vec3(0.6, 1, 1)),
                  parted = test::together(left, right),
                  swapped = test::together(divide_edges(right, 0.3), divide_edges(left, 0.3));
    const auto apart = [](const TriMesh& mesh) {
        const Components shells = surface_components(mesh);
        std::vector<Vec3> place = mesh.position;
        std::vector<double> middle(std::size_t(shells.count), 0.0);
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
            for (const int v : mesh.triangle[t]) {
                middle[std::size_t(shells.triangle_component[t])] += mesh.position[v].x();
            }
        }
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
            const double side = middle[std::size_t(shells.triangle_component[t])] < 0 ? -1 : 1;
            for (const int v : mesh.triangle[t]) {
                place[v] = mesh.position[v] + side * Vec3(0.2, 0.5, 0);
            }
        }
        return place;
    };
    for (const auto& [now, other] : {std::pair(&parted, &swapped), {&swapped, &parted}}) {
        const std::vector<Vec3> right_places = apart(*now),
                                carried =
                                    carried_places(*now, now->position, *other, apart(*other));
        for (std::size_t i = 0; i < carried.size(); ++i) {
            INFO(now->position[i].transpose());
            CHECK((carried[i] - right_places[i]).norm() < 1e-12);
        }
    }
    // Back to when they were one.
    const std::vector<Vec3> back =
        carried_places(swapped, apart(swapped), whole, moved_by(whole.position, {0, 3, 0}));
    for (std::size_t i = 0; i < back.size(); ++i) {
        const Vec3& p = swapped.position[i];
        if (std::abs(p.x()) < 1e-9 && p.y() * (1 - p.y()) * p.z() * (1 - p.z()) > 1e-9) continue;
        CHECK((back[i] - p - Vec3(0, 3, 0)).norm() < 1e-12);
    }
}
