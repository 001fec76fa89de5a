// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 takes a glTF file's bits wrongly for is set right in the document before it reads
// it. Whole numbers that stand for positions, normals and texture coordinates (glTF 2.0,
// section 3.6.2; KHR_mesh_quantization) become floats in a buffer of their own, instances
// (EXT_mesh_gpu_instancing) nodes; an extension that nobody here follows is told of or refused.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "geometry/gltf_bytes.h"

namespace swage {

namespace {

using Json = nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kInstances = "EXT_mesh_gpu_instancing";
constexpr int kFloat = 5126;

// A list of the document; an empty one where it has none.
const Json& list_of(const Json& from, const char* key) {
    static const Json none = Json::array();
    const auto found = from.find(key);
    return found != from.end() && found->is_array() ? *found : none;
}

class GltfPatch {
  public:
    GltfPatch(MeshSource& source, Json& document, const std::string& rest)
        : source_(source), document_(document), rest_(rest) {}

    // True when the document was changed.
    bool apply() {
        check_extensions();
        tell_unlike(Unlike::clear, "alphaMode", [](const Json& material) {
            return material.value("alphaMode", "OPAQUE") != "OPAQUE";
        });
        tell_unlike(Unlike::bright, "emissiveFactor", shines);
        tell_unlike(Unlike::clamped, "wrapS, wrapT",
                    [&](const Json& material) { return clamps(material); });
        bool changed = decode_names();
        changed = name_uv_sets() || changed;
        for (const Json& mesh : list_of(document_, "meshes"))
            for (const Json& primitive : list_of(mesh, "primitives")) {
                const bool packed = has_extension(primitive, kDraco);
                if (const auto at = primitive.find("attributes"); at != primitive.end())
                    unfold(*at, packed);
                for (const Json& target : list_of(primitive, "targets")) unfold(target, packed);
            }
        for (std::size_t n = list_of(document_, "nodes").size(); n-- > 0;)
            if (has_extension(document_["nodes"][n], kInstances)) {
                place_instances(n);
                changed = true;
            }
        check_places();
        if (floats_.empty()) return changed;
        document_["buffers"].push_back(
            {{"byteLength", floats_.size()},
             {"uri", "data:application/octet-stream;base64," + to_base64(floats_)}});
        return true;
    }

  private:
    struct Data {
        const char* first;
        std::size_t stride;
        const char* at(std::size_t i) const { return first + stride * i; }
    };

    static bool has_extension(const Json& object, const char* name) {
        const auto at = object.find("extensions");
        return at != object.end() && at->contains(name);
    }

