// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/clip_mesh.h"

#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

TEST_CASE("what is clipped to a box encloses what of it lies in the box") {
    const TriMesh ball = test::sphere_mesh(1, 4);
    const double whole = signed_volume(ball);
    struct Part {
        Box box;
        double share;
    };
    const Vec3 far = Vec3::Constant(3);
    for (const Part& part :
         {Part{{-far, far}, 1}, Part{{Vec3::Zero(), far}, 1. / 8}, Part{{-far, {3, 0, 3}}, 1. / 2},
          Part{{{-3, 0, -3}, {0, 3, 3}}, 1. / 4}, Part{{{-3, -3, -0.5}, {3, 3, 0.5}}, 0.6875}}) {
        const TriMesh clipped = clipped_to_box(ball, part.box);
        CHECK(test::is_closed(clipped));
        CHECK(signed_volume(clipped) == Approx(part.share * whole).epsilon(3e-3));
        CHECK(part.box.contains(box_of(clipped.position).low));
        CHECK(part.box.contains(box_of(clipped.position).high));
        for (std::size_t v = 0; v < ball.position.size(); ++v) {
            if (part.box.contains(ball.position[v])) {
                CHECK(clipped.position[v] == ball.position[v]);
            }
        }
    }
    CHECK(clipped_to_box(ball, {-far, far}).triangle == ball.triangle);
    // All of a box that is in a larger one, which lies askew to nothing.
    const TriMesh large = test::box_mesh({-9, -8, -7}, {5, 6, 0.25});
    CHECK(signed_volume(clipped_to_box(large, {-far, far})) == Approx(6 * 6 * 3.25));
}
