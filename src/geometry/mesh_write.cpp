// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_write.h"

#include "base/error.h"

namespace swage {

void check_indices(const std::filesystem::path& file, const TriMesh& mesh) {
    const auto check = [&](const std::vector<Corners>& ids, std::size_t count, int least) {
        for (const Corners& c : ids)
            for (const int i : c)
                if (i < least || i >= static_cast<long long>(count))
                    fail(ExitCode::output, "{}: the mesh to write has invalid indices",
                         file.string());
        if (!ids.empty() && ids.size() != mesh.triangle.size())
            fail(ExitCode::output, "{}: the mesh to write has arrays of different lengths",
                 file.string());
    };
    check(mesh.triangle, mesh.position.size(), 0);
    check(mesh.triangle_uv, mesh.uv.size(), -1);
    check(mesh.triangle_smooth, static_cast<std::size_t>(mesh.smooth_group_count), 0);
}

}  // namespace swage
