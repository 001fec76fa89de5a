// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "render/camera.h"
#include "render/camera_change.h"
#include "render/studio.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// How far the farthest corner reaches in the picture: 1 is the edge.
double reach(const RenderSettings& settings, const Box& box, const View& view) {
    const glm::dmat4 m =
        clip_from_view(lens_of(settings), depth_range(box, view)) * view_from_world(view);
    double most = 0;
    for (const Vec3& corner : corners_of(box)) {
        const glm::dvec4 c = m * glm::dvec4(to_glm(corner), 1);
        if (!(c.w > 0)) return 1e9;
        most = std::max({most, std::abs(c.x / c.w), std::abs(c.y / c.w)});
    }
    return most;
}

const std::vector<Box> kBoxes = {
    {{-1, -1, -1}, {1, 1, 1}},
    {{0, 0, 0}, {10, 0.1, 0.3}},
    {{1e3, -5, 2}, {1e3 + 1e-3, -4.99, 2.01}},
    {{-0.2, 0, -4}, {0.2, 7, 4}},
};

}  // namespace

TEST_CASE("all corners of the action are in the picture, and fill it", "[camera]") {
    for (const Box& box : kBoxes) {
        for (const auto& [width, height] : {std::pair(1280, 720), {200, 800}, {500, 500}}) {
            for (const double azimuth : {0.0, 0.7, 2.5, -1.57}) {
                for (const double elevation : {-kPi / 2, -0.4, 0.0, 0.35, 1.2, kPi / 2}) {
                    RenderSettings settings;
                    settings.width = width;
                    settings.height = height;
                    settings.camera = {{0, azimuth, elevation, 1, {}, {}}};
                    const View view = CameraPath(settings, box).at(0);
                    CHECK(reach(settings, box, view) == Approx(1 / kFramingMargin).epsilon(1e-6));
                }
            }
        }
    }
}

TEST_CASE("what is to be free at the bottom of a picture is, and the rest is filled", "[camera]") {
    for (const Box& box : kBoxes) {
        for (const auto& [width, height] : {std::pair(1280, 720), {200, 800}}) {
            RenderSettings settings;
            settings.width = width;
            settings.height = height;
            settings.free_below = 0.2;
            const View view = CameraPath(settings, box).at(0);
            const glm::dmat4 m =
                clip_from_view(lens_of(settings), depth_range(box, view)) * view_from_world(view);
            double lowest = 1, highest = -1, aside = 0;
            for (const Vec3& corner : corners_of(box)) {
                const glm::dvec4 c = m * glm::dvec4(to_glm(corner), 1);
                lowest = std::min(lowest, c.y / c.w), highest = std::max(highest, c.y / c.w);
                aside = std::max(aside, std::abs(c.x / c.w));
            }
            const double room = 1 - 1 / kFramingMargin;
            CHECK(lowest > -1 + 2 * 0.2 + room - 1e-6);
            CHECK(highest < 1 - room + 1e-6);
            CHECK(std::max((highest - lowest) / (2 - 0.4 - 2 * room), aside * kFramingMargin) ==
                  Approx(1).epsilon(0.02));
        }
    }
}

TEST_CASE("zoom 2 stands twice as near", "[camera]") {
    const Box box = kBoxes[0];
    RenderSettings settings;
    settings.camera = {{0, 0.3, 0.2, 1, {}, {}}};
    const View one = CameraPath(settings, box).at(0);
    settings.camera[0].zoom = 2;
    const View two = CameraPath(settings, box).at(0);
    CHECK(-one.in_view(box.center()).z() == Approx(-2 * two.in_view(box.center()).z()));
}

