// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <sstream>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/log.h"
#include "base/text.h"
#include "pipeline/interrupt.h"
#include "pipeline/json.h"
#include "scene/file_text.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIdentityName = ".swage-run";
constexpr const char* kLockName = ".swage-lock";
constexpr std::uintmax_t kLongestRecord = 64 << 20;  // some kB a stage

std::string host_name() {
    std::array<char, 256> name = {};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string identity_text(const RunIdentity& identity) {
    Json json;
    json["program"] = "swage";
    json["version"] = identity.version;
    json["build"] = identity.build;
    for (const RunInput& input : identity.input) {
        Json one = {{"role", input.role}, {"file", input.file.string()}, {"hash", input.hash}};
        if (!input.text.empty()) one["text"] = input.text;
        json["inputs"].push_back(std::move(one));
    }
    return json_text(json);
}

RunIdentity read_identity(const fs::path& file) {
    RunIdentity identity;
    try {
        const Json json = Json::parse(record_text(file, ExitCode::foreign));
        identity.version = json.at("version").get<std::string>();
        identity.build = json.value("build", "unknown");
        for (const Json& input : json.at("inputs")) {
            identity.input.push_back(
                {input.at("role").get<std::string>(), input.at("file").get<std::string>(),
                 input.at("hash").get<std::string>(), input.value("text", "")});
        }
    } catch (const Json::exception&) {
        fail(ExitCode::foreign,
             "{}: is damaged, so nobody knows whose run this is; remove it with "
             "its directory, or choose another --out",
             file.string());
    }
    return identity;
}

const RunInput* find_role(const RunIdentity& identity, const std::string& role) {
    for (const RunInput& input : identity.input) {
        if (input.role == role) return &input;
    }
    return nullptr;
}

// The lines of one text that another has not, as they are to be told; no blanks, no remarks.
std::string lines_beside(const std::string& text, const std::string& other) {
    constexpr std::size_t kTold = 3;
    const auto said_in = [](const std::string& all) {
        std::vector<std::string> said;
        for (const std::string& line : lines_of(all)) {
            const std::size_t begin = line.find_first_not_of(" \t");
            if (begin == std::string::npos || line[begin] == '#') continue;
            said.push_back(line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin));
        }
        return said;
    };
    std::vector<std::string> there = said_in(other), beside;
    for (const std::string& line : said_in(text)) {
        const auto known = std::find(there.begin(), there.end(), line);
        if (known == there.end()) {
            beside.push_back(line);
        } else {
            there.erase(known);
        }
    }
    if (beside.empty()) return "nothing more";
    const std::size_t more = beside.size() - std::min(beside.size(), kTold);
    beside.resize(beside.size() - more);
    return joined(beside, ", ") + (more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string difference(const RunInput& now, const RunInput& then) {
    const auto told = [](const RunInput& of) {
        return of.file.empty() ? std::string("none") : of.file.string();
    };
    if (now.file != then.file) {
        return fmt::format("{} differs ({} now, {} then)", now.role, told(now), told(then));
    }
    if (now.text.empty() || then.text.empty()) {
        return fmt::format("{} differs: the content of {} has changed", now.role, told(now));
    }
    return fmt::format("{} differs: the content of {} has changed (now {}; then {})", now.role,
                       told(now), lines_beside(now.text, then.text),
                       lines_beside(then.text, now.text));
}

// What a run leaves; nothing else in the directory is ever touched.
void remove_products(const fs::path& root) {
    for (const char* name : {"run.json", "film.mp4", "contact.png", "motion.bin", "frames",
                             "meshes", "curves", "again", kIdentityName}) {
        std::error_code error;
        fs::remove_all(root / name, error);
        if (error) {
            fail(ExitCode::output, "{}: cannot be removed: {}", (root / name).string(),
                 error.message());
        }
    }
}

// A run that ended before its first frame leaves no file but these two.
bool holds_products(const fs::path& root) {
    std::error_code error;
    for (fs::recursive_directory_iterator it(root, error), end; !error && it != end;
         it.increment(error)) {
        const fs::path name = it->path().filename();
        if (it->is_directory(error) || name == kIdentityName || name == kLockName) continue;
        return true;
    }
    return static_cast<bool>(error);
}

}  // namespace

std::vector<std::string> differences(const RunIdentity& there, const RunIdentity& here) {
    std::vector<std::string> found;
    if (there.version != here.version) {
        found.push_back(fmt::format("swage {} made it, this is {}", there.version, here.version));
    } else if (there.build != here.build) {
        found.push_back(fmt::format("another build of swage {} made it ({}, this is {})",
                                    there.version, there.build, here.build));
    }
    for (const RunInput& input : here.input) {
        const RunInput* old = find_role(there, input.role);
        if (old == nullptr) {
            found.push_back(fmt::format("{} ({}) is new", input.role, input.file.string()));
        } else if (old->hash != input.hash) {
            found.push_back(difference(input, *old));
        }
    }
    for (const RunInput& input : there.input) {
        if (find_role(here, input.role) == nullptr) {
            found.push_back(fmt::format("{} ({}) is gone", input.role, input.file.string()));
        }
    }
    return found;
}

std::string record_text(const fs::path& file, ExitCode code) {
    std::optional<std::string> text = file_contents(file, kLongestRecord);
    if (!text) {
        fail(code, "{}: {}; swage run --fresh throws that run away", file.string(),
             why_unreadable(file).value_or("is too long to be swage's"));
    }
    return std::move(*text);
}

bool holds_run(const fs::path& folder) {
    std::error_code unknown;
    return fs::exists(folder / kIdentityName, unknown);
}

RunDirectory::RunDirectory(const fs::path& root, const RunIdentity& identity, bool fresh)
    : root_(root.has_filename() ? root : root.parent_path()),
      folder_(root_),
      identity_text_(identity_text(identity)),
      anew_(fresh) {
    bool empty = true;
    std::error_code error;
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        if (it->path().filename() != kLockName) empty = false;
    }
    if (error) fail(ExitCode::output, "{}: cannot be read: {}", root_.string(), error.message());
    if (!empty && !holds_run(root_)) {
        fail(ExitCode::foreign, "{}: holds files that are no run of swage; choose another --out",
             root_.string());
    }
    lock();
    try {
        remove_temporaries(root_, 0);
        if (!anew_) claim(identity);
    } catch (...) {
        ::unlink((root_ / kLockName).c_str());
        throw;
    }
    set_unfinished_work(root_);
}

