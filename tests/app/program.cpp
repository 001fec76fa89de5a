// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/app/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace fs = std::filesystem;

RunningSwage::RunningSwage(const std::vector<std::string>& argument, fs::path folder,
                           const std::map<std::string, std::string>& set, const fs::path& program) {
    static std::atomic<int> count = 0;
    const std::string stem = fmt::format("swage-{}-{}", ::getpid(), ++count);
    out_ = fs::temp_directory_path() / fmt::format("{}.out", stem);
    err_ = fs::temp_directory_path() / fmt::format("{}.err", stem);
    std::vector<char*> words = {const_cast<char*>("swage")};
    for (const std::string& word : argument) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
        const int in = ::open("/dev/null", O_RDONLY);
        const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        const int err = ::open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        if (::dup2(in, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(err, 2) < 0 ||
            ::chdir(folder.c_str()) != 0) {
            ::_exit(126);
        }
        ::setenv("SWAGE_ASSETS", SWAGE_SOURCE_DIR, 1);
        for (const auto& [name, value] : set) ::setenv(name.c_str(), value.c_str(), 1);
        ::execv(program.c_str(), words.data());
        ::_exit(127);
    }
}

RunningSwage::~RunningSwage() {
    if (!ended_ && pid_ > 0) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, &status_, 0);
    }
    std::error_code ignored;
    fs::remove(out_, ignored);
    fs::remove(err_, ignored);
}

void RunningSwage::signal(int number) const { ::kill(pid_, number); }

bool RunningSwage::is_running() {
    if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
    return !ended_;
}

Outcome RunningSwage::wait() {
    if (!ended_) ::waitpid(pid_, &status_, 0);
    ended_ = true;
    const int code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    return {code, bytes_of(out_), bytes_of(err_)};
}

Outcome run_swage(const std::vector<std::string>& argument, const fs::path& folder,
                  const std::map<std::string, std::string>& set, const fs::path& program) {
    return RunningSwage(argument, folder, set, program).wait();
}

std::map<std::string, double> last_row(const fs::path& csv) {
    std::istringstream table(bytes_of(csv));
    std::string head, line, last;
    std::getline(table, head);
    while (std::getline(table, line)) last = line;
    std::istringstream names(head), cells(last);
    std::map<std::string, double> row;
    for (std::string name, cell;
         std::getline(names, name, ',') && std::getline(cells, cell, ',');) {
        if (cell.empty()) continue;
        if (!row.emplace(name, std::stod(cell)).second) {
            throw std::runtime_error("two columns are called " + name);
        }
    }
    return row;
}

void put_text(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

fs::path put_small_scene(const fs::path& folder, int frames, const std::string& more) {
    run_swage({"make", "bar", "--length", "10 cm", "--out", (folder / "bar.obj").string()}, folder);
    const fs::path file = folder / "small.toml";
    put_text(file,
             "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
             "[mold]\nacross = 2\n[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\n"
             "frames = " +
                 std::to_string(frames) + "\n[render]\nsize = [160, 90]\n" + more);
    return file;
}

std::map<std::string, std::string> files_below(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files[std::filesystem::relative(entry.path(), folder).string()] =
                bytes_of(entry.path());
        }
    }
    return files;
}

bool is_whole_png(const std::string& bytes) {
    return bytes.size() > 50 && bytes.compare(1, 3, "PNG") == 0 &&
           bytes.compare(bytes.size() - 8, 4, "IEND") == 0;
}
