// SPDX-License-Identifier: GPL-3.0-or-later
// The machines that swage ships, at a bar.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "machines/machine.h"
#include "scene/read_machine.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"

namespace swage::test {

inline const std::filesystem::path kMachines = std::filesystem::path(SWAGE_SOURCE_DIR) / "machines";

inline MachineSpec shipped_machine(const std::string& name) {
    const MachineReading reading = read_machine(kMachines / (name + ".toml"));
    for (const Mistake& mistake : reading.mistakes) FAIL_CHECK(mistake.text);
    REQUIRE(reading.machine);
    return *reading.machine;
}

inline Machine at_bar(const std::string& name, const std::map<std::string, double>& given = {},
                      const Aggregate& body = bar()) {
    return build_machine(shipped_machine(name), given, place_work_frame(body), body);
}

inline int index_of(const std::vector<Tool>& tools, const std::string& name) {
    const auto found = std::find_if(tools.begin(), tools.end(),
                                    [&](const Tool& tool) { return tool.name == name; });
    REQUIRE(found != tools.end());
    return static_cast<int>(found - tools.begin());
}

}  // namespace swage::test
