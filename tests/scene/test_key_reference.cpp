// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/units.h"
#include "scene/key_help.h"
#include "scene/key_reference.h"
#include "tests/catch.h"

using namespace swage;

namespace {

void check_reference(const std::vector<SectionReference>& reference,
                     std::span<const KeyHelp> help) {
    std::size_t keys = 0;
    for (const SectionReference& section : reference) {
        for (const KeyReference& key : section.key) {
            INFO(section.section << " " << key.key);
            CHECK(!key.help.empty());
            CHECK(!key.takes.empty());
            ++keys;
        }
    }
    CHECK(keys > 40);
    for (const KeyHelp& one : help) {
        INFO(one.section << " " << one.key);
        CHECK(std::any_of(reference.begin(), reference.end(), [&](const SectionReference& section) {
            return section.section == one.section &&
                   std::any_of(section.key.begin(), section.key.end(),
                               [&](const KeyReference& key) { return key.key == one.key; });
        }));
    }
}

}  // namespace

TEST_CASE("every key that a scene's readers ask for is told, and no other") {
    check_reference(scene_key_reference(), scene_key_help());
}

TEST_CASE("every key that a machine file's reader asks for is told, and no other") {
    check_reference(machine_key_reference(), machine_key_help());
}

TEST_CASE("every quantity that has units tells them") {
    const SectionReference told = unit_reference();
    for (const std::string& name : quantity_names()) {
        const std::vector<std::string> units = unit_names(*quantity_named(name));
        const bool is_told =
            std::any_of(told.key.begin(), told.key.end(), [&](const KeyReference& k) {
                return k.key == name && !units.empty() &&
                       k.help.find(units.back()) != std::string::npos;
            });
        INFO(name);
        CHECK(is_told == !units.empty());
    }
}
