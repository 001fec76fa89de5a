// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/files_beside.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_contents.h"
#include "geometry/picture_kind.h"

namespace swage {

namespace fs = std::filesystem;

std::string plain_name(const std::string& name, const char* otherwise) {
    std::string plain = name.empty() ? otherwise : name;
    for (char& c : plain)
        if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\' || c == '\x7f') c = '_';
    return plain;
}

FilesBeside::~FilesBeside() {
    std::error_code ignored;
    for (const fs::path& file : made_) fs::remove(file, ignored);
}

void FilesBeside::write(const fs::path& file, const std::string& bytes) {
    std::error_code ignored;
    const bool is_new = !fs::exists(file, ignored);
    write_file_whole(file, bytes);
    if (is_new) made_.push_back(file);
}

std::string FilesBeside::add(const fs::path& folder, const std::string& wanted,
                             const std::string& bytes) {
    std::string name = wanted;
    std::error_code ignored;
    // What cannot be read is somebody's too.
    for (int n = 2; fs::exists(fs::symlink_status(folder / name, ignored)); ++n) {
        if (file_contents(folder / name) == bytes) return name;
        name = fmt::format("{}_{}{}", fs::path(wanted).stem().string(), n,
                           fs::path(wanted).extension().string());
    }
    write(folder / name, bytes);
    return name;
}

std::vector<std::string> copy_textures(const fs::path& file,
                                       const std::vector<SurfaceMaterial>& material,
                                       FilesBeside& beside) {
    std::vector<std::string> names;
    for (const SurfaceMaterial& m : material) {
        std::string bytes, wanted;
        if (m.embedded_texture != nullptr) {
            bytes = *m.embedded_texture;
            const std::optional<PictureKind> kind = picture_kind(bytes);
            wanted = plain_name(m.name, "texture");
            wanted += kind ? kind->ending : ".img";
            std::replace(wanted.begin(), wanted.end(), '/', '_');
        } else if (!m.texture.empty()) {
            std::optional<std::string> image = file_contents(m.texture);
            if (!image)
                fail(ExitCode::output, "{}: the texture {} cannot be read", file.string(),
                     m.texture.string());
            bytes = std::move(*image);
            wanted = plain_name(m.texture.filename().string(), "texture");
            // Readers go by it.
            const std::optional<PictureKind> kind = picture_kind(bytes);
            if (kind && fs::path(wanted).extension().empty()) wanted += kind->ending;
        } else {
            names.emplace_back();
            continue;
        }
        names.push_back(beside.add(file.parent_path(), wanted, bytes));
    }
    return names;
}

}  // namespace swage
