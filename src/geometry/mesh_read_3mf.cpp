// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 passes over in a 3MF file is set right before it reads it: the unit of its
// lengths, parts of the model that stand in files of their own (production extension), which are
// put into the one that it reads, and colours in other lists than it knows (materials extension).
// The one file that sees pugixml. Sources: 3MF Core Specification 1.3; Production Extension 1.1;
// Materials and Properties Extension 1.2.
#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <set>

#include "base/error.h"
#include "base/text.h"
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

// Sets an attribute that the element may have.
void give(xml_node element, const char* name, const std::string& value) {
    xml_attribute one = attribute_of(element, name);
    if (!one) one = element.append_attribute(name);
    one.set_value(value.c_str());
}

// assimp gives all of an object one material, of those lists that it knows, and it is that of the
// object or of its last triangle that names one. What else a model says of its look is brought to
// that, and told.
class LookSettler {
  public:
    explicit LookSettler(xml_node model) : resources_(child_of(model, "resources")) {}

    void settle() {
        for (xml_node one = resources_.first_child(); one;) {
            const xml_node next = one.next_sibling();
            settle_list(one);
            one = next;
        }
        for (const xml_node& object : resources_.children()) {
            if (name_of(object) == "object") settle_object(object);
        }
    }

    bool is_changed() const { return is_changed_; }
    void tell(MeshSource& source) const {
        for (const std::string& kind : lost_) {
            source.tell_of_look((kind == "texture2dgroup"    ? "its images ("
                                 : kind == "multiproperties" ? "materials of several parts ("
                                                             : "mixtures of materials (") +
                                kind + ") were left out");
        }
        if (others_ > 0) {
            source.tell_of_look(
                fmt::format("{} another colour than most of their object, which "
                            "all of it was given",
                            counted(others_, "triangle has", "triangles have")));
        }
    }

  private:
    using Property = std::pair<std::string, std::string>;  // a list, and a place in it

    void settle_list(xml_node list) {
        const std::string name(name_of(list));
        const std::string id = attribute_of(list, "id").value();
        if (name == "basematerials") {
            known_.insert(id);
        } else if (name == "colorgroup") {  // as base materials
            known_.insert(id);
            is_changed_ = true;
            list.set_name("basematerials");
            int number = 0;
            for (xml_node color : list.children()) {
                if (name_of(color) != "color") continue;
                color.set_name("base");
                give(color, "name", fmt::format("color-{}", ++number));
                give(color, "displaycolor", attribute_of(color, "color").value());
            }
        } else if (name == "texture2dgroup" || name == "multiproperties" ||
                   name == "compositematerials" || name == "texture2d") {
            is_changed_ = true;
            if (name != "texture2d") lost_.insert(name);
            resources_.remove_child(list);
        }
    }

    // Of a triangle, or of its object where it names none itself.
    static Property property_of(const xml_node& element, const char* place, const Property& other) {
        const xml_attribute list = attribute_of(element, "pid"), own = attribute_of(element, place);
        if (!list && !own) return other;
        return {list ? list.value() : other.first, own.as_string("0")};
    }

    void settle_object(xml_node object) {
        const Property own = property_of(object, "pindex", {});
        const xml_node triangles = child_of(child_of(object, "mesh"), "triangles");
        std::map<Property, std::size_t> count;  // of triangles of one property
        std::size_t all = 0;
        const auto changes = [](const xml_node& triangle) {
            const std::string_view first = attribute_of(triangle, "p1").value();
            for (const char* corner : {"p2", "p3"}) {
                if (attribute_of(triangle, corner).as_string(std::string(first).c_str()) != first)
                    return true;
            }
            return false;
        };
        for (const xml_node& triangle : triangles.children()) {
            const Property property = property_of(triangle, "p1", own);
            if (known_.contains(property.first)) ++all, count[property] += !changes(triangle);
        }
        const auto most =
            std::ranges::max_element(count, {}, [](const auto& one) { return one.second; });
        const bool is_one = count.empty() || (count.size() == 1 && most->second == all);
        if (!is_one) others_ += all - most->second;
        const Property look = count.empty() ? Property() : most->first;
        if (is_one && look == own) return;  // its triangles may say so too
        is_changed_ = true;
        for (const char* name : {"pid", "pindex"})
            object.remove_attribute(attribute_of(object, name));
        if (!count.empty()) give(object, "pid", look.first), give(object, "pindex", look.second);
        for (xml_node triangle : triangles.children()) {
            for (const char* name : {"pid", "p1", "p2", "p3"})
                triangle.remove_attribute(attribute_of(triangle, name));
        }
    }

    xml_node resources_;
    std::set<std::string> known_, lost_;
    std::size_t others_ = 0;
    bool is_changed_ = false;
};

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
        LookSettler look(model);
        look.settle();
        look.tell(source_);
        tell_of_types(model);
        std::string merged;
        if (named.empty() && !look.is_changed()) {
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

    // What is built, but is no model: of supports the core specification says that they are not to
    // be part of what is made.
    void tell_of_types(const xml_node& model) const {
        std::set<std::string_view> built;
        visit_elements(model, [&](const xml_node& element) {
            if (name_of(element) == "item" || name_of(element) == "component")
                built.insert(attribute_of(element, "objectid").value());
        });
        for (const xml_node& object : child_of(model, "resources").children()) {
            const std::string_view id = attribute_of(object, "id").value(),
                                   type = attribute_of(object, "type").as_string("model");
            if (name_of(object) != "object" || type == "model" || !built.contains(id)) continue;
            source_.finding.push_back(fmt::format(
                "object {} is of type '{}' and becomes matter all the same: take it out of the "
                "file where it is no part of the body",
                id, type.substr(0, 40)));
        }
    }

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
