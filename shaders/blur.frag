#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// Mean over 4 pixels in a row or column, of those on the same surface: takes out the 4 by 4
// pattern of the pass before.
#include "frame.glsl"
#include "packing.glsl"
uniform sampler2D visibility;
uniform int down;
layout(location = 0) out vec4 blurred;

vec3 at(ivec2 texel) {
    ivec2 last = ivec2(half_size.xy) - 1;
    return unpacked_visibility(texelFetch(visibility, clamp(texel, ivec2(0), last), 0));
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 step_by = down != 0 ? ivec2(0, 1) : ivec2(1, 0);
    vec3 before = at(here - step_by), center = at(here), after = at(here + step_by);
    // The surface's slope in depth: of the two sides the flatter.
    float down_to = center.z - before.z, up_to = after.z - center.z;
    float rise = abs(up_to) < abs(down_to) ? up_to : down_to;
    vec3 row[4] = vec3[4](before, center, after, at(here + 2 * step_by));
    vec3 sum = vec3(0.0);
    for (int i = -1; i <= 2; ++i) {
        vec3 v = row[i + 1];
        float off = abs(v.z - center.z - rise * float(i)) / (0.008 * center.z);
        float weight = max(0.0, 1.0 - off);
        sum += weight * vec3(v.xy, 1.0);
    }
    blurred = packed_visibility(sum.xy / sum.z, center.z);
}
