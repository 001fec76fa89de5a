// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the built program as a user does.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/shared/bytes_of.h"
#include "tests/shared/says.h"

struct Outcome {
    int code = -1;  // exit code, or 128 + n by signal n
    std::string out, err;
};

// A program that runs on while the test does something else.
class RunningSwage {
  public:
    // `set` goes over the environment. Standard streams go to files in `folder`, which is also
    // where it starts.
    RunningSwage(const std::vector<std::string>& argument, std::filesystem::path folder,
                 const std::map<std::string, std::string>& set = {},
                 const std::filesystem::path& program = SWAGE_BINARY);
    ~RunningSwage();
    RunningSwage(const RunningSwage&) = delete;
    RunningSwage& operator=(const RunningSwage&) = delete;

    pid_t pid() const { return pid_; }
    void signal(int number) const;
    bool is_running();
    Outcome wait();

  private:
    std::filesystem::path out_, err_;
    pid_t pid_ = -1;
    int status_ = 0;
    bool ended_ = false;
};

Outcome run_swage(const std::vector<std::string>& argument,
                  const std::filesystem::path& folder = SWAGE_SOURCE_DIR,
                  const std::map<std::string, std::string>& set = {},
                  const std::filesystem::path& program = SWAGE_BINARY);

using swage::test::bytes_of;
using swage::test::says;
// Name and bytes of every file below a folder.
std::map<std::string, std::string> files_below(const std::filesystem::path& folder);
bool is_whole_png(const std::string& bytes);
void put_text(const std::filesystem::path& file, const std::string& text);

// By column of a table that a run has written, what stands in its last row.
std::map<std::string, double> last_row(const std::filesystem::path& csv);

// A bar of 10 x 2 x 2 cells bent by a few degrees in `frames` frames, drawn small.
// Returns the scene's file; `more` stands at the end of it.
std::filesystem::path put_small_scene(const std::filesystem::path& folder, int frames = 3,
                                      const std::string& more = {});
