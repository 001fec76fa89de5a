// SPDX-License-Identifier: GPL-3.0-or-later
// PLY (G. Turk, "The PLY polygon file format", 1994), with triangle strips. Not read through
// assimp 5.2, which makes one triangle of a file of strips, never returns from a file without
// "end_header", and hands on indices out of range.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "base/error.h"
#include "base/srgb.h"
#include "base/text.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

enum class Number { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr int kNumberBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
    std::string name;
    Number type;
    bool is_list = false;
    Number count_type = Number::uint8;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> property;

    int find(std::initializer_list<const char*> names) const {
        for (const char* name : names)
            for (std::size_t i = 0; i < property.size(); ++i)
                if (property[i].name == name) return static_cast<int>(i);
        return -1;
    }
};

Number number_type(std::string_view word) {
    static const std::pair<const char*, Number> kNames[] = {
        {"char", Number::int8},      {"int8", Number::int8},       {"uchar", Number::uint8},
        {"uint8", Number::uint8},    {"short", Number::int16},     {"int16", Number::int16},
        {"ushort", Number::uint16},  {"uint16", Number::uint16},   {"int", Number::int32},
        {"int32", Number::int32},    {"uint", Number::uint32},     {"uint32", Number::uint32},
        {"float", Number::float32},  {"float32", Number::float32}, {"double", Number::float64},
        {"float64", Number::float64}};
    for (const auto& [name, type] : kNames)
        if (word == name) return type;
    fail(ExitCode::mesh, "the header has a number type '{}' that PLY does not define",
         word.substr(0, 40));
}

class PlyReader {
  public:
    explicit PlyReader(MeshSource& source) : source_(source), rest_(source.bytes) {}

    RawMesh read() {
        read_header();
        for (const Element& element : element_) {
            const std::uint64_t least = least_bytes(element);
            if (least > 0 && element.count > rest_.size() / least + 1)
                fail(ExitCode::mesh,
                     "the header gives {} of '{}', but the file is too short for them",
                     element.count, element.name);
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else if (element.name == "tristrips") {
                read_strips(element);
            } else {
                each(element, [](auto&&...) {});
                if (element.count > 0)
                    source_.finding.emplace_back(
                        fmt::format("{} of '{}' were left out", element.count, element.name));
            }
        }
        tell_rest();
        if (polygons_.size() == 0)
            fail(ExitCode::mesh, "{} vertices and no faces", mesh_.position.size());
        add_materials();
        mesh_.at_vertices = 1;
        add_polygons(polygons_, mesh_);
        return std::move(mesh_);
    }

  private:
    // What the header does not count; blanks at the end are nothing.
    void tell_rest() {
        if (rest_.find_first_not_of(" \t\r\v\f\n") == std::string_view::npos) return;
        std::size_t lines = 0;
        for (std::string_view line; ascii_ && next_line(rest_, line);)
            lines += !trimmed(line).empty();
        source_.finding.push_back(
            (ascii_ ? counted(lines, "line", "lines") : counted(rest_.size(), "byte", "bytes")) +
            " beyond the count in its header left out");
    }

    void read_header() {
        std::string_view line;
        const auto take = [&] {
            if (!next_line(rest_, line) || line.size() > 4096)
                fail(ExitCode::mesh, "the header has no end ('end_header' is missing)");
            line = trimmed(line);
        };
        take();
        if (line != "ply") fail(ExitCode::mesh, "not a PLY file (it does not begin with 'ply')");
        bool has_format = false;
        for (take(); line != "end_header"; take()) {
            std::string_view words = line;
            const std::string_view key = next_word(words);
            if (key == "format") {
                const std::string_view format = next_word(words);
                has_format = true;
                ascii_ = format == "ascii";
                swap_ =
                    format == (std::endian::native == std::endian::little ? "binary_big_endian"
                                                                          : "binary_little_endian");
                if (!ascii_ && !format.starts_with("binary_"))
                    fail(ExitCode::mesh, "PLY format '{}' is not known", format.substr(0, 40));
            } else if (key == "element") {
                Element element;
                element.name = next_word(words);
                long long count = -1;
                if (!to_integer(next_word(words), count) || count < 0 || count > 0x7fffffff)
                    fail(ExitCode::mesh, "the header's line '{}' has no valid count",
                         line.substr(0, 80));
                element.count = static_cast<std::uint64_t>(count);
                element_.push_back(std::move(element));
            } else if (key == "property") {
                if (element_.empty())
                    fail(ExitCode::mesh, "the header has a property before any element");
                Property property;
                std::string_view type = next_word(words);
                if (type == "list") {
                    property.is_list = true;
                    property.count_type = number_type(next_word(words));
                    type = next_word(words);
                }
                property.type = number_type(type);
                property.name = next_word(words);
                element_.back().property.push_back(std::move(property));
            } else if (key == "comment" && next_word(words) == "TextureFile") {
                texture_.emplace_back(trimmed(words));
            }
        }
        if (!has_format) fail(ExitCode::mesh, "the header names no format");
    }

