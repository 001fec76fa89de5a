// SPDX-License-Identifier: GPL-3.0-or-later
// What all passes of one picture know. Stage space: the world moved so that the action's centre
// is the origin and scaled so that its half diagonal is 1; y is up.
layout(std140) uniform Frame {
    mat4 clip_from_stage;
    mat4 view_from_stage;
    mat4 stage_from_view;
    mat4 shadow_from_stage[3];  // to texture coordinates and depth, all 0 to 1; one a map
    vec4 shadow[3];     // of each: texel, side and depth [stage]; of one without shadows 0
    vec4 shadow_parts;  // depth before the eye where the first begins, maps a unit of the logarithm
                        // of depth, how many there are, tangent of the lamp's half angle
    vec4 eye;
    vec4 lens;       // tangents of the half angles x and y, nearest and farthest depth
    vec4 size;       // width, height, 1 / width, 1 / height
    vec4 half_size;  // the same of the half-size passes
    vec4 key;        // directions towards the lights; here and in fill the fourth is x and z of
    vec4 fill;       // where the film's first view looks from
    vec4 rim;
    vec4 ground;     // height, where its shadows start to fade, where it ends, 1: nothing is behind
};

const float PI = 3.14159265;

// The direction from the eye through a pixel, in stage space.
vec3 sight(vec2 pixel) {
    vec2 ndc = 2.0 * pixel * size.zw - 1.0;
    return normalize(mat3(stage_from_view) * vec3(ndc * lens.xy, -1.0));
}
