// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/field_look.h"

#include "geometry/box_mesh.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("a scale knows whether anything in any frame lies beyond either of its ends") {
    const Scratch scratch;
    const TriMesh box = box_mesh(Vec3::Zero(), Vec3::Ones());
    {
        FrameStoreWriter writer(scratch.path() / "motion.bin",
                                {SkinField::pressure, SkinField::stress});
        writer.add_skin(box);
        for (int f = 1; f <= 3; ++f) {
            StoredFrame now;
            std::vector<float> pressure(8, 0.0f), stress(8, 0.0f);
            pressure[2] = f == 2 ? -3e6f : 1e6f;
            pressure[5] = 5e6f;
            stress[1] = f == 3 ? 2e8f : 1e8f;
            now.body = {{0, box.position, {pressure, stress}}};
            writer.add_frame(now);
        }
        writer.finish();
    }
    const FrameStore store(scratch.path() / "motion.bin");
    const auto beyond = [&](SkinField field, std::optional<std::array<double, 2>> range) {
        RenderSettings settings;
        settings.color = field;
        settings.color_range = range;
        return FieldLook(store, settings).beyond();
    };
    using Ends = std::array<bool, 2>;
    using Range = std::array<double, 2>;
    const SkinField pressure = SkinField::pressure, stress = SkinField::stress;
    CHECK(beyond(pressure, {}) == Ends{false, false});
    CHECK(beyond(stress, {}) == Ends{false, false});
    CHECK(beyond(pressure, Range{-3e6, 5e6}) == Ends{false, false});
    CHECK(beyond(pressure, Range{-4e6, 6e6}) == Ends{false, false});
    CHECK(beyond(pressure, Range{-2.9e6, 5e6}) == Ends{true, false});
    CHECK(beyond(pressure, Range{-3e6, 4.9e6}) == Ends{false, true});
    CHECK(beyond(pressure, Range{0, 1e6}) == Ends{true, true});
    CHECK(beyond(stress, Range{0, 1.5e8}) == Ends{false, true});
    CHECK(beyond(stress, Range{1e7, 3e8}) == Ends{true, false});
    // What is a rounding beyond does not make an arrow.
    CHECK(beyond(stress, Range{0, 2e8 * (1 - 1e-6)}) == Ends{false, false});
    // What has no sign goes from nothing on, though there is more of it everywhere.
    RenderSettings settings;
    settings.color = SkinField::stress;
    std::vector<float> all(8, 1e8f);
    {
        FrameStoreWriter writer(scratch.path() / "more.bin", {SkinField::stress});
        writer.add_skin(box);
        StoredFrame now;
        all[3] = 2e8f;
        now.body = {{0, box.position, {all}}};
        writer.add_frame(now);
        writer.finish();
    }
    CHECK(FieldLook(FrameStore(scratch.path() / "more.bin"), settings).range() == Range{0, 2e8});
}