    void check_extensions() {
        std::string unknown, unlike;
        const auto add_to = [](std::string& list, const std::string& name) {
            list += fmt::format("{}'{}'", list.empty() ? "" : ", ", name);
        };
        static const std::set<std::string> known = {
            "KHR_mesh_quantization", "KHR_texture_transform", "KHR_materials_pbrSpecularGlossiness",
            kDraco, kInstances};
        for (const Json& extension : list_of(document_, "extensionsRequired")) {
            const auto name = extension.get<std::string>();
            if (known.contains(name)) continue;
            bool is_of_looks = false;
            for (const char* kind :
                 {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_"})
                is_of_looks = is_of_looks || name.starts_with(kind);
            add_to(is_of_looks ? unlike : unknown, name);
        }
        if (!unknown.empty())
            fail(ExitCode::mesh, "it requires {}, which is not supported; save it without",
                 unknown);
        if (!unlike.empty())
            source_.tell_of_look(
                fmt::format("it uses {}, which is not supported: it may look different", unlike));
    }

    template <typename Test>
    void tell_unlike(Unlike how, const char* by, const Test& test) {
        std::string name;
        std::size_t count = 0;
        for (const Json& material : list_of(document_, "materials")) {
            if (!test(material)) continue;
            if (count++ == 0) name = material.value("name", "");
        }
        if (count > 0) source_.tell_of_look(unlike_sentence(how, count, name, by));
    }

    // The factor multiplies the image; without one there is no light.
    static bool shines(const Json& material) {
        const Json& factor = list_of(material, "emissiveFactor");
        return std::any_of(factor.begin(), factor.end(),
                           [](const Json& one) { return one.is_number() && one != 0; });
    }

    // An entry of a list of the document by the number that `from` has for it; an empty one where
    // there is none.
    const Json& named_by(const Json& from, const char* number, const char* list) const {
        static const Json none = Json::object();
        const Json& all = list_of(document_, list);
        const auto at = from.find(number);
        const bool is_there =
            at != from.end() && at->is_number_unsigned() && at->get<std::size_t>() < all.size();
        return is_there ? all[at->get<std::size_t>()] : none;
    }

    bool clamps(const Json& material) const {
        constexpr int kRepeat = 10497;
        const auto surface = material.find("pbrMetallicRoughness");
        if (surface == material.end() || !surface->contains("baseColorTexture")) return false;
        const Json& texture = named_by((*surface)["baseColorTexture"], "index", "textures");
        const Json& sampler = named_by(texture, "sampler", "samplers");
        return sampler.value("wrapS", kRepeat) != kRepeat ||
               sampler.value("wrapT", kRepeat) != kRepeat;
    }

    // assimp looks for "my%20data.bin" by that name alone.
    bool decode_names() {
        bool changed = false;
        for (std::size_t n = 0; n < list_of(document_, "buffers").size(); ++n) {
            Json& buffer = document_["buffers"][n];
            const auto uri = buffer.value("uri", std::string());
            const std::filesystem::path folder = source_.file.parent_path();
            std::error_code ignored;
            if (uri.empty() || uri.starts_with("data:") || uri.find('%') == std::string::npos ||
                std::filesystem::is_regular_file(folder / uri, ignored))
                continue;
            buffer["uri"] = url_decoded(uri);
            changed = true;
        }
        return changed;
    }

    // A transform of an image may name another set of texture coordinates than the image does,
    // which alone assimp looks at.
    bool name_uv_sets() {
        const Json::json_pointer image("/pbrMetallicRoughness/baseColorTexture");
        const auto own = image / "extensions" / "KHR_texture_transform" / "texCoord";
        bool changed = false;
        for (std::size_t n = 0; n < list_of(document_, "materials").size(); ++n) {
            Json& material = document_["materials"][n];
            if (!material.contains(own)) continue;
            material[image]["texCoord"] = Json(material[own]);
            changed = true;
        }
        return changed;
    }

    void unfold(const Json& attributes, bool packed) {
        for (const auto& [name, accessor] : attributes.items())
            if (name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                name.starts_with("TEXCOORD_"))
                unfold(name, accessor.get<std::size_t>(), packed);
    }

    // Whole numbers become floats.
    void unfold(const std::string& name, std::size_t id, bool packed) {
        Json& accessors = document_["accessors"];
        if (!accessors.is_array() || id >= accessors.size()) return;  // assimp refuses it
        Json& accessor = accessors[id];
        if (accessor.value("componentType", 0) == kFloat) return;
        if (packed)
            fail(ExitCode::mesh,
                 "{} is stored as integers within {}, which cannot be read; save it without", name,
                 kDraco);
        const std::vector<float> value = values_of(accessor);
        const std::size_t bytes = value.size() * sizeof(float);
        Json& views = document_["bufferViews"];
        accessor = {{"bufferView", views.size()},
                    {"componentType", kFloat},
                    {"count", accessor.at("count")},
                    {"type", accessor.at("type")}};
        views.push_back({{"buffer", list_of(document_, "buffers").size()},
                         {"byteOffset", floats_.size()},
                         {"byteLength", bytes}});
        floats_.append(reinterpret_cast<const char*>(value.data()), bytes);
    }

    // A node whose mesh stands at many places gets a child for each of them.
    void place_instances(std::size_t n) {
        Json& nodes = document_["nodes"];
        const Json attributes = nodes[n]["extensions"][kInstances].value("attributes", Json());
        nodes[n]["extensions"].erase(kInstances);
        std::size_t count = 0;
        std::map<std::string, std::vector<float>> of;
        const std::pair<const char*, const char*> kinds[] = {
            {"TRANSLATION", "translation"}, {"ROTATION", "rotation"}, {"SCALE", "scale"}};
        for (const auto& [attribute, property] : kinds) {
            const auto at = attributes.find(attribute);
            if (at == attributes.end()) continue;
            const Json& accessor = list_of(document_, "accessors").at(at->get<std::size_t>());
            const std::size_t width = property[0] == 'r' ? 4 : 3;
            of[property] = values_of(accessor);
            const std::size_t places = of[property].size() / width;
            if (of[property].size() != places * width || (count != 0 && count != places))
                fail(ExitCode::mesh, "node {}: its instances' attributes do not fit together", n);
            count = places;
        }
        if (!nodes[n].contains("mesh") || count == 0) return;
        Json child = {{"mesh", nodes[n]["mesh"]}};
        if (nodes[n].contains("name")) child["name"] = nodes[n]["name"];
        nodes[n].erase("mesh");
        for (std::size_t i = 0; i < count; ++i) {
            for (const auto& [property, value] : of) {
                const std::size_t width = value.size() / count;
                child[property] = std::vector<float>(
                    value.begin() + static_cast<std::ptrdiff_t>(width * i),
                    value.begin() + static_cast<std::ptrdiff_t>(width * (i + 1)));
            }
            nodes[n]["children"].push_back(nodes.size());
            nodes.push_back(child);
        }
    }

    // A node may be the child of many, which assimp makes a node of its own for each.
    void check_places() const {
        const auto numbers = [](const Json& list) {
            std::vector<std::size_t> all;
            for (const Json& one : list)
                if (one.is_number_unsigned()) all.push_back(one.get<std::size_t>());
            return all;
        };
        const auto count_of = [&](const Json& from, const char* number) {
            const Json& accessor = named_by(from, number, "accessors");
            const auto count = accessor.find("count");
            return count != accessor.end() && count->is_number() ? count->get<double>() : 0.0;
        };
        std::vector<double> mesh_bytes;
        for (const Json& mesh : list_of(document_, "meshes")) {
            mesh_bytes.push_back(0);
            for (const Json& primitive : list_of(mesh, "primitives")) {
                if (primitive.value("mode", 4) < 4) continue;  // points and lines
                const auto attributes = primitive.find("attributes");
                const double vertices =
                    attributes == primitive.end() ? 0 : count_of(*attributes, "POSITION");
                const double corners =
                    primitive.contains("indices") ? count_of(primitive, "indices") : vertices;
                mesh_bytes.back() +=
                    vertices * PlacedPart::kVertexBytes + corners / 3 * PlacedPart::kTriangleBytes;
            }
        }
        std::vector<PlacedPart> parts;
        for (const Json& node : list_of(document_, "nodes")) {
            PlacedPart& part = parts.emplace_back();
            part.child = numbers(list_of(node, "children"));
            const auto mesh = node.find("mesh");
            if (mesh != node.end() && mesh->is_number_unsigned() &&
                mesh->get<std::size_t>() < mesh_bytes.size())
                part.bytes += mesh_bytes[mesh->get<std::size_t>()];
        }
        const Json& scenes = list_of(document_, "scenes");
        const auto shown = document_.value("scene", std::size_t{0});
        if (shown < scenes.size())
            check_placed(parts, numbers(list_of(scenes[shown], "nodes")), source_.memory_bytes);
    }

    std::vector<float> values_of(const Json& accessor) {
        const int type = accessor.value("componentType", 0);
        const std::string shape = accessor.value("type", "");
        const std::size_t width = shape == "VEC2"   ? 2
                                  : shape == "VEC3" ? 3
                                  : shape == "VEC4" ? 4
                                                    : 0;
        const auto count = accessor.value("count", std::size_t{0});
        if (width == 0 || size_of(type) == 0)
            fail(ExitCode::mesh, "an accessor of {} has components of type {}", shape, type);
        if (count > 0x7fffffff) fail(ExitCode::mesh, "more vertices than can be handled");
        const bool normalized = accessor.value("normalized", false);
        std::vector<float> value(count * width, 0.f);
        const auto read = [&](const Data& data, std::size_t from, std::size_t to) {
            for (std::size_t k = 0; k < width; ++k)
                value[width * to + k] = static_cast<float>(
                    component(data.at(from) + size_of(type) * k, type, normalized));
        };
        if (accessor.contains("bufferView")) {
            const Data data = data_of(accessor, type, width, count);
            for (std::size_t i = 0; i < count; ++i) read(data, i, i);
        }
        if (const auto sparse = accessor.find("sparse"); sparse != accessor.end()) {
            const auto changed = sparse->at("count").get<std::size_t>();
            const Json& indices = sparse->at("indices");
            const int index_type = indices.value("componentType", 0);
            const Data index = data_of(indices, index_type, 1, changed);
            const Data data = data_of(sparse->at("values"), type, width, changed);
            for (std::size_t i = 0; i < changed; ++i) {
                const double to = component(index.at(i), index_type, false);
                if (!(to >= 0 && to < static_cast<double>(count)))
                    fail(ExitCode::mesh, "a sparse accessor changes entry {} of {}", to, count);
                read(data, i, static_cast<std::size_t>(to));
            }
        }
        return value;
    }

    static std::size_t size_of(int type) {
        switch (type) {
            case 5120:
            case 5121:
                return 1;
            case 5122:
            case 5123:
                return 2;
            case 5125:
            case kFloat:
                return 4;
            default:
                return 0;
        }
    }

    template <typename T>
    static double read_as(const char* from) {
        T value;
        std::memcpy(&value, from, sizeof value);
        return static_cast<double>(value);
    }
    static double component(const char* from, int type, bool normalized) {
        double value = 0, most = 1;
        switch (type) {
            case kFloat:
                return read_as<float>(from);
            case 5120:
                value = read_as<std::int8_t>(from);
                most = 127;
                break;
            case 5121:
                value = read_as<std::uint8_t>(from);
                most = 255;
                break;
            case 5122:
                value = read_as<std::int16_t>(from);
                most = 32767;
                break;
            case 5123:
                value = read_as<std::uint16_t>(from);
                most = 65535;
                break;
            default:
                value = read_as<std::uint32_t>(from);
                most = 4294967295.0;
        }
        return normalized ? std::max(value / most, -1.0) : value;
    }

    // The bytes of an accessor or of a part of a sparse one, all there.
    Data data_of(const Json& from, int type, std::size_t width, std::size_t count) {
        const auto view_id = from.at("bufferView").get<std::size_t>();
        const Json& view = list_of(document_, "bufferViews").at(view_id);
        const std::string& buffer = buffer_of(view.at("buffer").get<std::size_t>());
        const auto start = view.value("byteOffset", std::size_t{0});
        const auto length = view.at("byteLength").get<std::size_t>();
        const auto offset = from.value("byteOffset", std::size_t{0});
        const std::size_t item = size_of(type) * width;
        if (item == 0) fail(ExitCode::mesh, "components of type {} are invalid", type);
        const std::size_t stride = view.value("byteStride", item);
        const bool fits = start <= buffer.size() && length <= buffer.size() - start &&
                          stride >= item && stride <= 255 &&
                          (count == 0 || (item <= length && offset <= length - item &&
                                          count - 1 <= (length - item - offset) / stride));
        if (!fits)
            fail(ExitCode::mesh, "buffer view {} is shorter than what is read from it", view_id);
        return {buffer.data() + start + offset, stride};
    }

    const std::string& buffer_of(std::size_t id) {
        const auto [at, is_new] = buffer_.try_emplace(id);
        if (!is_new) return at->second;
        const Json& buffer = list_of(document_, "buffers").at(id);
        const auto uri = buffer.value("uri", std::string());
        if (uri.empty() && id == 0 && rest_.size() >= 8) {
            at->second = first_chunk(rest_);
        } else if (uri.starts_with("data:")) {
            const std::size_t comma = uri.find(',');
            if (comma == std::string::npos) fail(ExitCode::mesh, "buffer {} is empty", id);
            at->second = from_base64(std::string_view(uri).substr(comma + 1));
        } else {
            auto bytes = file_contents(source_.file.parent_path() / uri, source_.file_bytes);
            if (!bytes) fail(ExitCode::mesh, "its file '{}' is missing", uri);
            at->second = std::move(*bytes);
        }
        return at->second;
    }

    MeshSource& source_;
    Json& document_;
    const std::string& rest_;
    std::string floats_;
    std::map<std::size_t, std::string> buffer_;
};

}  // namespace

void patch_gltf(MeshSource& source) try {
    GltfParts parts;
    if (!take_apart(source, parts)) return;
    Json document = Json::parse(parts.json, nullptr, false);
    if (!document.is_object()) return;  // assimp says what is wrong
    const auto asset = document.find("asset");
    if (asset == document.end() || !asset->value("version", "").starts_with("2")) return;
    if (!GltfPatch(source, document, parts.rest).apply()) return;
    parts.json = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    put_together(std::move(parts), source);
} catch (const Json::exception& error) {
    std::string_view what = error.what();  // "[json.exception.type_error.302] type must be ..."
    if (const std::size_t at = what.find("] "); at != std::string_view::npos)
        what.remove_prefix(at + 2);
    fail(ExitCode::mesh, "not a readable .{} file ({})",
         source.format == MeshFormat::glb ? "glb" : "gltf", what);
}

}  // namespace swage
