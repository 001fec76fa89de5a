#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen in the middle of a pixel, or which triangle that is.
#include "frame.glsl"
#include "normal.glsl"
#include "layer.glsl"
in vec3 position;
centroid in vec3 normal;
uniform vec4 number;
layout(location = 0) out vec4 layer;

void main() {
#ifdef TRIANGLES
    layer = vec4(number.x, float(gl_PrimitiveID), 0.0, 0.0);
#else
    layer = layer_of(facing_normal(normal, position, eye.xyz),
                     -(view_from_stage * vec4(position, 1.0)).z, number.x);
#endif
}
