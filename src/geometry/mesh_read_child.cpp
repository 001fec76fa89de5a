// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the reader and finds the images that materials name.
#include "geometry/mesh_read_child.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <new>

#include "base/error.h"
#include "base/file_contents.h"
#include "geometry/picture_kind.h"
#include "geometry/text_scan.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored);
}

// The named image, also when only its last part fits (a path of the author's machine) or the
// case differs (files of DOS days). Empty when there is none.
fs::path find_image(const fs::path& folder, std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    if (name.starts_with("file://")) name.erase(0, 7);
    if (name.empty() || name.find('\0') != std::string::npos) return {};
    for (const std::string& n : {name, url_decoded(name)})
        for (const fs::path& candidate : {folder / n, folder / fs::path(n).filename()})
            if (is_file(candidate)) return fs::weakly_canonical(candidate);
    const std::string wanted = lower(fs::path(name).filename().string());
    std::vector<fs::path> fit;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
        if (lower(entry.path().filename().string()) == wanted && is_file(entry.path()))
            fit.push_back(entry.path());
    return fit.empty() ? fs::path()
                       : fs::weakly_canonical(*std::min_element(fit.begin(), fit.end()));
}

// For a mesh with texture coordinates and no material at all: an image beside it that goes by
// its name, as in cow.obj and cow_texture.png.
fs::path guess_image(const fs::path& file) {
    const std::string stem = file.stem().string();
    std::vector<std::string> names = {stem};
    if (const std::size_t cut = stem.find_last_of("_-"); cut != std::string::npos && cut > 0)
        names.push_back(stem.substr(0, cut));
    for (std::size_t i = 0; i < names.size(); ++i)
        for (const char* ending : {"", "_texture", "_diffuse", "_albedo", "_basecolor", "_color"})
            for (const char* type : {".png", ".jpg", ".jpeg", ".tga", ".bmp"}) {
                if (i > 0 && *ending == '\0') continue;
                const fs::path image = file.parent_path() / (names[i] + ending + type);
                if (is_file(image)) return image;
            }
    return {};
}

}  // namespace

std::string url_decoded(const std::string& text) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    };
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 &&
            digit(text[i + 2]) >= 0) {
            out += static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2]));
            i += 2;
        } else {
            out += text[i];
        }
    }
    return out;
}

void tell_of_picture(const RawMaterial& material, MeshSource& source) {
    if (material.texture.empty() && material.texture_bytes.empty()) return;
    const std::optional<PictureKind> kind = material.texture.empty()
                                                ? picture_kind(material.texture_bytes)
                                                : picture_kind_of(material.texture);
    if (!kind || kind->is_read) return;
    const std::string name =
        material.texture.empty()
            ? ""
            : fmt::format(" '{}'", fs::path(material.texture).filename().string());
    source.tell_of_look(fmt::format(
        "material '{}': its image{} is of type {}; only PNG, JPEG, BMP and TGA are drawn",
        material.name, name, kind->name));
}

RawMesh read_raw(MeshSource& source) {
    RawMesh mesh = source.format == MeshFormat::obj   ? read_obj(source)
                   : source.format == MeshFormat::ply ? read_ply(source)
                   : source.format == MeshFormat::off ? read_off(source)
                                                      : read_by_assimp(source);
    if (!source.looks) mesh.color.clear();
    for (RawMaterial& material : mesh.material) {
        if (!source.looks) material.texture.clear(), material.texture_bytes.clear();
        if (material.texture.empty()) {
            tell_of_picture(material, source);
            continue;
        }
        const fs::path image = find_image(source.file.parent_path(), material.texture);
        if (image.empty())
            source.finding.push_back(fmt::format("material '{}': its image '{}' is missing",
                                                 material.name, material.texture));
        material.texture = image.string();
        tell_of_picture(material, source);
        // Exporters that leave the colour black beside an image do not mean it.
        if (!image.empty() && material.color.isZero()) material.color = Vec3::Ones();
    }
    if (source.looks && mesh.material.empty() && !mesh.triangle_uv.empty()) {
        const fs::path image = guess_image(source.file);
        if (!image.empty()) {
            mesh.material.push_back({.name = "material", .color = Vec3::Ones()});
            mesh.material[0].texture = image.string();
            mesh.triangle_material.assign(mesh.triangle.size(), 0);
            source.finding.push_back(
                fmt::format("it names no material; the image beside it, {}, is used as its texture",
                            image.filename().string()));
        }
    }
    mesh.finding.insert(mesh.finding.begin(), source.finding.begin(), source.finding.end());
    return mesh;
}

void check_placed(const std::vector<PlacedPart>& parts, const std::vector<std::size_t>& roots,
                  std::uint64_t memory_bytes) {
    std::vector<double> bytes(parts.size(), 0.0);  // of a part and all that it is made of
    std::vector<char> is_known(parts.size(), 0);
    double all = 0;
    for (const std::size_t root : roots) {
        if (root >= parts.size()) continue;
        // No recursion: a file may nest its parts as deep as it likes.
        std::vector<std::pair<std::size_t, std::size_t>> open;  // a part, its next child
        const auto enter = [&](std::size_t part) {
            if (part >= parts.size() || is_known[part]) return;
            is_known[part] = 1;
            open.emplace_back(part, 0);
        };
        enter(root);
        while (!open.empty()) {
            const std::size_t part = open.back().first, next = open.back().second++;
            const std::vector<std::size_t>& child = parts[part].child;
            if (next < child.size()) {
                enter(child[next]);
                continue;
            }
            bytes[part] = parts[part].bytes;
            for (const std::size_t c : child)
                if (c < parts.size()) bytes[part] += bytes[c];
            open.pop_back();
        }
        all += bytes[root];
    }
    if (all > static_cast<double>(memory_bytes)) throw std::bad_alloc();
}

std::string unlike_sentence(Unlike how, std::size_t count, const std::string& name,
                            const std::string& by) {
    struct Words {
        const char *one, *many, *drawn;
    };
    const Words words = how == Unlike::clear ? Words{"transmits light", "transmit light", "opaque"}
                        : how == Unlike::bright
                            ? Words{"emits light", "emit light", "without that light"}
                            : Words{"does not repeat its image beyond the borders",
                                    "do not repeat their images beyond the borders", "repeated"};
    const std::string shown = name.substr(0, 40);
    return count == 1 ? fmt::format("the material '{}' {} ({}): drawn {}", shown, words.one, by,
                                    words.drawn)
                      : fmt::format("{} materials, such as '{}', {} ({}): drawn {}", count, shown,
                                    words.many, by, words.drawn);
}

}  // namespace swage
