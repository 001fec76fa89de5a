// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ and MTL, after the format's appendix to the Advanced Visualizer manual. Not read
// through assimp, which splits vertices, forgets their order, rounds them to single precision,
// takes "1,0" for 1, and refuses a byte order mark or a face of two corners.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/srgb.h"
#include "base/text.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void bad_line(int line, const std::string& what) {
    fail(ExitCode::mesh, "line {}: {}", line, what);
}

// Whether the next line belongs to this one; a comment ends with its own.
bool goes_on(std::string_view line) {
    if (!line.ends_with('\\')) return false;
    for (std::string_view word; !(word = next_word(line)).empty();)
        if (word.front() == '#') return false;
    return true;
}

class ObjReader {
  public:
    explicit ObjReader(MeshSource& source) : source_(source) {}

    RawMesh read() {
        std::string_view text = source_.bytes;
        if (const std::size_t at = text.find('\0'); at != std::string_view::npos)
            fail(ExitCode::mesh,
                 "byte {} is zero, so this is not text: not an OBJ file, or damaged", at);
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        std::string_view line;
        std::string joined;
        while (next_line(text, line)) {
            ++line_;
            std::string_view whole = trimmed(line);
            if (goes_on(whole)) {
                joined.assign(whole.substr(0, whole.size() - 1));
                while (next_line(text, line)) {
                    ++line_;
                    whole = trimmed(line);
                    const bool more = goes_on(whole);
                    joined += ' ';
                    joined += more ? whole.substr(0, whole.size() - 1) : whole;
                    if (!more) break;
                }
                whole = joined;
            }
            if (!whole.empty() && whole.front() != '#') read_statement(whole);
        }
        return finish();
    }

  private:
    double number(std::string_view word) {
        double value = 0;
        if (!to_number(word, value)) {
            const bool comma = word.find(',') != std::string_view::npos;
            bad_line(line_, fmt::format("'{}' is not a number{}", word.substr(0, 40),
                                        comma ? " (write decimals with a point)" : ""));
        }
        if (!std::isfinite(value)) bad_line(line_, fmt::format("'{}' is not finite", word));
        return value;
    }

    // As many numbers as the line has, at most 8.
    int numbers(std::string_view line, double* value) {
        int count = 0;
        for (std::string_view word; count < 8 && !(word = next_word(line)).empty();) {
            if (word.front() == '#') break;
            value[count++] = number(word);
        }
        return count;
    }

    void read_statement(std::string_view line) {
        const std::string_view key = next_word(line);
        double value[8];
        if (key == "v") {
            const int count = numbers(line, value);
            if (count < 3) bad_line(line_, "a vertex needs three coordinates");
            mesh_.position.emplace_back(value[0], value[1], value[2]);
            if (count >= 6) {  // x y z r g b, the common extension
                color_.emplace_back(mesh_.position.size() - 1, Vec3(value[3], value[4], value[5]));
            }
        } else if (key == "vt") {
            const int count = numbers(line, value);
            if (count < 1) bad_line(line_, "a texture coordinate needs numbers");
            mesh_.uv.emplace_back(value[0], count > 1 ? value[1] : 0.0);
        } else if (key == "vn") {
            if (numbers(line, value) < 3) bad_line(line_, "a normal needs three coordinates");
            mesh_.normal.emplace_back(value[0], value[1], value[2]);
        } else if (key == "f") {
            read_face(line);
        } else if (key == "s") {
            says_smooth_ = true;
            smooth_ = smoothing_group(trimmed(line));
        } else if (key == "usemtl") {
            material_ = id_of(std::string(trimmed(line)), material_id_, material_name_);
        } else if (key == "mtllib") {
            library_.emplace_back(trimmed(line));
        } else if (key == "o" || (key == "g" && !has_objects_)) {
            has_objects_ = has_objects_ || key == "o";
            const std::string_view name = trimmed(line);
            part_ = id_of(name.empty() ? "default" : std::string(name), part_id_, mesh_.part_name);
        } else if (key == "l" || key == "p") {
            ++lines_and_points_;
        } else if (key == "curv" || key == "surf" || key == "curv2") {
            ++free_forms_;
        }
    }