    std::uint64_t least_bytes(const Element& element) const {
        std::uint64_t bytes = 0;
        for (const Property& p : element.property)
            bytes += ascii_ ? 2 : kNumberBytes[static_cast<int>(p.is_list ? p.count_type : p.type)];
        return bytes;
    }

    template <typename T>
    double take() {
        char raw[sizeof(T)];
        std::memcpy(raw, rest_.data(), sizeof(T));
        if (swap_) std::reverse(raw, raw + sizeof(T));
        T value;
        std::memcpy(&value, raw, sizeof(T));
        rest_.remove_prefix(sizeof(T));
        return static_cast<double>(value);
    }

    double take(Number type, const Element& element, std::uint64_t item) {
        if (ascii_) {
            std::size_t begin = 0;
            while (begin < rest_.size() && (is_blank(rest_[begin]) || rest_[begin] == '\n'))
                ++begin;
            rest_.remove_prefix(begin);
            std::size_t end = 0;
            while (end < rest_.size() && !is_blank(rest_[end]) && rest_[end] != '\n') ++end;
            const std::string_view word = rest_.substr(0, end);
            double value = 0;
            if (word.empty()) ends_early(element, item);
            if (!to_number(word, value))
                fail(ExitCode::mesh, "{} {}: '{}' is not a number", element.name, item,
                     word.substr(0, 40));
            rest_.remove_prefix(end);
            return value;
        }
        if (rest_.size() < static_cast<std::size_t>(kNumberBytes[static_cast<int>(type)]))
            ends_early(element, item);
        switch (type) {
            case Number::int8:
                return take<std::int8_t>();
            case Number::uint8:
                return take<std::uint8_t>();
            case Number::int16:
                return take<std::int16_t>();
            case Number::uint16:
                return take<std::uint16_t>();
            case Number::int32:
                return take<std::int32_t>();
            case Number::uint32:
                return take<std::uint32_t>();
            case Number::float32:
                return take<float>();
            case Number::float64:
                return take<double>();
        }
        return 0;
    }

    [[noreturn]] static void ends_early(const Element& element, std::uint64_t item) {
        fail(ExitCode::mesh, "the file ends early, in '{}' {} of {}", element.name, item,
             element.count);
    }

    // Text may give a number with a fraction where only a whole one means something.
    static void check_whole(const Element& element, std::uint64_t item, double value) {
        if (std::isfinite(value) && value != std::floor(value))
            fail(ExitCode::mesh, "{} {}: {} is not a whole number", element.name, item, value);
    }

    // Calls f(item, scalars, lists) for each item; scalars and lists by property.
    template <typename F>
    void each(const Element& element, const F& f) {
        std::vector<double> scalar(element.property.size());
        std::vector<std::vector<double>> list(element.property.size());
        for (std::uint64_t item = 0; item < element.count; ++item) {
            for (std::size_t p = 0; p < element.property.size(); ++p) {
                const Property& property = element.property[p];
                if (!property.is_list) {
                    scalar[p] = take(property.type, element, item);
                    continue;
                }
                const double count = take(property.count_type, element, item);
                const std::size_t least =
                    ascii_ ? 2 : kNumberBytes[static_cast<int>(property.type)];
                check_whole(element, item, count);
                if (!(count >= 0) || count > static_cast<double>(rest_.size() / least + 1))
                    fail(ExitCode::mesh, "{} {}: a list of {} entries does not fit in the file",
                         element.name, item, count);
                list[p].resize(static_cast<std::size_t>(count));
                for (double& entry : list[p]) entry = take(property.type, element, item);
            }
            f(item, scalar, list);
        }
    }