void RunDirectory::lock() {
    const fs::path file = root_ / kLockName;
    for (;;) {
        lock_ = FileHandle(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
        if (!lock_.is_open()) {
            fail(ExitCode::output, "{}: cannot be written: {}", root_.string(),
                 std::strerror(errno));
        }
        const bool ours = ::flock(lock_.id(), LOCK_EX | LOCK_NB) == 0;
        std::array<char, 300> text = {};
        [[maybe_unused]] const ssize_t got = ::pread(lock_.id(), text.data(), text.size() - 1, 0);
        long pid = 0;
        std::string host;
        std::istringstream(text.data()) >> pid >> host;
        if (!ours || (pid != 0 && host != host_name())) {
            fail(ExitCode::foreign, "{}: process {} on {} is writing there{}", root_.string(), pid,
                 host.empty() ? "this machine" : host,
                 ours ? fmt::format("; if it has died, remove {}", file.string()) : "");
        }
        // The holder before us may have removed the file between our open and our lock.
        struct stat by_name = {}, by_handle = {};
        if (::stat(file.c_str(), &by_name) != 0 || ::fstat(lock_.id(), &by_handle) != 0 ||
            by_name.st_ino != by_handle.st_ino) {
            continue;
        }
        if (pid != 0) log_info("{}: taking over from process {}, which died", root_.string(), pid);
        break;
    }
    const std::string mine = fmt::format("{} {}\n", ::getpid(), host_name());
    if (::ftruncate(lock_.id(), 0) != 0 ||
        ::pwrite(lock_.id(), mine.data(), mine.size(), 0) != static_cast<ssize_t>(mine.size())) {
        const int reason = errno;
        ::unlink(file.c_str());
        fail(ExitCode::output, "{}: cannot be written: {}", file.string(), std::strerror(reason));
    }
}

void RunDirectory::claim(const RunIdentity& identity) {
    const fs::path file = root_ / kIdentityName;
    std::error_code unknown;
    if (!fs::exists(file, unknown) || !holds_products(root_)) {
        write_file_whole(file, identity_text_);
        return;
    }
    const std::vector<std::string> found = differences(read_identity(file), identity);
    if (!found.empty()) {
        fail(ExitCode::foreign,
             "{}: belongs to another run: {}; choose another --out, or "
             "--fresh to throw that run away",
             root_.string(), joined(found, "; "));
    }
}

void RunDirectory::begin() {
    has_begun_ = true;
    if (!anew_) return;
    remove_products(root_);
    write_file_whole(root_ / kIdentityName, identity_text_);
    anew_ = false;
}

RunDirectory::~RunDirectory() {
    set_unfinished_work({});
    remove_temporaries(root_, 0);  // a film program may outlive a process that was killed
    if (!has_begun_) remove_unbegun();
    ::unlink((root_ / kLockName).c_str());
}

void RunDirectory::remove_unbegun() {
    std::error_code error;
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        const fs::path name = it->path().filename();
        if (name != kLockName && name != kIdentityName) return;
    }
    if (!error) fs::remove(root_ / kIdentityName, error);
}

fs::path DrawnFiles::still(int frame) const {
    return folder() / fmt::format("frame_{:04d}.png", frame);
}

}  // namespace swage
