// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion and shadow at a full-size pixel, from the half-size samples around it that lie on the
// same surface, as depth and slant tell. `depth` must be smooth over the primitive; `normal` is in
// the stage, towards the eye.
#include "packing.glsl"
uniform sampler2D visibility;

vec2 visibility_at(vec2 pixel, float depth, vec3 normal) {
    vec2 ratio = half_size.xy * size.zw;
    vec2 at = pixel * ratio - 0.5;
    ivec2 base = clamp(ivec2(floor(at)), ivec2(0), max(ivec2(half_size.xy) - 2, ivec2(0)));
    vec2 f = clamp(at - vec2(base), 0.0, 1.0);
    vec2 rise = vec2(dFdx(depth), dFdy(depth)) / ratio;
    float narrow = 100.0 / depth;
    vec2 slant = (mat3(view_from_stage) * normal).xy;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        Seen v = unpacked_seen(texelFetch(visibility, base + corner, 0));
        vec2 share = mix(1.0 - f, f, vec2(corner));
        float off = narrow * (v.depth - depth - dot(rise, vec2(corner) - f));
        vec2 bend = v.slant - slant;
        float weight = (share.x * share.y + 0.01) / (1e-3 + off * off + 0.5 * dot(bend, bend));
        sum += weight * vec3(v.visible, 1.0);
    }
    return sum.xy / sum.z;
}