    void read_vertices(const Element& element) {
        const int x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
        if (x < 0 || y < 0 || z < 0) fail(ExitCode::mesh, "the vertices have no x, y, z");
        const int nx = element.find({"nx"}), ny = element.find({"ny"}), nz = element.find({"nz"});
        const int u = element.find({"s", "u", "texture_u", "texture_s"});
        const int v = element.find({"t", "v", "texture_v", "texture_t"});
        const int red = element.find({"red", "r", "diffuse_red"});
        const int green = element.find({"green", "g", "diffuse_green"});
        const int blue = element.find({"blue", "b", "diffuse_blue"});
        const bool has_normal = nx >= 0 && ny >= 0 && nz >= 0;
        const bool has_uv = u >= 0 && v >= 0;
        const bool has_color = red >= 0 && green >= 0 && blue >= 0;
        each(element, [&](std::uint64_t, const auto& value, const auto&) {
            mesh_.position.emplace_back(value[x], value[y], value[z]);
            if (has_normal) mesh_.normal.emplace_back(value[nx], value[ny], value[nz]);
            if (has_uv) mesh_.uv.emplace_back(value[u], value[v]);
            if (has_color) {
                Eigen::Vector3f color;
                const int channel[3] = {red, green, blue};
                for (int k = 0; k < 3; ++k) color[k] = color_of(element, channel[k], value);
                mesh_.color.push_back(color);
            }
        });
        if (has_color) settle_fractions(element, {red, green, blue});
        has_vertex_uv_ = has_uv;
    }

    static bool is_fraction(Number type) {
        return type == Number::float32 || type == Number::float64;
    }

    // Where all channels are: to 1 they are light, to 255 for display.
    void settle_fractions(const Element& element, const std::array<int, 3>& channel) {
        const auto is_one = [&](int c) { return is_fraction(element.property[c].type); };
        if (std::ranges::none_of(channel, is_one)) return;
        float brightest = 0;
        for (const auto& color : mesh_.color) brightest = std::max(brightest, color.maxCoeff());
        const double most = std::ranges::all_of(channel, is_one) ? counted_to(brightest) : 1;
        for (auto& color : mesh_.color) {
            for (float& c : color) {
                c = std::clamp(c / static_cast<float>(most), 0.0f, 1.0f);
                if (most > 1) c = static_cast<float>(linear_from_srgb(double(c)));
            }
        }
    }

    // Whole numbers are for display (sRGB), fractions are linear light. What is wider than a colour
    // needs holds a byte all the same: so do those who write `int`.
    static float color_of(const Element& element, int channel, const std::vector<double>& value) {
        const double c = value[channel];
        switch (element.property[channel].type) {
            case Number::float32:
            case Number::float64:
                return static_cast<float>(c);  // settle_fractions()
            case Number::uint16:
                return static_cast<float>(linear_from_srgb(std::clamp(c / 65535, 0.0, 1.0)));
            default:
                return static_cast<float>(linear_from_srgb(std::clamp(c / 255, 0.0, 1.0)));
        }
    }

    int vertex_index(const Element& element, std::uint64_t item, double value) const {
        check_whole(element, item, value);
        if (!(value >= 0 && value < static_cast<double>(mesh_.position.size())))
            fail(ExitCode::mesh, "{} {}: vertex {} of {} does not exist", element.name, item, value,
                 mesh_.position.size());
        return static_cast<int>(value);
    }

    void add_corner(int vertex, int corner_uv) {
        const int uv = corner_uv >= 0 ? corner_uv : has_vertex_uv_ ? vertex : -1;
        polygons_.add_corner(vertex, uv, mesh_.normal.empty() ? -1 : vertex);
    }

