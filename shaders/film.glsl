// SPDX-License-Identifier: GPL-3.0-or-later
// From light to the bytes of a picture.

// Straight up to the knee, so that a texture's colours come out as painted; above it a shoulder
// that nears 1, where bright colours also pale as film does.
vec3 film_curve(vec3 light) {
    const float knee = 0.62;
    float peak = max(light.r, max(light.g, light.b));
    if (peak <= knee) return light;
    float over = (peak - knee) / (1.0 - knee);
    float bent = 1.0 - (1.0 - knee) / (1.0 + over * (1.0 + over * (0.5 + 0.2 * over)));
    vec3 color = light * (bent / peak);
    float pale = 1.0 - 1.0 / (0.18 * (peak - bent) + 1.0);
    return mix(color, vec3(bent), pale);
}

// IEC 61966-2-1, its power replaced by roots, which cost a third; fitted here, off by at most
// 0.012 of a byte.
vec3 srgb(vec3 linear) {
    vec3 c = clamp(linear, 0.0, 1.0);
    vec3 r2 = sqrt(c), r4 = sqrt(r2), r8 = sqrt(r4);
    vec3 curve = 0.64236823 * r2 + 0.71210792 * r4 - 0.33686897 * r8 - 0.01756420 * c;
    return mix(12.92 * c, curve, step(0.0031308, c));
}

// One unit of the last bit, spread in an 8 by 8 ordered pattern (B. E. Bayer 1973), so that slow
// gradients show no steps. The pattern repeats, which packs better than noise.
float dither(vec2 pixel) {
    ivec2 p = ivec2(pixel);
    int x = p.x ^ p.y, y = p.y;
    int rank = (x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 |
               (y & 4) >> 2;
    return (float(rank) + 0.5) / 64.0 - 0.5;
}

vec3 shown(vec3 light) {
    vec3 c = srgb(film_curve(light));
    // A little of an S-curve: deeper darks without touching white or the middle.
    return mix(c, c * c * (3.0 - 2.0 * c), 0.18);
}

#ifdef LINEAR
// The light itself, of which `shown` makes the picture's.
vec4 developed(vec3 light, vec2 pixel) { return vec4(light, 1.0); }
#else
vec4 developed(vec3 light, vec2 pixel) { return vec4(shown(light) + dither(pixel) / 255.0, 1.0); }
#endif

// A floor of which only the shadow is wanted, where it is `lit` and where it is `dimmed`: black,
// and so dense that bytes laid over each other show the same as if it were there. Premultiplied, as
// all of a picture is until it is read back. Of light, light does.
vec4 caught(vec3 lit, vec3 dimmed) {
#ifdef LINEAR
    float kept = dot(dimmed, vec3(1.0)) / max(dot(lit, vec3(1.0)), 1e-6);
#else
    float kept = dot(shown(dimmed), vec3(1.0)) / max(dot(shown(lit), vec3(1.0)), 1e-6);
#endif
    return vec4(0.0, 0.0, 0.0, 1.0 - min(kept, 1.0));
}
