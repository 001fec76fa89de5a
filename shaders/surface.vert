#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame.glsl"
layout(location = 0) in vec3 mesh_position;
layout(location = 1) in vec3 mesh_normal;
layout(location = 2) in vec2 mesh_uv;
layout(location = 3) in vec3 mesh_color;
uniform mat4 stage_from_mesh;
out vec3 position;
centroid out vec3 normal;
out vec2 uv;
out vec3 color;

void main() {
    position = (stage_from_mesh * vec4(mesh_position, 1.0)).xyz;
    normal = mat3(stage_from_mesh) * mesh_normal;
    uv = mesh_uv;
    color = mesh_color;
    gl_Position = clip_from_stage * vec4(position, 1.0);
}
