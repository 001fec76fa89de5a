#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// What stands between each pixel and the lamp, at half size: how many samples meet something, and
// how far that stands off, after R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH sketches
// 2005. Samples are turned by a 4 by 4 pattern; the next pass takes the mean over that, so that
// the width of a half shadow does not change from pixel to pixel.
#include "frame.glsl"
#include "shadow.glsl"
uniform sampler2D normal_and_depth;
layout(location = 0) out vec4 blockers;

const int SEARCH_TAPS = 12;

void main() {
    vec4 here = texelFetch(normal_and_depth, ivec2(gl_FragCoord.xy), 0);
    vec3 p = vec3((2.0 * gl_FragCoord.xy * half_size.zw - 1.0) * lens.xy, -1.0) * here.w;
    float turn = pattern();
    Shaded s = shaded((stage_from_view * vec4(p, 1.0)).xyz, mat3(stage_from_view) * here.xyz,
                      here.w, turn);
    float lamp = shadow_parts.w;
    float search = s.least + lamp * min(s.at.z, 1.0) * s.depth;
    float met = 0.0, gaps = 0.0;
    vec2 direction = first_direction(turn);
    // A loop of no turns, where no shadow falls: much cheaper than a branch in software.
    int turns = s.open ? SEARCH_TAPS : 0;
    for (int i = 0; i < turns; ++i) {
        // Closer together near the middle: what is small stands near what it shades.
        float off = search * (float(i) + turn) / float(SEARCH_TAPS);
        float gap = gap_at(s, off * direction);
        direction = GOLDEN_TURN * direction;
        // What stands near, well beside the cone to the lamp, hides nothing of it.
        float blocks = step(s.clear, gap) * step(off, s.least + 3.0 * lamp * gap);
        met += blocks;
        gaps += blocks * gap;
    }
    float mean = gaps / max(met, 1.0);
    blockers = packed_seen(Seen(vec2(met / float(SEARCH_TAPS), sqrt(mean / (1.0 + mean))), here.w,
                                here.xy));
}
