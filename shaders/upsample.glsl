// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion and shadow at a full-size pixel, from the half-size samples around it that lie on the
// same surface. `depth` must be smooth over the primitive.
#include "packing.glsl"
uniform sampler2D visibility;

vec2 visibility_at(vec2 pixel, float depth) {
    vec2 ratio = half_size.xy * size.zw;
    vec2 at = pixel * ratio - 0.5;
    ivec2 base = clamp(ivec2(floor(at)), ivec2(0), max(ivec2(half_size.xy) - 2, ivec2(0)));
    vec2 f = clamp(at - vec2(base), 0.0, 1.0);
    vec2 slope = vec2(dFdx(depth), dFdy(depth)) / ratio;
    float narrow = 100.0 / depth;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec3 v = unpacked_visibility(
            texelFetch(visibility, base + corner, 0));
        vec2 share = mix(1.0 - f, f, vec2(corner));
        float off = narrow * (v.z - depth - dot(slope, vec2(corner) - f));
        float weight = (share.x * share.y + 0.01) / (1e-3 + off * off);
        sum += weight * vec3(v.xy, 1.0);
    }
    return sum.xy / sum.z;
}
