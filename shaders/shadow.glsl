// SPDX-License-Identifier: GPL-3.0-or-later
// What lies in the way to the key lamp, as the maps that are seen from there tell. Lengths are the
// stage's.
#include "packing.glsl"
uniform sampler2D shadow_depth;  // maps one above the other

// Samples go round by the golden angle, which fills a disc evenly at any count (H. Vogel 1979).
const mat2 GOLDEN_TURN = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

float pattern() {
    ivec2 p = ivec2(gl_FragCoord.xy) / pattern_step() & 3;
    int x = p.x ^ p.y;
    return (float((x & 1) << 3 | (p.y & 1) << 2 | (x & 2) | (p.y & 2) >> 1) + 0.5) / 16.0;
}

vec2 first_direction(float turn) { return vec2(cos(2.0 * PI * turn), sin(2.0 * PI * turn)); }

// A place on a surface as a map has it.
struct Shaded {
    bool open;    // a shadow may fall there
    vec3 at;      // texture coordinates and depth of the map
    vec2 rise;    // of the surface in these
    float texel, side, depth;  // of the map
    float least;  // half shadow [stage]
    float clear;  // what stands less off casts none, and what does twice as far all of it [stage]
    int row;      // of the texture, where the map begins
};

bool turned_away(vec3 n) { return dot(n, key.xyz) < -0.1; }

// `turn` parts pixels between two maps near where these meet; the blur makes that a slow change.
Shaded shaded(vec3 p, vec3 n, float depth_in_view, float turn) {
    float part = log(max(depth_in_view / shadow_parts.x, 1e-6)) * shadow_parts.y;
    int most = int(shadow_parts.z) - 1;
    int map = clamp(int(floor(part + 0.18 * (turn - 0.5))), 0, max(most, 0));
    vec4 lengths = shadow[map];
    mat4 map_from_stage = shadow_from_stage[map];
    float facing = max(dot(n, key.xyz), 0.2);
    // Texels are flat steps on what leans.
    float off_surface = lengths.x * (1.5 + 2.0 * clamp(1.0 - facing, 0.0, 1.0));
    Shaded s;
    s.at = (map_from_stage * vec4(p + n * off_surface, 1.0)).xyz;
    s.rise = (mat3(map_from_stage) * n).xy * lengths.y * lengths.y / (facing * max(lengths.z, 1e-9));
    s.texel = lengths.x;
    s.side = max(lengths.y, 1e-9);
    s.depth = max(lengths.z, 1e-9);
    // The blur takes the mean over its pattern: the strip of shadow under what stands less off than
    // that is wide would be teeth along its edge.
    float pixel = 2.0 * depth_in_view * lens.y * half_size.w;
    s.least = max(1.5 * s.texel, 0.5 * pixel);
    s.clear = s.texel + 3.0 * float(pattern_step()) * pixel;
    s.row = map * textureSize(shadow_depth, 0).x;
    s.open = most >= 0 && lengths.z > 0.0 && s.at.z > 0.0 && !turned_away(n);
    return s;
}

// How far nearer to the lamp than the surface stands what the map has `off` [stage] aside; of
// nothing, less than none. A map's floor stands at 1, as what is empty does.
float gap_at(Shaded s, vec2 off) {
    vec2 aside = off / s.side, at = s.at.xy + aside;
    int side = textureSize(shadow_depth, 0).x;
    ivec2 texel = ivec2(floor(at * float(side)));
    ivec2 held = clamp(texel, ivec2(0), ivec2(side - 1));
    float d = texelFetch(shadow_depth, held + ivec2(0, s.row), 0).r;
    float gap = (s.at.z + dot(aside, s.rise) - d) * s.depth;
    return d < 1.0 && held == texel ? gap : -1.0;
}
