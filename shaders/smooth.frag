#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// Steps along edges are softened after the picture is made, for meshes of very many triangles.
// After T. Lottes, "FXAA", NVIDIA white paper 2009 (the short variant: the edge's direction from
// four diagonal neighbours, then means along it).
#include "frame.glsl"
#ifdef LINEAR
#include "film.glsl"
#endif
uniform sampler2D picture;
layout(location = 0) out vec4 pixel_color;

#ifdef LINEAR
float brightness(vec3 c) { return dot(shown(c), vec3(0.299, 0.587, 0.114)); }
#else
float brightness(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
#endif

void main() {
    vec2 at = gl_FragCoord.xy * size.zw;
    vec4 here = texture(picture, at);
    float nw = brightness(texture(picture, at + vec2(-1.0, 1.0) * size.zw).rgb);
    float ne = brightness(texture(picture, at + vec2(1.0, 1.0) * size.zw).rgb);
    float sw = brightness(texture(picture, at + vec2(-1.0, -1.0) * size.zw).rgb);
    float se = brightness(texture(picture, at + vec2(1.0, -1.0) * size.zw).rgb);
    float m = brightness(here.rgb);
    float low = min(m, min(min(nw, ne), min(sw, se)));
    float high = max(m, max(max(nw, ne), max(sw, se)));
    bool flat_here = high - low < max(0.04, 0.1 * high);
    // Along the edge: across the direction in which brightness grows.
    vec2 along = vec2((sw + se) - (nw + ne), (ne + se) - (nw + sw));
    float small = 1.0 / (min(abs(along.x), abs(along.y)) + max(0.03 * (nw + ne + sw + se), 0.008));
    vec2 by = flat_here ? vec2(0.0) : clamp(along * small, -8.0, 8.0) * size.zw;
    vec4 inner = 0.5 * (texture(picture, at - by / 6.0) + texture(picture, at + by / 6.0));
    vec4 outer = 0.5 * inner +
                 0.25 * (texture(picture, at - 0.5 * by) + texture(picture, at + 0.5 * by));
    float o = brightness(outer.rgb);
    vec4 result = o < low || o > high ? inner : outer;
    pixel_color = flat_here ? here : result;
}
