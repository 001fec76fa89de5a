#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// Takes out the 4 by 4 pattern of the pass before: the mean over 4 by 4 pixels. Where some of these
// are on another surface, as depth or slant tells, which would leave teeth of the pattern along its
// edge: the value here of the plane that fits those of 8 by 8 which are on the same, the near ones
// best.
#include "frame.glsl"
#include "packing.glsl"
uniform sampler2D visibility;
layout(location = 0) out vec4 blurred;

Seen at(ivec2 texel) {
    ivec2 last = ivec2(half_size.xy) - 1;
    return unpacked_seen(texelFetch(visibility, clamp(texel, ivec2(0), last), 0));
}

// The surface's slope in depth: of the two sides that on the same face, or the flatter.
float slope(Seen before, Seen center, Seen after) {
    float down_to = center.depth - before.depth, up_to = after.depth - center.depth;
    float up_differs = 1.0 - same_side(after.slant, center.slant);
    float down_differs = 1.0 - same_side(before.slant, center.slant);
    bool up = abs(up_to) + lens.w * up_differs < abs(down_to) + lens.w * down_differs;
    return up ? up_to : down_to;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Seen center = at(here);
    vec2 rise =
        vec2(slope(at(here - ivec2(1, 0)), center, at(here + ivec2(1, 0))),
             slope(at(here - ivec2(0, 1)), center, at(here + ivec2(0, 1))));
    // On a steep surface depth tells little.
    float narrow = 1.0 / (0.008 * center.depth + abs(rise.x) + abs(rise.y));
    int pace = pattern_step();
    vec3 sum = vec3(0.0);
    for (int n = 0; n < 16; ++n) {
        ivec2 off = (ivec2(n & 3, n >> 2) - 1) * pace;
        Seen v = at(here + off);
        float same = max(0.0, 1.0 - narrow * abs(v.depth - center.depth - dot(rise, vec2(off)))) *
                     same_side(v.slant, center.slant);
        sum += same * vec3(v.visible, 1.0);
    }
    vec2 value = sum.xy / sum.z;

    // Weighted sums of 1, place, place times place; of the values, and of these times place.
    float one = 0.0;
    vec2 place = vec2(0.0), with_x = vec2(0.0), with_y = vec2(0.0), all = vec2(0.0);
    vec3 square = vec3(0.0);  // xx, xy, yy
    int count = sum.z < 14.0 ? 64 : 0;  // a loop of no turns costs less than a branch
    for (int n = 0; n < count; ++n) {
        ivec2 place_in_pattern = ivec2(n & 7, n >> 3) - 3, off = place_in_pattern * pace;
        Seen v = at(here + off);
        vec2 p = vec2(place_in_pattern);
        float same = max(0.0, 1.0 - narrow * abs(v.depth - center.depth - dot(rise, vec2(off)))) *
                     same_side(v.slant, center.slant);
        float weight = same * exp(-0.12 * dot(p, p));
        one += weight;
        place += weight * p;
        square += weight * vec3(p.x * p.x, p.x * p.y, p.y * p.y);
        all += weight * v.visible;
        with_x += weight * p.x * v.visible;
        with_y += weight * p.y * v.visible;
    }
    if (count > 0) {
        // About the mean place; slopes are drawn to none where hardly anything tells them.
        vec2 mean = place / one, mean_value = all / one;
        vec3 spread = square / one - vec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y) +
                      vec3(0.3, 0.0, 0.3);
        vec2 on_x = with_x / one - mean.x * mean_value, on_y = with_y / one - mean.y * mean_value;
        float determinant = spread.x * spread.z - spread.y * spread.y;
        vec2 slope_x = (spread.z * on_x - spread.y * on_y) / determinant;
        vec2 slope_y = (spread.x * on_y - spread.y * on_x) / determinant;
        value = clamp(mean_value - slope_x * mean.x - slope_y * mean.y, 0.0, 1.0);
    }
    blurred = packed_seen(Seen(value, center.depth, center.slant));
}