    int smoothing_group(std::string_view name) {
        name = name.substr(0, name.find('#'));
        const std::string_view word = next_word(name);
        if (word.empty() || word == "off" || word == "0") return 0;
        return smooth_id_.emplace(word, static_cast<int>(smooth_id_.size()) + 1).first->second;
    }

    static int id_of(const std::string& name, std::map<std::string, int>& ids,
                     std::vector<std::string>& names) {
        const auto [at, is_new] = ids.emplace(name, static_cast<int>(names.size()));
        if (is_new) names.push_back(name);
        return at->second;
    }

    // Counts from 1, or backwards from -1. Ranges are checked when all is read.
    int index(std::string_view word, std::size_t count) {
        long long value = 0;
        constexpr long long kMost = 0x7fffffff;
        if (!to_integer(word, value) || value == 0 || value > kMost || value < -kMost)
            bad_line(line_, fmt::format("'{}' is not an index", word.substr(0, 40)));
        if (value > 0) return static_cast<int>(value - 1);
        value += static_cast<long long>(count);
        if (value < 0)
            bad_line(line_, fmt::format("index {} reaches before the first entry", word));
        return static_cast<int>(value);
    }

    void read_face(std::string_view line) {
        for (std::string_view word; !(word = next_word(line)).empty();) {
            if (word.front() == '#') break;
            int id[3] = {-1, -1, -1};
            const std::size_t count[3] = {mesh_.position.size(), mesh_.uv.size(),
                                          mesh_.normal.size()};
            for (int k = 0; k < 3; ++k) {
                const std::size_t slash = word.find('/');
                const std::string_view field = word.substr(0, slash);
                if (k == 0 || !field.empty()) id[k] = index(field, count[k]);
                if (slash == std::string_view::npos) break;
                if (k == 2) bad_line(line_, "a corner has more than three indices");
                word.remove_prefix(slash + 1);
            }
            polygons_.add_corner(id[0], id[1], id[2]);
        }
        polygons_.end_polygon(material_, part_, line_);
        polygons_.smooth.push_back(smooth_);
    }

    RawMesh finish() {
        if (polygons_.size() == 0) {
            fail(ExitCode::mesh,
                 "no faces ({} vertices, {} lines and points, {} free-form surfaces)",
                 mesh_.position.size(), lines_and_points_, free_forms_);
        }
        if (!color_.empty()) mesh_.color.resize(mesh_.position.size(), Eigen::Vector3f::Ones());
        double brightest = 0;
        for (const auto& [vertex, color] : color_)
            brightest = std::max(brightest, color.maxCoeff());
        const double most = counted_to(brightest);
        for (const auto& [vertex, color] : color_) {
            for (int k = 0; k < 3; ++k)
                mesh_.color[vertex][k] =
                    static_cast<float>(linear_from_srgb(std::clamp(color[k] / most, 0.0, 1.0)));
        }
        if (lines_and_points_ > 0)
            source_.finding.push_back(
                fmt::format("{} lines and points were left out", lines_and_points_));
        if (free_forms_ > 0)
            source_.finding.push_back(
                fmt::format("{} free-form curves and surfaces were left out", free_forms_));

        const std::size_t asked = material_name_.size();
        // Faces before the first usemtl, o or g belong to a default.
        const auto give_default = [](std::vector<int>& id, int fallback) {
            std::replace(id.begin(), id.end(), -1, fallback);
        };
        const auto missing = [](const std::vector<int>& id) {
            return std::find(id.begin(), id.end(), -1) != id.end();
        };
        if (!material_name_.empty() && missing(polygons_.material))
            give_default(polygons_.material, id_of("default", material_id_, material_name_));
        if (!mesh_.part_name.empty() && missing(polygons_.part))
            give_default(polygons_.part, id_of("default", part_id_, mesh_.part_name));
        for (const std::string& name : material_name_) mesh_.material.push_back({.name = name});
        bool all_read = true;
        for (const std::string& library : library_) all_read &= read_library(library);
        if (all_read) tell_undefined(asked);
        tell_unlike(Unlike::clear, clear_, "d, Tr");
        const bool repeats = std::any_of(mesh_.uv.begin(), mesh_.uv.end(), [](const Vec2& uv) {
            return uv.minCoeff() < 0 || uv.maxCoeff() > 1;
        });
        if (repeats) tell_unlike(Unlike::clamped, clamped_, "-clamp on");
        if (!says_smooth_) polygons_.smooth.clear();
        add_polygons(polygons_, mesh_);
        place_images();
        return std::move(mesh_);
    }

