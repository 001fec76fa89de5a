// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion, shadow and depth in four bytes, which a software sampler reads several times as fast
// as four floats: depth takes two of them, as a share of the far end.
vec4 packed_visibility(vec2 visible, float depth) {
    float steps = clamp(depth / lens.w, 0.0, 1.0) * 65535.0;
    float high = floor(steps / 256.0);
    return vec4(visible, high / 255.0, floor(steps - 256.0 * high) / 255.0);
}

// Occlusion, shadow, depth.
vec3 unpacked_visibility(vec4 bytes) {
    return vec3(bytes.xy, (bytes.z * 65280.0 + bytes.w * 255.0) * (lens.w / 65535.0));
}
