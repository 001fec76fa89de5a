#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the surroundings and of the key light reaches each pixel, at half size.
// Occlusion after M. McGuire, M. Mara and D. Luebke, "Scalable Ambient Obscurance", HPG 2012.
// Shadow after R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH sketches 2005.
// Samples are turned by a 4 by 4 pattern, which the blur after this pass takes out again.
#include "frame.glsl"
#include "shadow.glsl"
uniform sampler2D normal_and_depth;
uniform sampler2D blockers;
layout(location = 0) out vec4 visibility;

const int OCCLUSION_TAPS = 10;
const int SHADOW_TAPS = 16;  // at least
const float REACH = 0.22;    // of occlusion [stage], or
const float REACH_SEEN = 0.8;  // of half the picture's height, where that is less

vec3 view_position(vec2 pixel, float depth) {
    return vec3((2.0 * pixel * half_size.zw - 1.0) * lens.xy, -1.0) * depth;
}

// How far out sample i lies in a unit disc; `turn` (0 to 1) is the pattern's share, so that its 16
// values together fill the disc.
float outward(int i, int count, float turn) { return sqrt((float(i) + turn) / float(count)); }

// A share that nears a floor instead of falling to nothing: in the deepest crease some light comes
// round the corners that are not followed here.
float softened(float share) {
    const float knee = 0.3, least = 0.08;
    return share > knee ? share : least + (knee - least) * exp((share - knee) / (knee - least));
}

// Its lengths are the stage's, so that a crease is as dark in a near view as in one from afar; but
// what is small in the stage, and seen from very near, has creases of its own size.
float occlusion(vec3 p, vec3 n, float turn) {
    float half_height = p.z * -lens.y;
    float shrunk = min(1.0, REACH_SEEN * half_height / REACH);
    float pixels = shrunk * REACH / half_height * 0.5 * half_size.y;
    float nearest = max(0.02 * pixels, 1.0);
    float sum = 0.0;
    vec2 direction = first_direction(turn);
    ivec2 last = ivec2(half_size.xy) - 1;
    for (int i = 0; i < OCCLUSION_TAPS; ++i) {
        float share = (float(i) + turn) / float(OCCLUSION_TAPS);
        vec2 at = gl_FragCoord.xy + direction * (share * pixels + nearest);
        direction = GOLDEN_TURN * direction;
        ivec2 texel = clamp(ivec2(at), ivec2(0), last);
        float depth = texelFetch(normal_and_depth, texel, 0).w;
        vec3 v = (view_position(vec2(texel) + 0.5, depth) - p) / shrunk;
        float v2 = dot(v, v);
        float f = max(1.0 - v2 / (REACH * REACH), 0.0);
        sum += f * f * f * max(dot(v, n) - 0.005, 0.0) / (v2 + 2e-4);
    }
    // The samples' mean of 1 / distance becomes a share by a length; this one was chosen by eye.
    return min(softened(1.0 - 0.37 * sum / float(OCCLUSION_TAPS)), 1.0);
}

// How far off stands what hides the lamp, of all that the pattern's pixels on this surface found;
// below 0: nothing does.
float gap_found(float depth, vec2 slant) {
    ivec2 here = ivec2(gl_FragCoord.xy), last = ivec2(half_size.xy) - 1;
    int pace = pattern_step();
    float narrow = 1.0 / (0.03 * depth);
    vec2 sum = vec2(0.0);
    for (int n = 0; n < 16; ++n) {
        ivec2 off = (ivec2(n & 3, n >> 2) - 1) * pace;
        Seen v = unpacked_seen(texelFetch(blockers, clamp(here + off, ivec2(0), last), 0));
        float same = max(0.0, 1.0 - narrow * abs(v.depth - depth)) * same_side(v.slant, slant);
        float root2 = v.visible.y * v.visible.y;
        sum += same * v.visible.x * vec2(root2 / max(1.0 - root2, 1e-3), 1.0);
    }
    return sum.y > 0.0 ? sum.x / sum.y : -1.0;
}

float lit(vec3 p, vec3 n, float depth_in_view, vec2 slant, float turn) {
    if (turned_away(n)) return 0.0;  // it shades itself; so does the floor where it meets that
    Shaded s = shaded(p, n, depth_in_view, turn);
    float gap = s.open ? gap_found(depth_in_view, slant) : -1.0;
    float radius = s.least + shadow_parts.w * max(gap, 0.0);
    // Few would show as single steps where the edge is wide, in large pictures and near views.
    float pixels = radius / (2.0 * depth_in_view * lens.y * half_size.w);
    int taps = SHADOW_TAPS * int(clamp(pixels / 8.0, 1.0, 6.0));
    int turns = gap > 0.0 ? taps : 0;
    float dark = 0.0;
    vec2 direction = first_direction(turn);
    for (int i = 0; i < turns; ++i) {
        float off = radius * outward(i, taps, turn);
        // What stands less off than it stands aside hides nothing of the lamp: as near as that are
        // bends of the surface itself.
        float stands_off = gap_at(s, off * direction) - max(off - s.least, 0.0);
        dark += clamp(stands_off / s.clear - 1.0, 0.0, 1.0);
        direction = GOLDEN_TURN * direction;
    }
    return 1.0 - dark / float(taps);
}

void main() {
    vec4 here = texelFetch(normal_and_depth, ivec2(gl_FragCoord.xy), 0);
    vec3 p = view_position(gl_FragCoord.xy, here.w);
    float turn = pattern();
    vec3 at = (stage_from_view * vec4(p, 1.0)).xyz;
    vec2 visible = vec2(occlusion(p, here.xyz, turn),
                        lit(at, mat3(stage_from_view) * here.xyz, here.w, here.xy, turn));
    visibility = packed_seen(Seen(visible, here.w, here.xy));
}