TEST_CASE("zoom brings the eye neither into what it frames nor up against it", "[camera]") {
    for (const Box& box : kBoxes) {
        for (const double azimuth : {0.0, 0.5 * kPi, 0.8}) {
            for (const double elevation : {0.0, 0.35, 0.5 * kPi}) {
                RenderSettings settings;
                const auto gap = [&](double zoom) {  // from the near side to the eye
                    settings.camera = {{0, azimuth, elevation, zoom, {}, {}}};
                    const View view = CameraPath(settings, box).at(0);
                    double least = 1e9;
                    for (const Vec3& corner : corners_of(box)) {
                        least = std::min(least, -view.in_view(corner).z());
                    }
                    return least;
                };
                const double framed = gap(1);
                double before = framed;
                for (const double zoom : {1.3, 2.0, 4.0, 30.0}) {
                    INFO(box.size().transpose()
                         << " from " << azimuth << ", " << elevation << ", zoom " << zoom);
                    const double here = gap(zoom);
                    CHECK(here > 0.49 * framed / zoom);
                    CHECK(here < before);
                    before = here;
                }
            }
        }
    }
}

TEST_CASE("azimuth turns from +z toward +x and elevation raises the eye", "[camera]") {
    CHECK((orbit_rotation(0, 0).col(2) - Vec3(0, 0, 1)).norm() < 1e-12);
    CHECK((orbit_rotation(kPi / 2, 0).col(2) - Vec3(1, 0, 0)).norm() < 1e-12);
    CHECK((orbit_rotation(1, kPi / 2).col(2) - Vec3(0, 1, 0)).norm() < 1e-12);
    for (const double a : {-3.0, 0.0, 1.1}) {
        for (const double e : {-kPi / 2, -0.5, 0.0, kPi / 2}) {
            const Mat3 m = orbit_rotation(a, e);
            CHECK((m * m.transpose() - Mat3::Identity()).norm() < 1e-12);
            CHECK(m.determinant() == Approx(1));
            CHECK(std::abs(m.col(0).y()) < 1e-12);  // the horizon is level
        }
    }
}

TEST_CASE("the camera passes through its keys and never overshoots them", "[camera]") {
    const Box box = kBoxes[0];
    RenderSettings settings;
    settings.camera = {
        {0, 0.0, 0.1, 1, {}, {}}, {0.4, 1.0, 0.1, 2, {}, {}}, {1, 1.2, 0.9, 2, {}, {}}};
    const CameraPath path(settings, box);
    const auto azimuth = [&](double share) {
        const Vec3 back = path.at(share).world_from_view.col(2);
        return std::atan2(back.x(), back.z());
    };
    for (const CameraKey& key : settings.camera) CHECK(azimuth(key.at) == Approx(key.azimuth));
    double last = -1, greatest_step = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double now = azimuth(i / 1000.0);
        CHECK(now >= last - 1e-12);
        if (i > 0) greatest_step = std::max(greatest_step, now - last);
        last = now;
    }
    CHECK(greatest_step < 0.006);  // smooth: no jump
    CHECK(azimuth(-1) == Approx(0).margin(1e-12));
    CHECK(azimuth(2) == Approx(1.2));
}

TEST_CASE("an orbit keeps its distance and keeps everything in sight", "[camera]") {
    const Box box = kBoxes[1];  // a long bar
    RenderSettings settings;
    settings.camera = {{0, 0, 0.3, 1, {}, {}}, {1, 2 * kPi, 0.3, 1, {}, {}}};
    const CameraPath path(settings, box);
    const double distance = -path.at(0).in_view(box.center()).z();
    for (int i = 0; i <= 100; ++i) {
        const View view = path.at(i / 100.0);
        CHECK(-view.in_view(box.center()).z() == Approx(distance));
        CHECK(reach(settings, box, view) < 0.95);
    }
}

