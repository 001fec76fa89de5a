// SPDX-License-Identifier: GPL-3.0-or-later
// A TOML file as a tree whose every key and value knows where it stands. The TOML library is seen
// by document.cpp alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text_error.h"
#include "scene/mistake.h"

namespace swage {

struct Source {
    std::filesystem::path file;  // as shown to the user; an override: "--set KEY=VALUE"
    std::string text;
};

struct Place {
    std::shared_ptr<const Source> source;
    int line = 0, column = 0;  // from 1, columns in letters; 0: the source as a whole
};

struct Entry;

struct Node {
    enum class Kind { table, array, text, whole, real, truth, date };
    Kind kind = Kind::table;
    Place place;
    std::string text;   // a text
    double number = 0;  // whole, real
    bool truth = false;
    std::vector<Entry> entry;  // of a table, in the order of the file
    std::vector<Node> item;    // of an array

    const Entry* find(std::string_view key) const;
    Entry* find(std::string_view key);
};

struct Entry {
    std::string key;
    Place place;
    Node value;
};

// At a place that has no source: of no file.
Mistake mistake_at(const Place& place, const std::string& text, ExitCode code = ExitCode::scene);

// The place of byte `at` of a text's value: inside the quotes where the file has the text letter
// by letter, else the text's own.
Place place_inside(const Node& text, std::size_t at);

// "a text", "a whole number", ...
std::string kind_text(const Node& node);

// What a tree says at one of its keys.
struct Said {
    std::string key;    // "stage.1.angle"
    std::string value;  // the same for what means the same
    std::string shown;  // as it stands there, if it is short
};

// All of it, by key, wherever and in whatever order it stands. `number`: what texts were read as.
std::vector<Said> said_in(const Node& root, const std::map<const Node*, double>& number);

// The same for rooms below.
TextPlace text_place(const Place& place);
Mistake mistake_at(const TextPlace& place, const std::string& text, ExitCode code);

// Mistakes in the order in which they are found; beyond a limit they are only counted.
class MistakeList {
  public:
    void add(const Place& place, const std::string& text, ExitCode code = ExitCode::scene);
    void warn(const Place& place, const std::string& text);
    void add(std::vector<Mistake> mistakes);  // of a file that was read apart
    bool is_full() const { return found_.size() >= kLimit; }
    bool is_clean() const { return errors_ == 0; }  // warnings do not count

    // Those of the file `first`, then those of the others in the order of `add`; each file's in the
    // order of its lines.
    std::vector<Mistake> take(const std::filesystem::path& first);

  private:
    static constexpr std::size_t kLimit = 200;
    void put(Mistake mistake);

    std::vector<Mistake> found_;
    std::size_t errors_ = 0, left_out_ = 0;
};

struct Document {
    std::shared_ptr<const Source> source;
    Node root;
    // False when lines with broken syntax were left out: what seems missing may stand there.
    bool is_complete = true;
};

// Nothing when no tree could be made. `shown`: how mistakes call the file.
std::optional<Document> read_document(const std::filesystem::path& file,
                                      const std::filesystem::path& shown, MistakeList& mistakes);
// The same of what is piped in.
std::optional<Document> read_piped_document(const std::filesystem::path& shown,
                                            MistakeList& mistakes);

// One value as it stands after an = sign; what is no TOML is taken as a text.
Node parse_value(std::string_view text, const Place& place);

// The path from the current folder when the file lies below it, else as it is.
std::filesystem::path shown_path(const std::filesystem::path& file);

}  // namespace swage
