#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame.glsl"
#include "light.glsl"
#include "film.glsl"
layout(location = 0) out vec4 pixel_color;

void main() {
    pixel_color = developed(backdrop(sight(gl_FragCoord.xy), gl_FragCoord.xy), gl_FragCoord.xy);
    if (ground.w > 0.0) pixel_color = vec4(0.0);
}
