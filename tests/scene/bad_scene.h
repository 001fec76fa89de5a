// SPDX-License-Identifier: GPL-3.0-or-later
// A right scene to put mistakes into.
#pragma once

#include <algorithm>

#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

namespace swage::test {

// A right scene whose sections can each be replaced. Lines: [mesh] 1, [material] 3, [mold] 5,
// [[stage]] 7, [render] 10.
struct Parts {
    std::string mesh = "[mesh]\nfile = \"bar.obj\"\n";
    std::string material = "[material]\nname = \"rubber\"\n";
    std::string mold = "[mold]\nacross = 6\n";
    std::string stage = "[[stage]]\nmachine = \"bend\"\nangle = \"60 deg\"\n";
    std::string rest = "[render]\nfps = 30\n";

    std::string text() const { return mesh + material + mold + stage + rest; }
};

inline std::string mistakes_in(const std::string& text,
                               const std::vector<std::string>& overrides = {}) {
    const SceneFolder scratch;
    const SceneReading reading = read_scene(scratch.write("s.toml", text), overrides, shipped());
    CHECK(reading.scene.has_value() == (exit_code(reading.mistakes) == ExitCode::done));
    return told(reading.mistakes, scratch.path());
}

inline Parts with(std::string Parts::*part, const std::string& text) {
    Parts parts;
    parts.*part = text;
    return parts;
}

struct Bad {
    const char* title;
    Parts scene;
    std::vector<std::string> wanted;  // each has to occur; the number of lines has to be the same
};

inline void check_all(const std::vector<Bad>& bad) {
    for (const Bad& one : bad) {
        const std::string text = mistakes_in(one.scene.text());
        INFO(one.title << "\n" << one.scene.text() << "---\n" << text);
        CHECK(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) ==
              one.wanted.size());
        for (const std::string& wanted : one.wanted) {
            INFO(wanted);
            CHECK(text.find(wanted) != std::string::npos);
        }
    }
}

inline Parts material(const std::string& line) {
    return with(&Parts::material, "[material]\nname = \"rubber\"\n" + line + "\n");
}
inline Parts stage(const std::string& line) {
    return with(&Parts::stage, "[[stage]]\nmachine = \"bend\"\n" + line + "\n");
}
inline Parts render(const std::string& line) {
    return with(&Parts::rest, "[render]\n" + line + "\n");
}

}  // namespace swage::test
