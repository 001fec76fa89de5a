// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 passes over in a 3MF file is set right before it reads it: the unit of its
// lengths, and parts of the model that stand in files of their own (production extension), which
// are put into the one that it reads. Sources: 3MF Core Specification 1.3; Production Extension
// 1.1.
#include <algorithm>
#include <cstring>
#include <map>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"
#include "geometry/zip.h"

namespace swage {

namespace {

// The tags of an XML text one after another, as far as a model needs them.
struct Attribute {
    std::string_view name, value;
};
struct Tag {
    std::string_view whole, name;  // without a prefix
    bool closes = false;           // </name>
    std::vector<Attribute> attribute;

    // Whatever its prefix.
    std::optional<std::string_view> find(std::string_view wanted) const;
    bool is_empty() const { return whole.ends_with("/>"); }
};

std::string_view local_name(std::string_view name) {
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::optional<std::string_view> Tag::find(std::string_view wanted) const {
    for (const Attribute& one : attribute)
        if (local_name(one.name) == wanted && !one.name.starts_with("xmlns")) return one.value;
    return std::nullopt;
}

bool next_tag(std::string_view& text, Tag& tag) {
    constexpr std::string_view kBlank = " \t\r\n";
    for (;;) {
        const std::size_t begin = text.find('<');
        if (begin == std::string_view::npos) return false;
        text.remove_prefix(begin);
        const char* closing = text.starts_with("<!--")        ? "-->"
                              : text.starts_with("<![CDATA[") ? "]]>"
                              : text.starts_with("<?")        ? "?>"
                              : text.starts_with("<!")        ? ">"
                                                              : nullptr;
        if (closing == nullptr) break;
        const std::size_t end = text.find(closing);
        if (end == std::string_view::npos) return false;
        text.remove_prefix(end + std::strlen(closing));
    }
    tag.attribute.clear();
    std::size_t at = 1;
    const auto skip = [&] { at = std::min(text.find_first_not_of(kBlank, at), text.size()); };
    const auto word = [&] {
        const std::size_t from = at;
        at = std::min(text.find_first_of(" \t\r\n=>", at), text.size());
        if (at < text.size() && text[at] == '>' && at > from && text[at - 1] == '/') --at;
        return text.substr(from, at - from);
    };
    tag.closes = text.starts_with("</");
    if (tag.closes) ++at;
    tag.name = local_name(word());
    for (skip(); at < text.size() && text[at] != '>'; skip()) {
        if (text[at] == '/') {
            ++at;
            continue;
        }
        Attribute one{word(), {}};
        skip();
        if (at >= text.size() || text[at] != '=')
            fail(ExitCode::mesh, "its model is damaged near '{}'", text.substr(0, 40));
        ++at;
        skip();
        const std::size_t end = at < text.size() && (text[at] == '"' || text[at] == '\'')
                                    ? text.find(text[at], at + 1)
                                    : std::string_view::npos;
        if (end == std::string_view::npos)
            fail(ExitCode::mesh, "its model is damaged near '{}'", text.substr(0, 40));
        one.value = text.substr(at + 1, end - at - 1);
        tag.attribute.push_back(one);
        at = end + 1;
    }
    if (at >= text.size()) return false;
    tag.whole = text.substr(0, at + 1);
    text.remove_prefix(at + 1);
    return true;
}

// Lengths of a model in m.
double unit_of(const Tag& model) {
    static const std::map<std::string_view, double> units = {
        {"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
        {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1}};
    const std::string_view name = model.find("unit").value_or("millimeter");
    const auto found = units.find(name);
    if (found == units.end()) fail(ExitCode::mesh, "'{}' is no unit of 3MF", name);
    return found->second;
}

void check_extensions(const Tag& model) {
    std::string_view wanted = model.find("requiredextensions").value_or("");
    for (std::string_view prefix; !(prefix = next_word(wanted)).empty();) {
        std::string_view name = prefix;
        for (const Attribute& one : model.attribute)
            if (one.name.starts_with("xmlns:") && one.name.substr(6) == prefix) name = one.value;
        bool is_known = false;
        for (const char* known : {"/3dmanufacturing/core/", "/3dmanufacturing/production/",
                                  "/3dmanufacturing/material/", "/3dmanufacturing/trianglesets/"})
            is_known = is_known || name.find(known) != std::string_view::npos;
        if (!is_known)
            fail(ExitCode::mesh,
                 "to be read rightly it asks for the extension {}, which is not known here; save "
                 "it without",
                 name);
    }
}

long long id_of(std::string_view text) {
    long long id = 0;
    if (!to_integer(trimmed(text), id) || id < 0 || id > 0x7fffffff)
        fail(ExitCode::mesh, "'{}' is no number of a resource", text.substr(0, 40));
    return id;
}

std::string without_root(std::string_view path) {
    while (path.starts_with('/')) path.remove_prefix(1);
    return std::string(path);
}

// A text with pieces of it exchanged, from its begin to its end.
class Edit {
  public:
    explicit Edit(std::string_view text) : text_(text) {}
    void exchange(std::string_view piece, std::string_view by) {
        const auto at = static_cast<std::size_t>(piece.data() - text_.data());
        out_ += text_.substr(done_, at - done_);
        out_ += by;
        done_ = at + piece.size();
    }
    std::string finish() { return out_ + std::string(text_.substr(done_)); }

  private:
    std::string_view text_;
    std::string out_;
    std::size_t done_ = 0;
};

class ModelMerge {
  public:
    ModelMerge(MeshSource& source, Zip& zip, std::string root)
        : source_(source), zip_(zip), root_(std::move(root)), text_(zip.contents(root_)) {}

    double apply() {
        std::string_view rest = text_;
        bool is_merged = false, has_beams = false;
        for (Tag tag; next_tag(rest, tag);) {
            if (tag.name == "model" && !tag.closes) {
                unit_ = unit_of(tag);
                check_extensions(tag);
            }
            has_beams = has_beams || tag.name == "beamlattice";
            if (tag.name == "component" || tag.name == "item")
                is_merged = is_merged || tag.find("path").has_value();
            if (const auto id = tag.find("id"); id && tag.name != "model")
                free_id_ = std::max(free_id_, id_of(*id) + 1);
        }
        if (is_merged) zip_.replace(root_, merged());
        if (has_beams || has_beams_) source_.finding.emplace_back("beam lattices were left out");
        return unit_;
    }

  private:
    std::string merged() {
        Edit edit(text_);
        std::string_view rest = text_;
        // What parts hold comes first: assimp looks for what an object names above it.
        for (Tag tag; next_tag(rest, tag);)
            if ((tag.name == "component" || tag.name == "item") && tag.find("path"))
                take_part(without_root(*tag.find("path")));
        rest = text_;
        for (Tag tag; next_tag(rest, tag);) {
            if (tag.name == "resources" && !tag.closes) {
                edit.exchange(tag.whole, tag.is_empty() ? "<resources>" + parts_ + "</resources>"
                                                        : "<resources>" + parts_);
            } else if ((tag.name == "component" || tag.name == "item") && tag.find("path")) {
                const long long shift = shift_.at(without_root(*tag.find("path")));
                for (const Attribute& one : tag.attribute) {
                    if (local_name(one.name) == "objectid")
                        edit.exchange(one.value, fmt::format("{}", id_of(one.value) + shift));
                    if (local_name(one.name) == "path")
                        edit.exchange({one.name.data(), static_cast<std::size_t>(
                                                            one.value.data() + one.value.size() +
                                                            1 - one.name.data())},
                                      "");
                }
            }
        }
        return edit.finish();
    }

    // Its resources, each by a number that no other has.
    void take_part(const std::string& name) {
        if (!shift_.try_emplace(name, name == root_ ? 0 : free_id_).second || name == root_) return;
        const std::string text = zip_.contents(name);
        const long long shift = free_id_;
        std::string_view rest = text;
        std::string_view from, to;
        for (Tag tag; next_tag(rest, tag);) {
            if (tag.name == "model" && !tag.closes) {
                check_extensions(tag);
                if (unit_of(tag) != unit_)
                    fail(ExitCode::mesh, "its part '{}' has another unit than the model", name);
            }
            if (tag.name == "component" && tag.find("path"))
                fail(ExitCode::mesh, "its part '{}' names a further part", name);
            has_beams_ = has_beams_ || tag.name == "beamlattice";
            if (tag.name == "resources" && !tag.is_empty()) (tag.closes ? to : from) = tag.whole;
        }
        if (from.empty() || to.empty() || to.data() < from.data())
            fail(ExitCode::mesh, "its part '{}' holds no resources", name);
        const char* begin = from.data() + from.size();
        const std::string_view inner(begin, static_cast<std::size_t>(to.data() - begin));
        Edit edit(inner);
        rest = inner;
        for (Tag tag; next_tag(rest, tag);)
            for (const Attribute& one : tag.attribute) {
                const std::string_view kind = local_name(one.name);
                const bool is_id = kind == "id" || kind == "pid" || kind == "objectid" ||
                                   kind == "texid" || kind == "matid" ||
                                   kind == "displaypropertiesid";
                if (!is_id && kind != "pids") continue;
                std::string shifted;
                std::string_view ids = one.value;
                for (std::string_view id; !(id = next_word(ids)).empty();) {
                    const long long value = id_of(id) + shift;
                    free_id_ = std::max(free_id_, value + 1);
                    if (!shifted.empty()) shifted += ' ';
                    shifted += fmt::format("{}", value);
                }
                edit.exchange(one.value, shifted);
            }
        parts_ += edit.finish();
    }

    MeshSource& source_;
    Zip& zip_;
    const std::string root_;
    const std::string text_;
    double unit_ = 1e-3;
    long long free_id_ = 1;
    std::map<std::string, long long> shift_;  // of the resources of a part
    std::string parts_;
    bool has_beams_ = false;
};

}  // namespace

double patch_3mf(MeshSource& source) {
    Zip zip(source.bytes, source.file_bytes);
    const std::string relations = zip.contents("_rels/.rels");
    std::string_view rest = relations;
    for (Tag tag; next_tag(rest, tag);) {
        if (tag.name != "Relationship" || !tag.find("Type").value_or("").ends_with("/3dmodel"))
            continue;
        return ModelMerge(source, zip, without_root(tag.find("Target").value_or(""))).apply();
    }
    fail(ExitCode::mesh, "not a readable .3mf file (it names no model)");
}

}  // namespace swage