    void read_faces(const Element& element) {
        const int indices = element.find({"vertex_indices", "vertex_index"});
        if (indices < 0 || !element.property[indices].is_list)
            fail(ExitCode::mesh, "the faces have no list 'vertex_indices'");
        const int uv = element.find({"texcoord"}), texture = element.find({"texnumber"});
        if (texture_.size() > 1 && texture < 0)
            source_.finding.emplace_back(fmt::format(
                "{} textures are named, but no face says which it uses: the first was taken",
                texture_.size()));
        if (element.find({"red", "r", "diffuse_red"}) >= 0)
            source_.finding.emplace_back(
                "colours of faces were left out (those of vertices are read)");
        // Where some faces have coordinates, one without has no place in an image.
        const bool some_have_uv = uv >= 0 || has_vertex_uv_;
        each(element, [&](std::uint64_t item, const auto& value, const auto& list) {
            const auto& corner = list[indices];
            const bool has_uv = uv >= 0 && list[uv].size() == 2 * corner.size();
            for (std::size_t k = 0; k < corner.size(); ++k) {
                int corner_uv = -1;
                if (has_uv) {
                    corner_uv = static_cast<int>(mesh_.uv.size());
                    mesh_.uv.emplace_back(list[uv][2 * k], list[uv][2 * k + 1]);
                }
                add_corner(vertex_index(element, item, corner[k]), corner_uv);
            }
            const double number = texture >= 0 ? value[texture] : 0;
            check_whole(element, item, number);
            const bool has_texture = number >= 0 && number < static_cast<double>(texture_.size()) &&
                                     (has_uv || has_vertex_uv_ || !some_have_uv);
            polygons_.end_polygon(has_texture ? static_cast<int>(number) : -1, -1, 0);
        });
    }

    // A strip turns the other way with every triangle; -1 starts a new one.
    void read_strips(const Element& element) {
        const int indices = element.find({"vertex_indices", "vertex_index"});
        if (indices < 0 || !element.property[indices].is_list)
            fail(ExitCode::mesh, "the triangle strips have no list 'vertex_indices'");
        each(element, [&](std::uint64_t item, const auto&, const auto& list) {
            int a = -1, b = -1;
            bool odd = false;
            for (const double entry : list[indices]) {
                if (entry == -1) {
                    a = b = -1;
                    odd = false;
                    continue;
                }
                const int c = vertex_index(element, item, entry);
                if (a >= 0) {
                    if (a != b && b != c && c != a) {  // a repeated vertex only turns the strip
                        add_corner(odd ? b : a, -1);
                        add_corner(odd ? a : b, -1);
                        add_corner(c, -1);
                        polygons_.end_polygon(texture_.empty() ? -1 : 0, -1, 0);
                    }
                    odd = !odd;
                }
                a = b;
                b = c;
            }
        });
    }

    // One for each texture, and one for the faces without.
    void add_materials() {
        if (texture_.empty()) return;
        for (std::size_t n = 0; n < texture_.size(); ++n) {
            RawMaterial material{.name = "material", .color = Vec3::Ones()};
            if (texture_.size() > 1) material.name += fmt::format("_{}", n + 1);
            material.texture = (source_.file.parent_path() / texture_[n]).string();
            mesh_.material.push_back(std::move(material));
        }
        const int plain = static_cast<int>(texture_.size());
        if (std::count(polygons_.material.begin(), polygons_.material.end(), -1) == 0) return;
        mesh_.material.push_back({.name = "plain"});
        std::replace(polygons_.material.begin(), polygons_.material.end(), -1, plain);
    }

    MeshSource& source_;
    std::string_view rest_;
    bool ascii_ = false, swap_ = false, has_vertex_uv_ = false;
    std::vector<Element> element_;
    std::vector<std::string> texture_;
    RawMesh mesh_;
    PolygonList polygons_;
};

}  // namespace

RawMesh read_ply(MeshSource& source) { return PlyReader(source).read(); }

}  // namespace swage
