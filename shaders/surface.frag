#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// A metal, a dielectric or a clear surface. What it mirrors is a room and its lamps, blurred by its
// roughness; the share that it mirrors after B. Karis, "Physically Based Shading on Mobile", 2014;
// no sparks after A. Kaplanyan et al., "Filtering Distributions of Normals for Shading
// Antialiasing", HPG 2016.
#include "frame.glsl"
#include "light.glsl"
#include "film.glsl"
#include "normal.glsl"
#include "upsample.glsl"
in vec3 position;
centroid in vec3 normal;
in vec2 uv;
in vec3 color;
#ifdef TEXTURED
uniform sampler2D surface_texture;
#endif
uniform vec4 material_color;
uniform vec4 material_finish;  // roughness, metallic, whether the mesh's colours count, share of
                               // light that goes through: it bends twice as in a ball and meets
                               // the room, for what else is drawn is not seen through
uniform vec4 endless;          // middle and radius of what fades out; a radius of 0: does not
uniform vec4 evened;           // share of the light that is the same everywhere
layout(location = 0) out vec4 pixel_color;

const float EVEN = 0.9;    // what a white matt surface returns of that: nearly its own colour
const float INDEX = 1.45;  // of refraction, between ice and glass

vec3 environment_share(vec3 f0, float roughness, float nv) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    vec2 scale = vec2(-1.04, 1.04) * a + r.zw;
    return f0 * scale.x + scale.y;
}

void main() {
    vec3 base = material_color.rgb * mix(vec3(1.0), color, material_finish.z);
#ifdef TEXTURED
    base *= texture(surface_texture, uv).rgb;
#endif
    float roughness = clamp(material_finish.x, 0.08, 1.0), metallic = material_finish.y;
    vec3 n = facing_normal(normal, position, eye.xyz);
    vec3 v = normalize(eye.xyz - position);
    float nv = max(dot(n, v), 0.02);
    float depth = -(view_from_stage * vec4(position, 1.0)).z;
    vec2 seen = visibility_at(gl_FragCoord.xy, depth, n);

    vec3 f0 = mix(vec3(0.04), base, metallic);
    float clear = material_finish.w;
    vec3 matt = base * (1.0 - metallic) * (1.0 - clear);
    float nl = max(dot(n, key.xyz), 0.0);

    vec3 light = matt * mix(KEY * nl * seen.y + ambient(n) * seen.x,
                            vec3(EVEN * (0.5 + 0.5 * seen.x)), evened.x);
    vec3 ray = reflect(-v, n), wall = on_wall(position, ray);
    // Where a pixel holds much of a bend, its mirror image is as blurred as that: no sparks.
    vec3 bend_x = dFdx(n), bend_y = dFdy(n);
    float bend2 = dot(bend_x, bend_x) + dot(bend_y, bend_y);
    float spread2 = spread2_of(roughness) + min(bend2, 0.25);
    float seen_mirror = clamp(seen.x * (0.55 + 0.45 * seen.y), 0.0, 1.0);
    vec3 mirror = environment_share(f0, roughness, nv);
    light += mirror * (key_mirrored(wall, spread2) * seen.y +
                       surroundings(position, ray, wall, spread2) * seen_mirror);
    if (clear > 0.0) {
        vec3 inside = refract(-v, n, 1.0 / INDEX);
        vec3 behind = 2.0 * dot(-v, inside) * inside + v, there = on_wall(position, behind);
        light += base * clear * (1.0 - mirror) *
                 (key_mirrored(there, spread2) * seen.y +
                  surroundings(position, behind, there, spread2));
    }
    pixel_color = developed(light, gl_FragCoord.xy);
    if (endless.w > 0.0) {  // the backdrop's own paper, but for its colour
        float out_of_action = smoothstep(ground.y, 6.0, length(position));
        float to_its_edge = smoothstep(0.6, 0.98, distance(position, endless.xyz) / endless.w);
        float near = 1.0 - max(out_of_action, to_its_edge);
        vec3 share = (KEY * nl * seen.y + ambient(n) * seen.x) / open_light();
        vec3 paper = base / PAPER;
        float wide = endless.w;
        vec3 floor_light = paper_floor(position, gl_FragCoord.xy, share * paper, near, wide);
        pixel_color =
            ground.w > 0.0
                ? caught(paper_floor(position, gl_FragCoord.xy, paper, near, wide), floor_light)
                : developed(floor_light, gl_FragCoord.xy);
    }
}
