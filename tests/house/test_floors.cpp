// SPDX-License-Identifier: GPL-3.0-or-later
// The rules that the sources keep, read from the sources themselves.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/catch.h"

namespace fs = std::filesystem;

namespace {

// A file includes its own room and lower floors; rooms on one floor never include each other.
const std::map<std::string, int> kFloor = {
    {"base", 0},     {"geometry", 1}, {"laws", 2}, {"matter", 3}, {"mold", 4},
    {"machines", 4}, {"sim", 4},      {"skin", 4}, {"render", 4}, {"scene", 5},
    {"pipeline", 6}, {"verify", 6},   {"app", 7},
};

// Each outside library is seen by as few files as can be.
struct Library {
    std::string header;      // its include begins with this
    std::string room;        // the only room that may
    std::size_t most_files;  // in that room
};
const std::vector<Library> kLibrary = {
    {"assimp/", "geometry", 2},
    {"CGAL/", "*", 2},
    {"GL/", "render", 2},
    {"EGL/", "render", 1},
    {"stb", "render", 1},
    {"toml", "scene", 1},
    {"glm/", "render", 2},
    {"muParser", "base", 1},
    {"tbb/", "base", 1},
    {"libdeflate", "render", 1},
    {"CLI/", "app", 12},
    {"xxhash", "base", 1},
    {"sleef", "base", 1},
    {"nlohmann/json.", "*", 2},
    {"zip.h", "geometry", 1},
    {"pugixml", "geometry", 1},
    {"nlohmann/json_fwd.", "pipeline", 1},
};

struct Include {
    fs::path file;     // relative to src
    std::string room;  // of the file
    std::string what;
};

const std::vector<fs::path>& source_files() {
    static const std::vector<fs::path> files = [] {
        std::vector<fs::path> found;
        for (const auto& entry : fs::recursive_directory_iterator(SWAGE_SOURCE_DIR "/src")) {
            const fs::path extension = entry.path().extension();
            if (extension == ".h" || extension == ".cpp") found.push_back(entry.path());
        }
        return found;
    }();
    return files;
}

std::vector<Include> all_includes() {
    const std::regex pattern("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
    std::vector<Include> includes;
    for (const fs::path& path : source_files()) {
        const fs::path file = fs::relative(path, SWAGE_SOURCE_DIR "/src");
        std::ifstream in(path);
        for (std::string line; std::getline(in, line);) {
            std::smatch match;
            if (!std::regex_search(line, match, pattern)) continue;
            includes.push_back({file, file.begin()->string(), match[1]});
        }
    }
    return includes;
}

// The types that a file defines in namespaces that have a name, which all of the program sees.
// Each namespace ends with its comment, as the formatter writes it; nothing in it is indented.
std::vector<std::string> types_for_all(const fs::path& path) {
    const std::regex begin("^namespace ([\\w:]*) ?\\{$"), end("^\\}  // namespace.*");
    const std::regex type(
        "^(?:template <.*> )?(?:struct|class|union|enum|enum class) (?:alignas\\(\\w+\\) )?(\\w+)"
        "(?: final)?(?: : [^{]*)?(?: \\{.*)?$|^using (\\w+) =.*");
    std::vector<std::string> types, inside;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (std::regex_match(line, match, begin)) {
            inside.push_back(match[1]);
        } else if (std::regex_match(line, end)) {
            REQUIRE(!inside.empty());
            inside.pop_back();
        } else if (!inside.empty() && !inside.back().empty() &&
                   std::regex_match(line, match, type)) {
            types.push_back(inside.back() + "::" + match[1].str() + match[2].str());
        }
    }
    REQUIRE(inside.empty());
    return types;
}

}  // namespace

TEST_CASE("rooms include only themselves and lower floors") {
    REQUIRE(source_files().size() > 50);
    for (const Include& include : all_includes()) {
        const auto slash = include.what.find('/');
        if (slash == std::string::npos) continue;
        const std::string room = include.what.substr(0, slash);
        if (!kFloor.count(room)) continue;
        INFO(include.file << " includes " << include.what);
        REQUIRE(kFloor.count(include.room) == 1);
        CHECK((room == include.room || kFloor.at(room) < kFloor.at(include.room)));
    }
}

TEST_CASE("each outside library is seen by one room and few files") {
    const std::vector<Include> includes = all_includes();
    for (const Library& library : kLibrary) {
        std::set<fs::path> seen;
        for (const Include& include : includes) {
            if (include.what.rfind(library.header, 0) != 0) continue;
            INFO(include.file << " includes " << include.what);
            CHECK((library.room == "*" || include.room == library.room));
            seen.insert(include.file);
        }
        INFO(library.header << " is seen by " << seen.size() << " files");
        CHECK(seen.size() <= library.most_files);
    }
}

TEST_CASE("no two files define a type of one name") {
    std::map<std::string, fs::path> defined;
    for (const fs::path& path : source_files()) {
        INFO(path);
        for (const std::string& type : types_for_all(path)) {
            const auto [first, is_new] = defined.emplace(type, path);
            INFO(type << " is in " << first->second << " too");
            CHECK(is_new);
        }
    }
    CHECK(defined.size() > 300);
}

TEST_CASE("what is kept asks no C library for its last bits") {
    const std::regex unlike(
        "std::(a?(sin|cos|tan)h?|atan2|exp[m12]*|log(10|1p|2)?|pow|hypot|cbrt)\\(|AngleAxis|"
        "angularDistance|slerp");
    for (const fs::path& path : source_files()) {
        const std::string room = fs::relative(path, SWAGE_SOURCE_DIR "/src").begin()->string();
        if (room == "render" || room == "verify") continue;  // pictures; what is compared with
        std::ifstream in(path);
        for (std::string line; std::getline(in, line);) {
            INFO(path << ": " << line);
            CHECK(!std::regex_search(line, unlike));
        }
    }
}

TEST_CASE("no file hides a second concept behind its length, and each names its licence") {
    for (const fs::path& path : source_files()) {
        std::ifstream in(path);
        std::string line, first;
        int lines = 0;
        while (std::getline(in, line)) {
            if (lines++ == 0) first = line;
        }
        INFO(path);
        CHECK(lines <= 500);
        CHECK(first.find("SPDX-License-Identifier: GPL-3.0-or-later") != std::string::npos);
    }
}