TEST_CASE("a film of whole turns goes on at its end as at its start, other flights reach theirs",
          "[camera]") {
    const int stills = 12;
    const auto flown = [](double turn, double zoom) {
        return std::vector<CameraKey>{{0, 0.6, 0.3, 1, {}, {}}, {1, 0.6 + turn, 0.3, zoom, {}, {}}};
    };
    RenderSettings settings;
    for (double turn : {2 * kPi, -2 * kPi, 360 * (kPi / 180)}) {
        settings.camera = flown(turn, 1);
        CHECK(comes_round(settings.camera));
        const CameraPath path(settings, kBoxes[1]);
        const auto azimuth = [&](int n) {
            const double share = still_share(settings.camera, n, stills);
            const Vec3 back = path.at(share).world_from_view.col(2);
            return std::atan2(back.x(), back.z());
        };
        for (int n = 0; n < stills; ++n) {
            const double step = azimuth((n + 1) % stills) - azimuth(n);
            CHECK(std::remainder(step - turn / stills, 2 * kPi) == Approx(0).margin(1e-9));
        }
    }
    CHECK(still_share(flown(4 * kPi, 1), 9, 10) == Approx(0.9));
    for (const auto& keys : {flown(kPi, 1), flown(0, 1), flown(2 * kPi, 2)}) {
        CHECK(!comes_round(keys));
        CHECK(still_share(keys, 3, 4) == 1);
        CHECK(still_share(keys, 0, 1) == 0);
    }
    CHECK(still_share(flown(2 * kPi, 1), 0, 1) == 0);
}

TEST_CASE("an eye and a target are taken as they are, even straight down", "[camera]") {
    RenderSettings settings;
    CameraKey key;
    key.eye = Vec3(1, 5, 2);
    key.target = Vec3(1, 0, 2);
    settings.camera = {key};
    const View view = CameraPath(settings, kBoxes[0]).at(0.5);
    CHECK((view.eye - *key.eye).norm() < 1e-12);
    CHECK((view.world_from_view.col(2) - Vec3::UnitY()).norm() < 1e-9);
    CHECK(view.world_from_view.allFinite());
    CHECK(look_at({1, 1, 1}, {1, 1, 1}).world_from_view == Mat3::Identity());
    // The target stands in the middle of the picture.
    const View slanted = look_at({3, 4, 5}, {-1, 0, 2});
    const Vec3 t = slanted.in_view({-1, 0, 2});
    CHECK(std::hypot(t.x(), t.y()) < 1e-12);
    CHECK(t.z() < 0);
}

TEST_CASE("a target without an eye is looked at from where azimuth, elevation and zoom say",
          "[camera]") {
    const Vec3 target(0.3, -0.2, 0.1);
    RenderSettings settings;
    settings.camera = changed_camera({CameraKey{}}, {.azimuth = 1.2, .zoom = 4, .target = target});
    const View view = CameraPath(settings, kBoxes[0]).at(0.5);
    const Vec3 seen = view.in_view(target);
    CHECK(std::hypot(seen.x(), seen.y()) < 1e-12);
    RenderSettings framing = settings;
    framing.camera[0].target.reset();
    const View framed = CameraPath(framing, kBoxes[0]).at(0.5);
    CHECK((view.world_from_view - framed.world_from_view).norm() < 1e-12);
    framing.camera[0].zoom = 1;
    const View whole = CameraPath(framing, kBoxes[0]).at(0.5);
    CHECK(-4 * seen.z() == Approx(-whole.in_view(kBoxes[0].center()).z()));
    // A flight from the whole action to the target arrives at it.
    framing.camera[0].zoom = 4;
    settings.camera.insert(settings.camera.begin(), framing.camera[0]);
    settings.camera[1].at = 1;
    const CameraPath flight(settings, kBoxes[0]);
    CHECK((flight.at(0).eye - framed.eye).norm() < 1e-12);
    CHECK((flight.at(1).eye - view.eye).norm() < 1e-12);
    // An eye and a target of the scene give way to another target.
    CameraKey eye;
    eye.eye = Vec3(1, 2, 3);
    eye.target = Vec3(0, 0, 0);
    const auto changed = changed_camera({eye}, {.target = target});
    CHECK(!changed[0].eye);
    CHECK(changed[0].target == target);
}