    // Which of the first `asked` materials no library has.
    void tell_undefined(std::size_t asked) {
        std::string names;
        std::size_t count = 0;
        for (std::size_t n = 0; n < asked; ++n) {
            const std::string& name = material_name_[n];
            if (defined_.contains(name)) continue;
            if (++count <= 5) names += (count == 1 ? "'" : ", '") + name.substr(0, 40) + "'";
        }
        if (count == 0) return;
        if (count > 5) names += fmt::format(" and {} more", count - 5);
        source_.tell_of_look(fmt::format("no material file defines {} {}: left grey",
                                         count == 1 ? "the material" : "the materials", names));
    }

    void tell_unlike(Unlike how, const std::set<int>& materials, const char* by) {
        if (materials.empty()) return;
        source_.tell_of_look(
            unlike_sentence(how, materials.size(), material_name_[*materials.begin()], by));
    }

    // A library name may hold blanks, or be several names. False when it cannot be read.
    bool read_library(const std::string& names) {
        const fs::path folder = source_.file.parent_path();
        const auto try_name = [&](std::string name) {
            std::replace(name.begin(), name.end(), '\\', '/');
            const fs::path file = folder / name;
            const auto text = file_contents(file, source_.file_bytes);
            if (text) read_materials(*text, file.parent_path());
            return text.has_value();
        };
        if (try_name(names)) return true;
        std::string_view rest = names;
        int found = 0;
        for (std::string_view word; !(word = next_word(rest)).empty();)
            found += word != names && try_name(std::string(word));
        if (found == 0)
            source_.tell_of_look(fmt::format("the material file '{}' cannot be read", names));
        return found > 0;
    }

    // Where on its image a material's texture coordinates are.
    struct OnImage {
        Vec2 scale = Vec2::Ones(), shift = Vec2::Zero();
        bool clamps = false;
    };

    // Image name after its options, "-s 1 1 1" and the like, of which scale and shift count.
    static std::string_view map_name(std::string_view line, OnImage& on_image) {
        for (std::string_view rest = line; !trimmed(rest).empty();) {
            const std::string_view option = next_word(rest);
            if (option.front() != '-' || option.size() < 2) break;
            const bool vector = option == "-s" || option == "-o" || option == "-t";
            const int arguments = option == "-mm" ? 2 : vector ? 3 : 1;
            for (int n = 0; n < arguments; ++n) {
                std::string_view peek = rest;
                const std::string_view word = next_word(peek);
                double value = 0;
                on_image.clamps = on_image.clamps || (option == "-clamp" && word == "on");
                if (vector && !to_number(word, value)) break;  // of three, the last may be left out
                if (n < 2 && std::isfinite(value) && option == "-s") on_image.scale[n] = value;
                if (n < 2 && std::isfinite(value) && option == "-o") on_image.shift[n] = value;
                rest = peek;
            }
            line = rest;
        }
        return trimmed(line);
    }

    // Texture coordinates of materials whose images are scaled or shifted become others.
    void place_images() {
        if (on_image_.empty() || mesh_.triangle_uv.empty()) return;
        std::map<std::pair<int, int>, int> placed;  // material and old coordinates: the new ones
        for (std::size_t t = 0; t < mesh_.triangle_uv.size(); ++t) {
            const int material = mesh_.triangle_material[t];
            const auto at = on_image_.find(material);
            if (at == on_image_.end()) continue;
            for (int& i : mesh_.triangle_uv[t]) {
                if (i < 0) continue;
                const auto [entry, is_new] =
                    placed.emplace(std::pair{material, i}, static_cast<int>(mesh_.uv.size()));
                if (is_new)
                    mesh_.uv.push_back(mesh_.uv[i].cwiseProduct(at->second.scale) +
                                       at->second.shift);
                i = entry->second;
            }
        }
    }

