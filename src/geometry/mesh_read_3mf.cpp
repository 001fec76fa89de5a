// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 passes over in a 3MF file is set right before it reads it: the unit of its
// lengths, and parts of the model that stand in files of their own (production extension), which
// are put into the one that it reads. The one file that sees pugixml. Sources: 3MF Core
// Specification 1.3; Production Extension 1.1.
#include <algorithm>
#include <map>
#include <pugixml.hpp>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"
#include "geometry/zip.h"

namespace swage {

namespace {

using pugi::xml_attribute;
using pugi::xml_node;

// Of an element or an attribute, without its prefix.
template <typename Named>
std::string_view name_of(const Named& one) {
    const std::string_view name = one.name();
    return name.substr(name.find(':') + 1);
}

// An empty one, whose value is "", where there is none.
xml_attribute attribute_of(const xml_node& element, std::string_view name) {
    return element.find_attribute([&](const xml_attribute& one) {
        return name_of(one) == name && !std::string_view(one.name()).starts_with("xmlns");
    });
}

xml_node child_of(const xml_node& element, std::string_view name) {
    return element.find_child([&](const xml_node& one) { return name_of(one) == name; });
}

// Each below `top`, in order.
template <typename Visit>
void visit_elements(xml_node top, const Visit& visit) {
    struct Walker : pugi::xml_tree_walker {
        explicit Walker(const Visit& given) : visit_one(given) {}
        bool for_each(xml_node& node) override {
            if (node.type() == pugi::node_element) visit_one(node);
            return true;
        }
        const Visit& visit_one;
    } walker(visit);
    top.traverse(walker);
}

void check_parsed(const pugi::xml_parse_result& parsed, const std::string& part) {
    if (parsed.status == pugi::status_out_of_memory) throw std::bad_alloc();
    if (!parsed)
        fail(ExitCode::mesh, "its part '{}' is damaged near byte {} ({})", part, parsed.offset,
             parsed.description());
}

// Lengths of a model in m.
double unit_of(const xml_node& model) {
    static const std::map<std::string_view, double> units = {
        {"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
        {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1}};
    const std::string_view name = attribute_of(model, "unit").as_string("millimeter");
    const auto found = units.find(name);
    if (found == units.end()) fail(ExitCode::mesh, "'{}' is not a unit of 3MF", name);
    return found->second;
}

void check_extensions(const xml_node& model) {
    std::string_view wanted = attribute_of(model, "requiredextensions").value();
    for (std::string_view prefix; !(prefix = next_word(wanted)).empty();) {
        const std::string given(prefix);
        const std::string_view name =
            model.attribute(("xmlns:" + given).c_str()).as_string(given.c_str());
        bool is_known = false;
        for (const char* known : {"/3dmanufacturing/core/", "/3dmanufacturing/production/",
                                  "/3dmanufacturing/material/", "/3dmanufacturing/trianglesets/"})
            is_known = is_known || name.find(known) != std::string_view::npos;
        if (!is_known)
            fail(ExitCode::mesh,
                 "it requires the extension {}, which is not supported; save it without", name);
    }
}

long long id_of(std::string_view text) {
    long long id = 0;
    if (!to_integer(trimmed(text), id) || id < 0 || id > 0x7fffffff)
        fail(ExitCode::mesh, "'{}' is not a resource number", text.substr(0, 40));
    return id;
}

std::string without_root(std::string_view path) {
    while (path.starts_with('/')) path.remove_prefix(1);
    return std::string(path);
}

class ModelMerge {
  public:
    ModelMerge(MeshSource& source, std::string root)
        : source_(source), root_(std::move(root)), text_(contents(root_)) {}

    double apply() {
        check_parsed(document_.load_buffer_inplace(text_.data(), text_.size()), root_);
        const xml_node model = document_.document_element();
        check_extensions(model);
        unit_ = unit_of(model);
        std::vector<xml_node> named;  // those that name a part
        visit_elements(model, [&](const xml_node& element) {
            has_beams_ = has_beams_ || name_of(element) == "beamlattice";
            if (names_part(element)) named.push_back(element);
            if (const xml_attribute id = attribute_of(element, "id"))
                free_id_ = std::max(free_id_, id_of(id.value()) + 1);
        });
        if (!named.empty()) merge(model, named);
        check_places(model);
        std::string merged;
        if (named.empty()) {
            merged = contents(root_);
        } else {
            TextWriter writer;
            model.print(writer, "", pugi::format_raw);
            merged = std::move(writer.text);
        }
        document_.reset();
        text_.clear();
        // Also where nothing was merged: assimp does not read every kind of ZIP file (ZIP64, as
        // lib3mf writes), and this makes a plain one.
        replace_in_zip(source_.bytes, root_, merged);
        if (has_beams_) source_.finding.emplace_back("beam lattices were left out");
        return unit_;
    }

  private:
    struct TextWriter : pugi::xml_writer {
        void write(const void* data, std::size_t size) override {
            text.append(static_cast<const char*>(data), size);
        }
        std::string text;
    };

    // An object may be a component of many, which assimp makes a node of its own for each.
    void check_places(const xml_node& model) const {
        const auto numbers = [](const xml_node& list, std::string_view kind) {
            std::vector<std::size_t> all;
            for (const xml_node& one : list.children())
                if (name_of(one) == kind && attribute_of(one, "objectid"))
                    all.push_back(
                        static_cast<std::size_t>(id_of(attribute_of(one, "objectid").value())));
            return all;
        };
        const auto count_of = [](const xml_node& list) {
            return static_cast<double>(std::distance(list.begin(), list.end()));
        };
        std::map<std::size_t, std::size_t> place;  // of an object's number in the list
        std::vector<PlacedPart> parts;
        for (const xml_node& object : child_of(model, "resources").children()) {
            if (name_of(object) != "object" || !attribute_of(object, "id")) continue;
            place[static_cast<std::size_t>(id_of(attribute_of(object, "id").value()))] =
                parts.size();
            PlacedPart& part = parts.emplace_back();
            part.child = numbers(child_of(object, "components"), "component");
            const xml_node mesh = child_of(object, "mesh");
            part.bytes += count_of(child_of(mesh, "vertices")) * PlacedPart::kVertexBytes +
                          count_of(child_of(mesh, "triangles")) * PlacedPart::kTriangleBytes;
        }
        const auto placed = [&](std::vector<std::size_t> ids) {
            for (std::size_t& id : ids)
                id = place.contains(id) ? place.at(id) : parts.size();  // none
            return ids;
        };
        for (PlacedPart& part : parts) part.child = placed(part.child);
        check_placed(parts, placed(numbers(child_of(model, "build"), "item")),
                     source_.memory_bytes);
    }

    std::string contents(const std::string& part) const {
        return zip_contents(source_.bytes, part, source_.file_bytes);
    }

    static bool names_part(const xml_node& element) {
        return (name_of(element) == "component" || name_of(element) == "item") &&
               attribute_of(element, "path");
    }

    void merge(xml_node model, const std::vector<xml_node>& named) {
        xml_node resources = child_of(model, "resources");
        if (!resources) resources = model.prepend_child("resources");
        // What parts hold comes first: assimp looks for what an object names above it.
        const xml_node first = resources.prepend_child("part");
        for (xml_node element : named) {
            const xml_attribute path = attribute_of(element, "path");
            const std::string part = without_root(path.value());
            const auto [shift, is_new] = shift_.try_emplace(part, part == root_ ? 0 : free_id_);
            if (is_new && part != root_)
                for (xml_node resource = take_part(part, shift->second); resource;) {
                    const xml_node next = resource.next_sibling();
                    resources.insert_move_before(resource, first);
                    resource = next;
                }
            if (xml_attribute object = attribute_of(element, "objectid"))
                object.set_value(id_of(object.value()) + shift->second);
            element.remove_attribute(path);
        }
        resources.remove_child(first);
    }

    // The first of its resources, each by a number that no other has.
    xml_node take_part(const std::string& name, long long shift) {
        const std::string text = contents(name);
        check_parsed(document_.append_buffer(text.data(), text.size()), name);
        const xml_node model = document_.last_child();
        check_extensions(model);
        if (unit_of(model) != unit_)
            fail(ExitCode::mesh, "its part '{}' has a different unit from the model", name);
        visit_elements(model, [&](const xml_node& element) {
            has_beams_ = has_beams_ || name_of(element) == "beamlattice";
            if (name_of(element) == "component" && attribute_of(element, "path"))
                fail(ExitCode::mesh, "its part '{}' refers to another part", name);
        });
        const xml_node resources = child_of(model, "resources");
        if (!resources.first_child())
            fail(ExitCode::mesh, "its part '{}' contains no resources", name);
        visit_elements(resources, [&](const xml_node& element) {
            for (xml_attribute one : element.attributes()) shift_ids(one, shift);
        });
        return resources.first_child();
    }

    void shift_ids(xml_attribute& attribute, long long shift) {
        if (std::find(std::begin(kIds), std::end(kIds), name_of(attribute)) == std::end(kIds))
            return;
        std::string shifted;
        std::string_view ids = attribute.value();
        for (std::string_view id; !(id = next_word(ids)).empty();) {
            const long long value = id_of(id) + shift;
            free_id_ = std::max(free_id_, value + 1);
            if (!shifted.empty()) shifted += ' ';
            shifted += fmt::format("{}", value);
        }
        attribute.set_value(shifted.c_str());
    }

    static constexpr std::string_view kIds[] = {
        "id", "pid", "pids", "texid", "matid", "objectid", "displaypropertiesid"};

    MeshSource& source_;
    const std::string root_;
    std::string text_;             // of the model, in which the document points
    pugi::xml_document document_;  // the model, and behind it those of its parts
    double unit_ = 1e-3;
    long long free_id_ = 1;
    std::map<std::string, long long> shift_;  // of the resources of a part
    bool has_beams_ = false;
};

}  // namespace

double patch_3mf(MeshSource& source) {
    const std::string name = "_rels/.rels";
    std::string text = zip_contents(source.bytes, name, source.file_bytes);
    pugi::xml_document relations;
    check_parsed(relations.load_buffer_inplace(text.data(), text.size()), name);
    const xml_node relation = relations.find_node([](const xml_node& one) {
        return name_of(one) == "Relationship" &&
               std::string_view(attribute_of(one, "Type").value()).ends_with("/3dmodel");
    });
    if (!relation) fail(ExitCode::mesh, "not a readable .3mf file (it names no model)");
    return ModelMerge(source, without_root(attribute_of(relation, "Target").value())).apply();
}

}  // namespace swage
