// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/export_scene.h"

#include "base/error.h"
#include "base/file_contents.h"

namespace swage {

void refuse_foreign(const std::filesystem::path& file,
                    const std::function<bool(std::string_view)>& is_ours) {
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown)) return;
    std::string why, begin(64, '\0');
    const FileHandle handle = open_plain_file(file, why);
    if (!handle.is_open()) fail(ExitCode::output, "{}: {}", file.string(), why);
    begin.resize(read_up_to(handle.id(), begin.data(), begin.size()).value_or(0));
    if (!is_ours(begin)) {
        fail(ExitCode::foreign, "{}: was not written by swage export; choose another --out",
             file.string());
    }
}

}  // namespace swage
