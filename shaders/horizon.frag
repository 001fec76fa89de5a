#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// A plane that ends at the horizon, as layers.frag tells of a surface: by the ray through each
// pixel, as no triangle reaches so far.
#include "frame.glsl"
#include "layer.glsl"
uniform vec4 plane;  // its normal, towards the eye, and how far along it the plane lies
uniform vec4 number;
layout(location = 0) out vec4 layer;

void main() {
    vec2 ndc = 2.0 * gl_FragCoord.xy * size.zw - 1.0;
    vec3 ahead = mat3(stage_from_view) * vec3(ndc * lens.xy, -1.0);  // by a depth of 1
    float down = -dot(plane.xyz, ahead), above = dot(plane.xyz, eye.xyz) - plane.w;
    if (down <= 1e-6 || above <= 0.0) discard;
    float depth = above / down;
    vec4 clip = clip_from_stage * vec4(eye.xyz + depth * ahead, 1.0);
    gl_FragDepth = clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
#ifdef TRIANGLES
    layer = vec4(number.x, -1.0, 0.0, 0.0);
#else
    layer = layer_of(plane.xyz, depth, number.x);
#endif
}
