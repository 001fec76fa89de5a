// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/mesh_cache.h"

#include <algorithm>
#include <cstddef>

#include "base/error.h"
#include "base/hash.h"
#include "geometry/edges.h"
#include "geometry/mesh_check.h"

namespace swage {

namespace {

struct MovingVertex {
    float position[3];
    float normal[3];
};
struct FixedVertex {
    float uv[2];
    float color[3];
};

template <typename T>
void add_array(Hasher& hasher, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    hasher.add_bytes(&count, sizeof count);
    hasher.add_bytes(values.data(), count * sizeof(T));
}

std::uint64_t content_of(const TriMesh& mesh, bool with_position) {
    Hasher hasher;
    const std::uint64_t count = mesh.position.size();
    hasher.add_bytes(&count, sizeof count);
    if (with_position || !mesh.smooth_normal.empty()) add_array(hasher, mesh.position);
    add_array(hasher, mesh.triangle);
    add_array(hasher, mesh.position_color);
    add_array(hasher, mesh.uv);
    add_array(hasher, mesh.triangle_uv);
    add_array(hasher, mesh.triangle_smooth);
    add_array(hasher, mesh.smooth_normal);
    add_array(hasher, mesh.triangle_material);
    return hasher.value();
}

void attribute(const Gl& gl, GLuint place, GLint size, std::size_t stride, std::size_t offset) {
    gl.EnableVertexAttribArray(place);
    gl.VertexAttribPointer(place, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                           reinterpret_cast<const void*>(offset));
}

// Of a body inside out the far side would show, whatever stands beside it.
bool holds_volume(const TriMesh& mesh) {
    if (mesh.triangle.empty() || !is_closed(mesh)) return false;
    const std::vector<double> volume = component_volumes(mesh, surface_components(mesh));
    const auto [least, most] = std::minmax_element(volume.begin(), volume.end());
    return *most > 0 && *least > -1e-9 * *most;  // two sheets back to back hold nothing
}

}  // namespace

void GpuMesh::draw(const Gl& gl, const DrawMesh::Range& range) const {
    gl.BindVertexArray(vertex_array.id());
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(sizeof(std::uint32_t) * range.first));
}

void MeshCache::begin_picture() {
    ++picture_;
    seen_.clear();
    std::erase_if(mesh_, [&](const auto& entry) { return entry.second->last_used < picture_ - 2; });
}

const GpuMesh& MeshCache::prepared(const TriMesh& mesh, const std::vector<Vec3>* position) {
    if (position != nullptr && position->size() != mesh.position.size()) {
        fail(ExitCode::output, "{} positions to draw a mesh of {} vertices", position->size(),
             mesh.position.size());
    }
    const std::uint64_t content = content_of(mesh, position == nullptr);
    // A mesh that stands still may be drawn many times from one copy.
    const Key key = {content, position == nullptr ? -1 : seen_[content]++};
    std::unique_ptr<GpuMesh>& gpu = mesh_[key];
    if (!gpu) gpu = made(mesh);
    gpu->last_used = picture_;
    if (position != nullptr || !gpu->filled) {
        send(*gpu, gpu->smoothed ? *gpu->smoothed : mesh, position ? *position : mesh.position);
    }
    return *gpu;
}

std::unique_ptr<GpuMesh> MeshCache::made(const TriMesh& mesh) const {
    const Gl& gl = *gl_;
    auto gpu = std::make_unique<GpuMesh>();
    if (mesh.triangle_smooth.empty()) {
        gpu->smoothed = std::make_unique<TriMesh>(mesh);
        smooth_by_crease_angle(*gpu->smoothed);
        gpu->split = split_corners(*gpu->smoothed);
    } else {
        gpu->split = split_corners(mesh);
    }
    gpu->closed = holds_volume(mesh);
    const DrawMesh& split = gpu->split;
    std::vector<FixedVertex> fixed(split.vertex_position.size());
    for (std::size_t v = 0; v < fixed.size(); ++v) {
        fixed[v] = {{0, 0}, {1, 1, 1}};
        if (split.vertex_uv[v] >= 0) {
            const Vec2& uv = mesh.uv[static_cast<std::size_t>(split.vertex_uv[v])];
            fixed[v].uv[0] = static_cast<float>(uv.x());
            fixed[v].uv[1] = static_cast<float>(uv.y());
        }
        if (!mesh.position_color.empty()) {
            const auto& c = mesh.position_color[static_cast<std::size_t>(split.vertex_position[v])];
            for (int i = 0; i < 3; ++i) fixed[v].color[i] = c[i];
        }
    }
    gpu->vertex_array = make_vertex_array(gl);
    gpu->moving = make_buffer(gl);
    gpu->fixed = make_buffer(gl);
    gpu->index = make_buffer(gl);
    gl.BindVertexArray(gpu->vertex_array.id());
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu->index.id());
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(split.index.size() * sizeof(std::uint32_t)),
                  split.index.data(), GL_STATIC_DRAW);
    gl.BindBuffer(GL_ARRAY_BUFFER, gpu->fixed.id());
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(fixed.size() * sizeof(FixedVertex)),
                  fixed.data(), GL_STATIC_DRAW);
    attribute(gl, 2, 2, sizeof(FixedVertex), offsetof(FixedVertex, uv));
    attribute(gl, 3, 3, sizeof(FixedVertex), offsetof(FixedVertex, color));
    gl.BindBuffer(GL_ARRAY_BUFFER, gpu->moving.id());
    attribute(gl, 0, 3, sizeof(MovingVertex), offsetof(MovingVertex, position));
    attribute(gl, 1, 3, sizeof(MovingVertex), offsetof(MovingVertex, normal));
    gl.BindVertexArray(0);
    return gpu;
}

void MeshCache::send(GpuMesh& gpu, const TriMesh& mesh, const std::vector<Vec3>& position) const {
    const Gl& gl = *gl_;
    const Box box = box_of(position);
    if (!box.empty()) gpu.origin = box.center();
    const std::vector<Vec3> normal = smooth_normals(mesh, position);
    std::vector<MovingVertex> moving(gpu.split.vertex_position.size());
    for (std::size_t v = 0; v < moving.size(); ++v) {
        const Vec3 p =
            position[static_cast<std::size_t>(gpu.split.vertex_position[v])] - gpu.origin;
        const Vec3& n = normal[static_cast<std::size_t>(gpu.split.vertex_smooth[v])];
        for (int i = 0; i < 3; ++i) {
            moving[v].position[i] = static_cast<float>(p[i]);
            moving[v].normal[i] = static_cast<float>(n[i]);
        }
    }
    gl.BindBuffer(GL_ARRAY_BUFFER, gpu.moving.id());
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(moving.size() * sizeof(MovingVertex)),
                  moving.data(), GL_STREAM_DRAW);
    gpu.filled = true;
}

}  // namespace swage
