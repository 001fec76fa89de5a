// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong in the files that a user wrote, all of it collected in one reading.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace swage {

struct Mistake {
    // As the user would write it; an override: "--set KEY=VALUE"; empty: of no file.
    std::filesystem::path file;
    int line = 0, column = 0;         // from 1; 0: of the file as a whole
    std::string text;                 // one sentence, without a full stop
    bool warning = false;             // the scene can be run all the same
    ExitCode code = ExitCode::scene;  // what the program should return for this one alone
};

// `bend.toml:14:3: unknown key "yeild" in [material], did you mean "yield_stress"?`; warnings have
// "warning: " after the place.
std::string mistake_text(const Mistake& mistake);

// Mistakes that only come to light with what the scene makes. Its sentence has a line for each.
class SceneError : public Error {
  public:
    explicit SceneError(std::vector<Mistake> mistakes);
    const std::vector<Mistake>& mistakes() const { return mistakes_; }

  private:
    std::vector<Mistake> mistakes_;
};

// The exit code for all of them: the scene's own comes before a mesh's. `done` when there are only
// warnings.
ExitCode exit_code(const std::vector<Mistake>& mistakes);

}  // namespace swage
