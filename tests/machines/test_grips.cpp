// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("grips that hold along different axes may hold the same, unless one turns") {
    const Aggregate body = test::make_block(8, 8, 8, 0.0125, Material{});
    MachineSpec spec;
    spec.name = "corner";
    for (const char* name : {"x", "y"}) {
        GripSpec grip;
        grip.name = name;
        grip.from = {"-length", "-height", "-width"};
        grip.to = {"length", "height", "width"};
        grip.along = {name[0] == 'x', name[0] == 'y', false};
        spec.grip.push_back(grip);
    }
    const auto stand = [&](const MachineSpec& one) {
        return build_machine(one, {}, place_work_frame(body), body);
    };
    CHECK(stand(spec).apparatus.grip[1].point.size() == body.surface.size());
    const auto refusal = Catch::Contains("grips x and y would hold the same points");
    MachineSpec turned = spec;
    turned.grip[1].motion.turn = "t";
    CHECK_THROWS_WITH(stand(turned), refusal);
    spec.grip[1].along[0] = true;
    CHECK_THROWS_WITH(stand(spec), refusal);
}
