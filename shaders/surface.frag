#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// A metal or dielectric surface. Microfacets: B. Walter et al., "Microfacet Models for Refraction
// through Rough Surfaces", EGSR 2007; E. Heitz 2014 for the masking; the environment's share after
// B. Karis, "Physically Based Shading on Mobile", 2014.
#include "frame.glsl"
#include "light.glsl"
#include "film.glsl"
#include "normal.glsl"
#include "upsample.glsl"
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec3 color;
#ifdef TEXTURED
uniform sampler2D surface_texture;
#endif
uniform vec4 material_color;
uniform vec4 material_finish;  // roughness, metallic, whether the mesh's colours count
uniform vec4 endless;          // middle and radius of what fades out; a radius of 0: does not
layout(location = 0) out vec4 pixel_color;

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
    vec3 matt = base * (1.0 - metallic);
    float nl = max(dot(n, key.xyz), 0.0);

    vec3 h = normalize(key.xyz + v);
    float nh = max(dot(n, h), 0.0);
    // The lamp has a size, which widens its highlight.
    float a = min(1.0, roughness * roughness + 0.06), a2 = a * a;
    float q = nh * nh * (a2 - 1.0) + 1.0;
    float masking = 0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) +
                              nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-3);
    float away = 1.0 - max(dot(h, v), 0.0), away2 = away * away;
    float fresnel = away2 * away2 * away;
    vec3 mirror = (f0 + (1.0 - f0) * fresnel) * (a2 / (q * q) * masking);

    vec3 light = KEY * nl * seen.y * (matt + mirror);
    light += matt * ambient(n) * seen.x;
    vec3 r = reflect(-v, n);
    float seen_mirror = clamp(seen.x * (0.55 + 0.45 * seen.y), 0.0, 1.0);
    light += surroundings(r, roughness) * environment_share(f0, roughness, nv) * seen_mirror;
    float near = 0.0;
    if (endless.w > 0.0) {
        float out_of_action = smoothstep(ground.y, 6.0, length(position));
        float to_its_edge = smoothstep(0.6, 0.98, distance(position, endless.xyz) / endless.w);
        light = mix(light, backdrop(sight(gl_FragCoord.xy), gl_FragCoord.xy),
                    max(out_of_action, to_its_edge));
        near = 1.0 - max(out_of_action, to_its_edge);
    }
    pixel_color = developed(light, gl_FragCoord.xy);
    if (endless.w > 0.0 && ground.w > 0.0) {
        vec3 from_key = KEY * nl, from_rest = ambient(n);
        pixel_color =
            caught((from_key * seen.y + from_rest * seen.x) / (from_key + from_rest), near);
    }
}