TEST_CASE("depth holds the action, also from inside it", "[camera]") {
    const Box box = kBoxes[0];
    for (const double at : {0.0, 0.5, 0.99, 3.0, 50.0}) {
        const View view = look_at({0, 0, at}, {0, 0, at - 1});
        const DepthRange depth = depth_range(box, view);
        CHECK(depth.near > 0);
        CHECK(depth.near < depth.far);
        CHECK(depth.far >= at + 1);
        if (at > 2) CHECK(depth.near <= at - 1);
    }
}

TEST_CASE("an empty or flat action still gives a camera", "[camera]") {
    for (const Box& box : {Box{}, Box{{0, 0, 0}, {0, 0, 0}}, Box{{0, 0, 0}, {1, 0, 1}}}) {
        const View view = CameraPath(RenderSettings{}, box).at(0);
        CHECK(view.eye.allFinite());
        CHECK(view.world_from_view.allFinite());
    }
}

TEST_CASE("the ground is not cut off before the eye", "[studio]") {
    const Box box{{-5, 0, -0.3}, {5, 1, 0.3}};
    RenderSettings settings;
    for (const double elevation : {0.1, 0.25, 0.6, 1.4}) {
        settings.camera[0].elevation = elevation;
        const Stage stage(box);
        const View view = CameraPath(settings, box).at(0);
        const FrameBlock frame = frame_block(settings, stage, {box}, view, box.low.y(), 0.6);
        for (const double x : {-1.0, 0.0, 1.0}) {
            // Where the lower edge of the picture meets it.
            const Vec3 sight =
                view.world_from_view * Vec3(x * double(frame.lens.x), -double(frame.lens.y), -1);
            const double depth = (box.low.y() - view.eye.y()) / sight.y() / stage.radius;
            CHECK(depth > double(frame.lens.z));
        }
    }
}

TEST_CASE("of a camera only that changes which is asked for") {
    CameraKey first, last;
    first.azimuth = 0.2;
    first.elevation = 0.5;
    last.at = 0.75;
    last.azimuth = 3.2;
    last.elevation = 0.1;
    last.zoom = 3;
    const std::vector<CameraKey> flight = {first, last};
    const auto azimuths = [](const std::vector<CameraKey>& keys) {
        std::vector<double> found;
        for (const CameraKey& key : keys) found.push_back(key.azimuth);
        return found;
    };
    CHECK(azimuths(changed_camera(flight, {})) == std::vector<double>{0.2, 3.2});
    const auto elsewhere = changed_camera(flight, {.azimuth = 1.2});
    CHECK(azimuths(elsewhere) == std::vector<double>{1.2, 4.2});
    CHECK(elsewhere[1].at == 0.75);
    CHECK(elsewhere[1].zoom == 3);
    CHECK(elsewhere[0].elevation == 0.5);
    const auto higher = changed_camera(flight, {.elevation = 1, .zoom = 2});
    CHECK(azimuths(higher) == std::vector<double>{0.2, 3.2});
    CHECK(higher[0].elevation == 1);
    CHECK(higher[1].elevation == 1);
    CHECK(higher[1].zoom == 2);
    const auto round = changed_camera(flight, {.turn = -4});
    REQUIRE(round.size() == 3);
    CHECK(round[2].at == 1);
    CHECK(round[1].azimuth == Approx(0.2 - 3));
    CHECK(round[2].azimuth == Approx(0.2 - 4));
    CHECK(round[2].zoom == 3);

    // An eye has neither azimuth nor zoom.
    CameraKey eye;
    eye.eye = Vec3(1, 2, 3);
    eye.target = Vec3(0, 0, 0);
    CHECK(stands_at_eye({eye}));
    CHECK(!stands_at_eye(flight));
    const auto framed = changed_camera({eye}, {.zoom = 2});
    REQUIRE(framed.size() == 1);
    CHECK(!framed[0].eye);
    CHECK(framed[0].zoom == 2);
    CHECK(framed[0].azimuth == CameraKey{}.azimuth);
    CHECK(changed_camera({eye}, {})[0].eye == eye.eye);
}
