// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_directory.h"

#include <algorithm>
#include <optional>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/log.h"
#include "base/text.h"
#include "pipeline/checkpoint.h"
#include "pipeline/folder_lock.h"
#include "pipeline/interrupt.h"
#include "pipeline/json.h"
#include "scene/file_text.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIdentityName = ".swage-run";
constexpr std::uintmax_t kLongestRecord = 64 << 20;  // some kB a stage

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
             "{}: is damaged, so its run cannot be identified; remove it with its directory, or "
             "choose another --out",
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

void remove_product(const fs::path& product) {
    std::error_code error;
    fs::remove_all(product, error);
    if (error) {
        fail(ExitCode::output, "{}: cannot be removed: {}", product.string(), error.message());
    }
}

// What a run leaves; nothing else in the directory is ever touched.
void remove_products(const fs::path& root) {
    for (const char* name : {"run.json", "film.mp4", "contact.png", "motion.bin", "frames",
                             "meshes", "curves", "resume", "again", "usd", kIdentityName}) {
        remove_product(root / name);
    }
}

// But for what the first stages left; the motion file is gone on from, and replaced.
void remove_later_products(const fs::path& root, const std::vector<fs::path>& kept) {
    for (const char* name : {"run.json", "film.mp4", "contact.png", "frames", "again", "usd"}) {
        remove_product(root / name);
    }
    const auto is_kept = [&](const fs::path& name) {
        return std::find(kept.begin(), kept.end(), name) != kept.end();
    };
    std::vector<fs::path> others;
    std::error_code error;
    for (const fs::path folder : {"meshes", "curves"}) {
        for (fs::directory_iterator it(root / folder, error), end; !error && it != end;
             it.increment(error)) {
            // Pictures beside meshes are of all stages.
            const fs::path ending = it->path().extension();
            const bool is_folder = it->is_directory(error);
            const bool is_of_stage = is_folder || ending == ".obj" || ending == ".mtl" ||
                                     ending == ".ply" || ending == ".csv" || ending == ".svg" ||
                                     ending == ".gp";
            const fs::path name = is_folder ? it->path().filename() : it->path().stem();
            if (is_of_stage && !is_kept(folder / name)) {
                others.push_back(it->path());
            }
        }
    }
    for (const fs::path& product : others) remove_product(product);
}

// A run that ended before its first frame leaves no file but these two.
bool holds_products(const fs::path& root) {
    std::error_code error;
    for (fs::recursive_directory_iterator it(root, error), end; !error && it != end;
         it.increment(error)) {
        const fs::path name = it->path().filename();
        if (it->is_directory(error) || name == kIdentityName || FolderLock::is_lock(name)) {
            continue;
        }
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
             why_unreadable(file).value_or("is too long to be from swage"));
    }
    return std::move(*text);
}

bool holds_run(const fs::path& folder) {
    std::error_code unknown;
    return fs::exists(folder / kIdentityName, unknown);
}

RunDirectory::RunDirectory(const fs::path& root, const RunIdentity& identity, bool fresh,
                           bool go_on)
    : root_(root.has_filename() ? root : root.parent_path()),
      folder_(root_),
      identity_text_(identity_text(identity)),
      stage_keys_(identity.stage_key),
      anew_(fresh) {
    // One that is being made holds files before it is a run.
    if (FolderLock::may_hold(root_)) lock_.emplace(root_);
    if (!FolderLock::is_all_of(root_) && !holds_run(root_)) {
        fail(ExitCode::foreign,
             "{}: contains files that are not from a swage run; choose another --out",
             root_.string());
    }
    if (!lock_) lock_.emplace(root_);
    remove_temporaries(root_, 0);
    if (!anew_) claim(identity, go_on);
    set_unfinished_work(root_);
}

void RunDirectory::claim(const RunIdentity& identity, bool go_on) {
    const fs::path file = root_ / kIdentityName;
    std::error_code unknown;
    if (!fs::exists(file, unknown) || !holds_products(root_)) {
        write_file_whole(file, identity_text_);
        return;
    }
    const std::vector<std::string> found = differences(read_identity(file), identity);
    if (found.empty()) return;
    const int kept = stages_kept(checkpoint(), stage_keys_);
    changed_ = go_on && kept > 0;
    if (changed_) return;
    fail(ExitCode::foreign,
         "{}: belongs to another run: {}{}; choose another --out, or {}--fresh to throw that run "
         "away",
         root_.string(), joined(found, "; "),
         go_on ? "; and it has kept no stage to go on from that is the same" : "",
         kept > 0 ? fmt::format("--go-on to keep its first {}, or ",
                                counted(std::size_t(kept), "stage", "stages"))
                  : "");
}

void RunDirectory::begin(const std::vector<fs::path>& kept) {
    has_begun_ = true;
    if (!anew_ && !changed_) return;
    {
        std::optional<FolderLock> drawing;  // of the run, which `swage render` may be at
        if (fs::is_directory(drawn_again(root_))) drawing.emplace(drawn_again(root_));
        if (anew_) {
            remove_products(root_);
        } else {
            remove_later_products(root_, kept);
        }
    }
    write_file_whole(root_ / kIdentityName, identity_text_);
    anew_ = changed_ = false;
}

void RunDirectory::remove_checkpoint() const {
    std::error_code ignored;
    fs::remove_all(checkpoint().parent_path(), ignored);
}

RunDirectory::~RunDirectory() {
    set_unfinished_work({});
    remove_temporaries(root_, 0);  // a film program may outlive a process that was killed
    if (!has_begun_) remove_unbegun();
}

void RunDirectory::remove_unbegun() {
    std::error_code error;
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        if (!FolderLock::is_lock(it->path()) && it->path().filename() != kIdentityName) return;
    }
    if (!error) fs::remove(root_ / kIdentityName, error);
}

std::string frame_name(int frame, int first_frame) {
    return fmt::format("frame_{:04d}", frame + (first_frame - 1));
}

fs::path DrawnFiles::still(int frame) const {
    return folder() / (frame_name(frame, first_frame) + ".png");
}

fs::path DrawnFiles::pass(int frame, PicturePass pass) const {
    return folder() / fmt::format("{}.{}.{}", frame_name(frame, first_frame),
                                  kPassName[std::size_t(pass)], is_colored(pass) ? "png" : "exr");
}

fs::path DrawnFiles::table(PicturePass pass) const {
    return folder() / (std::string(kPassName[std::size_t(pass)]) + "s.json");
}

}  // namespace swage
