// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a run this run: the program, to the build, what the scene says, and the bytes of
// everything else that was read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/build_name.h"
#include "scene/document.h"

namespace swage {

inline constexpr const char* kVersion = SWAGE_VERSION;

struct RunInput {
    std::string role;  // "scene", "machine bend", "mesh", ...; unique
    std::filesystem::path file;
    std::string hash;
    std::string text = {};  // of a machine, so that it can be told what was changed in it
};
// Of the scene's file and the command line it matters what they say, not how.
bool is_said(const RunInput& input);

// Of a run that has finished so many stages: what made it what it is until then, and which build
// reads it again.
using StageKeys = std::vector<std::string>;

struct RunIdentity {
    std::string version = kVersion;
    std::vector<RunInput> input;
    std::string build = kBuildName;
    std::vector<Said> said = {};
    // Of the run up to each stage, from none of them to all, a text that is another where anything
    // is that what was done until then depends on.
    StageKeys stage_key = {};
};

// One sentence a difference, empty when they are the same run. File names may differ.
std::vector<std::string> differences(const RunIdentity& there, const RunIdentity& here);

// Whether it leaves its stages once it is done.
bool keeps_stages(const RunIdentity& identity);

// As it stands in a run's folder.
std::string identity_text(const RunIdentity& identity);
// Throws Error(foreign) when that is nobody's.
RunIdentity read_identity(const std::filesystem::path& file);

// All of a small file that a run has left. Throws Error(code) when that is no plain file, cannot be
// read or is longer than any such file; never waits for what is none.
std::string record_text(const std::filesystem::path& file, ExitCode code);

}  // namespace swage
