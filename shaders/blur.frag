#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// Mean over 4 pixels in a row or column, of those on the same surface: takes out the 4 by 4
// pattern of the pass before.
#include "frame.glsl"
uniform sampler2D visibility;
uniform int down;
layout(location = 0) out vec4 blurred;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = ivec2(half_size.xy) - 1;
    ivec2 step_by = down != 0 ? ivec2(0, 1) : ivec2(1, 0);
    vec4 center = texelFetch(visibility, here, 0);
    float before = texelFetch(visibility, clamp(here - step_by, ivec2(0), last), 0).z;
    float after = texelFetch(visibility, clamp(here + step_by, ivec2(0), last), 0).z;
    // The surface's slope in depth: of the two sides the flatter.
    float rise = abs(after - center.z) < abs(center.z - before) ? after - center.z
                                                                : center.z - before;
    vec3 sum = vec3(0.0);
    for (int i = -1; i <= 2; ++i) {
        vec4 v = texelFetch(visibility, clamp(here + i * step_by, ivec2(0), last), 0);
        float off = abs(v.z - center.z - rise * float(i)) / (0.008 * center.z);
        float weight = max(0.0, 1.0 - off);
        sum += weight * vec3(v.xy, 1.0);
    }
    blurred = vec4(sum.xy / sum.z, center.z, 1.0);
}
