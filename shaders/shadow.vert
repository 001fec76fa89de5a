#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame.glsl"
layout(location = 0) in vec3 mesh_position;
uniform mat4 stage_from_mesh;
uniform int map;

void main() {
    vec4 p = shadow_from_stage[map] * (stage_from_mesh * vec4(mesh_position, 1.0));
    gl_Position = vec4(2.0 * p.xyz - 1.0, 1.0);
}