    // "of the materials' images only map_Kd is used, not norm, map_Ks", each of those once.
    void tell_unused(const char* used, std::vector<std::string> keys) {
        if (keys.empty()) return;
        std::sort(keys.begin(), keys.end());
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        source_.tell_of_look(
            fmt::format("of the materials' {} used, not {}", used, joined(keys, ", ")));
    }

    void read_materials(const std::string& bytes, const fs::path& folder) {
        std::string_view text = bytes, line;
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        RawMaterial unused, *material = &unused;
        int number = -1;
        std::vector<std::string> other_maps, other_values;
        while (next_line(text, line)) {
            std::string_view rest = trimmed(line);
            const std::string_view key = next_word(rest);
            const auto scalar = [&](double fallback) {
                double value = fallback;
                std::string_view words = rest;
                return to_number(next_word(words), value) && std::isfinite(value) ? value
                                                                                  : fallback;
            };
            if (key == "newmtl") {
                defined_.emplace(trimmed(rest));
                const auto at = material_id_.find(std::string(trimmed(rest)));
                number = at == material_id_.end() ? -1 : at->second;
                material = number < 0 ? &unused : &mesh_.material[number];
            } else if (key == "Kd") {
                Vec3 color;
                int count = 0;
                while (count < 3 && to_number(next_word(rest), color[count]) &&
                       std::isfinite(color[count]))
                    ++count;
                if (count == 1) color = Vec3::Constant(color[0]);
                if (count == 1 || count == 3) material->color = color.cwiseMax(0.0).cwiseMin(1.0);
            } else if (key == "Ns") {  // Blinn exponent
                material->roughness = std::sqrt(2 / (2 + std::clamp(scalar(4.6), 0.0, 1e6)));
            } else if (key == "Pr") {
                material->roughness = std::clamp(scalar(material->roughness), 0.0, 1.0);
            } else if (key == "Pm") {
                material->metallic = std::clamp(scalar(material->metallic), 0.0, 1.0);
            } else if (key == "map_Kd") {
                OnImage on_image;
                std::string name(map_name(rest, on_image));
                on_image_.erase(number);
                if (number >= 0 && on_image.clamps) clamped_.insert(number);
                if (number >= 0 &&
                    (on_image.scale != Vec2::Ones() || on_image.shift != Vec2::Zero()))
                    on_image_[number] = on_image;
                std::replace(name.begin(), name.end(), '\\', '/');
                material->texture = (folder / name).string();
            } else if (key == "d" || key == "Tr") {
                const double value = scalar(key == "d" ? 1 : 0);
                if (number >= 0 && (key == "d" ? value < 1 : value > 0)) clear_.insert(number);
            } else if (key == "Ks" || key == "Ke") {
                // Grey gloss is what Ns makes of any material; exporters write some of it always.
                double low = 1e9, high = 0;
                for (double value = 0; to_number(next_word(rest), value);)
                    low = std::min(low, value), high = std::max(high, value);
                const bool has_effect = key == "Ks" ? high > low : high > 0;
                if (has_effect && material != &unused) other_values.emplace_back(key);
            } else if (key.starts_with("map_") || key == "bump" || key == "norm") {
                if (material != &unused) other_maps.emplace_back(key);
            }
        }
        tell_unused("images only map_Kd is", std::move(other_maps));
        tell_unused("values only Kd, Ns, Pr and Pm are", std::move(other_values));
    }

    MeshSource& source_;
    RawMesh mesh_;
    std::vector<std::pair<std::size_t, Vec3>> color_;  // of a vertex, as the file has it
    PolygonList polygons_;
    int line_ = 0, material_ = -1, part_ = -1;
    bool has_objects_ = false;
    // Of the faces to come (`s`): the group in which they are smooth; 0: none, as it begins.
    bool says_smooth_ = false;
    int smooth_ = 0;
    int lines_and_points_ = 0, free_forms_ = 0;
    std::map<std::string, int> material_id_, part_id_, smooth_id_;
    std::vector<std::string> material_name_, library_;
    std::set<std::string> defined_;    // materials of the libraries
    std::map<int, OnImage> on_image_;  // of the materials that are scaled or shifted
    std::set<int> clear_;              // materials of an opacity below 1
    std::set<int> clamped_;            // whose images end at their borders
};

}  // namespace

RawMesh read_obj(MeshSource& source) { return ObjReader(source).read(); }

}  // namespace swage
