// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/ascii.h"
#include "base/error.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void give_up(const fs::path& temporary, const fs::path& file, const char* act) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    fail(ExitCode::output, "{}: cannot {}: {}", file.string(), act, std::strerror(reason));
}

// ".frame_0001.part1234.png" of the process 1234. 0: of this process, or of one that is no more.
bool is_temporary(const std::string& name, long pid) {
    const std::size_t part = name.rfind(".part");
    if (name.empty() || name[0] != '.' || part == std::string::npos) return false;
    std::size_t end = part + 5;
    while (end < name.size() && is_digit(name[end])) ++end;
    const std::string digits = name.substr(part + 5, end - part - 5);
    if (digits.empty() || (end < name.size() && name[end] != '.')) return false;
    if (pid != 0) return digits == std::to_string(pid);
    const long owner = std::strtol(digits.c_str(), nullptr, 10);
    return owner == ::getpid() || (::kill(static_cast<pid_t>(owner), 0) != 0 && errno == ESRCH);
}

}  // namespace

bool is_left_over(const std::string& name) { return is_temporary(name, 0); }

fs::path temporary_for(const fs::path& file) {
    // The extension stays last: programs such as ffmpeg choose the format by it.
    return file.parent_path() /
           fmt::format(".{}.part{}{}", file.stem().string(), ::getpid(), file.extension().string());
}

void publish(const fs::path& temporary, const fs::path& file) {
    const FileHandle handle(::open(temporary.c_str(), O_RDONLY | O_CLOEXEC));
    if (!handle.is_open()) give_up(temporary, file, "be written");
    if (::fsync(handle.id()) != 0) give_up(temporary, file, "be flushed to disk");
    if (std::rename(temporary.c_str(), file.c_str()) != 0) give_up(temporary, file, "be renamed");
}

WholeFile::WholeFile(const fs::path& file)
    : file_(file),
      temporary_(temporary_for(file)),
      handle_(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
    if (!handle_.is_open()) give_up(temporary_, file_, "be created");
}

WholeFile::~WholeFile() {
    if (handle_.is_open()) ::unlink(temporary_.c_str());
}

void WholeFile::put(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(handle_.id(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) give_up(temporary_, file_, "be written");
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void WholeFile::finish() {
    handle_.close();
    publish(temporary_, file_);
}

void write_file_whole(const fs::path& file, std::string_view bytes) {
    WholeFile whole(file);
    whole.put(bytes);
    whole.finish();
}

void remove_temporaries(const fs::path& directory, long pid) {
    std::error_code ignored;
    std::vector<fs::path> found;
    for (fs::recursive_directory_iterator it(directory, ignored), end; !ignored && it != end;
         it.increment(ignored)) {
        if (is_temporary(it->path().filename().string(), pid)) found.push_back(it->path());
    }
    for (const fs::path& file : found) fs::remove(file, ignored);
}

}  // namespace swage
