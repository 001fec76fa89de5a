#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the surroundings and of the key light reaches each pixel, at half size.
// Occlusion after M. McGuire, M. Mara and D. Luebke, "Scalable Ambient Obscurance", HPG 2012.
// Shadow after R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH sketches 2005.
// Samples are turned by a 4 by 4 pattern, which the blur after this pass takes out again.
#include "frame.glsl"
#include "packing.glsl"
uniform sampler2D normal_and_depth;
uniform sampler2D shadow_depth;
layout(location = 0) out vec4 visibility;

const int OCCLUSION_TAPS = 10;
const int SEARCH_TAPS = 12;
const int SHADOW_TAPS = 12;    // at least
const float REACH = 0.22;      // of occlusion [stage]

// Samples go round by the golden angle, which fills a disc evenly at any count.
const mat2 GOLDEN_TURN = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

vec3 view_position(vec2 pixel, float depth) {
    return vec3((2.0 * pixel * half_size.zw - 1.0) * lens.xy, -1.0) * depth;
}

float pattern() {
    ivec2 p = ivec2(gl_FragCoord.xy) / pattern_step() & 3;
    int x = p.x ^ p.y;
    return (float((x & 1) << 3 | (p.y & 1) << 2 | (x & 2) | (p.y & 2) >> 1) + 0.5) / 16.0;
}

// How far out sample i lies in a unit disc; `turn` (0 to 1) is the pattern's share, so that its 16
// values together fill the disc.
float outward(int i, int count, float turn) { return sqrt((float(i) + turn) / float(count)); }

vec2 first_direction(float turn) { return vec2(cos(2.0 * PI * turn), sin(2.0 * PI * turn)); }

// A share that nears a floor instead of falling to nothing: in the deepest crease some light comes
// round the corners that are not followed here.
float softened(float share) {
    const float knee = 0.3, least = 0.08;
    return share > knee ? share : least + (knee - least) * exp((share - knee) / (knee - least));
}

// Its lengths are the stage's, so that a crease is as dark in a near view as in one from afar.
float occlusion(vec3 p, vec3 n, float turn) {
    float pixels = REACH / (p.z * -lens.y) * 0.5 * half_size.y;
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
        vec3 v = view_position(vec2(texel) + 0.5, depth) - p;
        float v2 = dot(v, v);
        float f = max(1.0 - v2 / (REACH * REACH), 0.0);
        sum += f * f * f * max(dot(v, n) - 0.005, 0.0) / (v2 + 2e-4);
    }
    // The samples' mean of 1 / distance becomes a share by a length; this one was chosen by eye.
    return min(softened(1.0 - 0.37 * sum / float(OCCLUSION_TAPS)), 1.0);
}

float lit(vec3 p, vec3 n, float depth_in_view, float turn) {
    float slope = clamp(1.0 - dot(n, key.xyz), 0.0, 1.0);
    vec3 s = (shadow_from_stage * vec4(p + n * shadow.x * (1.5 + 4.0 * slope), 1.0)).xyz;
    // A little outside, soft edges still reach; the texels of the rim are empty.
    bool inside = s.z > 0.0 && all(lessThan(abs(s.xy - 0.5), vec2(0.75)));
    // Loops of no turns, where the map does not reach or the surface looks away: much cheaper
    // than a branch in software.
    bool away = dot(n, key.xyz) < -0.1;
    bool open = inside && !away;
    float size = 1.0 / shadow.y;
    ivec2 last = ivec2(size) - 1;
    float bias = 0.0015;
    // The floor reaches deeper than the map, whose empty places stand at 1.
    float depth = min(s.z, 1.0);
    float search = shadow.w + shadow.z * min(s.z, 1.0);
    float blockers = 0.0, blocker_depth = 0.0;
    vec2 direction = first_direction(turn);
    int turns = open ? SEARCH_TAPS : 0;
    for (int i = 0; i < turns; ++i) {
        float off = search * outward(i, SEARCH_TAPS, turn);
        vec2 at = s.xy + off * direction;
        direction = GOLDEN_TURN * direction;
        float d = texelFetch(shadow_depth, clamp(ivec2(at * size), ivec2(0), last), 0).r;
        // What stands near, well beside the cone to the lamp, hides nothing of it.
        float blocks = step(d, depth - bias) * step(off, shadow.w + 3.0 * shadow.z * (depth - d));
        blockers += blocks;
        blocker_depth += blocks * d;
    }
    float gap = s.z - blocker_depth / max(blockers, 1.0);
    float radius = shadow.w + shadow.z * gap;
    float light = 0.0;
    // Wider kernels look past their own tilted surface; the bias grows with them.
    float slack = bias + radius * slope * 0.25;
    // Few would show as single steps where the edge is wide, in large pictures and near views.
    float pixels = radius * shadow.x / (shadow.y * 2.0 * depth_in_view * lens.y * half_size.w);
    int taps = SHADOW_TAPS * int(clamp(pixels / 12.0, 1.0, 8.0));
    turns = blockers > 0.0 ? taps : 0;
    for (int i = 0; i < turns; ++i) {
        vec2 at = s.xy + radius * outward(i, taps, turn) * direction;
        direction = GOLDEN_TURN * direction;
        float d = texelFetch(shadow_depth, clamp(ivec2(at * size), ivec2(0), last), 0).r;
        light += step(depth - slack, d);
    }
    // What looks away shades itself; so does the floor where it meets that, at the same depth.
    if (away) return 0.0;
    return blockers > 0.0 ? light / float(taps) : 1.0;
}

void main() {
    vec4 here = texelFetch(normal_and_depth, ivec2(gl_FragCoord.xy), 0);
    vec3 p = view_position(gl_FragCoord.xy, here.w);
    float turn = pattern();
    vec3 at = (stage_from_view * vec4(p, 1.0)).xyz;
    vec2 visible = vec2(occlusion(p, here.xyz, turn),
                        lit(at, mat3(stage_from_view) * here.xyz, here.w, turn));
    visibility = packed_seen(Seen(visible, here.w, here.xy));
}
