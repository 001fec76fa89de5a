// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of a half-size pixel, in four numbers of 16 bits, which a software sampler reads
// faster than four floats: occlusion, shadow, depth by its logarithm, as what is near the eye is
// small where the far end is far away, and slant. Of a
// normal on the side that is looked at, what it leans across the view tells it from others.
struct Seen {
    vec2 visible;
    float depth;
    vec2 slant;
};

vec4 packed_seen(Seen seen) {
    vec2 byte = floor(255.0 * clamp(0.5 + 0.5 * seen.slant, 0.0, 1.0) + 0.5);
    float far = log2(max(seen.depth / lens.z, 1.0)) / log2(lens.w / lens.z);
    return vec4(seen.visible, far, (256.0 * byte.x + byte.y) / 65535.0);
}

Seen unpacked_seen(vec4 v) {
    float both = v.w * (65535.0 / 256.0), high = floor(both + 0.5 / 256.0);
    vec2 byte = vec2(high, 256.0 * (both - high));
    return Seen(v.xy, lens.z * exp2(v.z * log2(lens.w / lens.z)), byte * (2.0 / 255.0) - 1.0);
}

// How far apart the pixels of one pattern stand. A large picture is looked at as a whole: there the
// mean over them is taken as wide as in a small one, or single samples show as streaks.
int pattern_step() { return half_size.y < 720.0 ? 1 : half_size.y < 1440.0 ? 2 : 4; }

// 1 on one face, also where it curves by 20 degrees; 0 beyond a hard edge, of 40 or more.
float same_side(vec2 a, vec2 b) {
    vec2 d = a - b;
    return clamp(1.5 - 3.5 * dot(d, d), 0.0, 1.0);
}
