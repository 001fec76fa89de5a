#version 330 core
// SPDX-License-Identifier: GPL-3.0-or-later
// The floor takes the backdrop's own colour, dimmed where light is kept from it, so that no edge
// shows where it ends.
#include "frame.glsl"
#include "light.glsl"
#include "film.glsl"
#include "upsample.glsl"
in vec3 position;
layout(location = 0) out vec4 pixel_color;

void main() {
    vec3 up = vec3(0.0, 1.0, 0.0);
    float depth = -(view_from_stage * vec4(position, 1.0)).z;
    vec2 seen = visibility_at(gl_FragCoord.xy, depth, up);
    vec3 from_key = KEY * max(key.y, 0.0), from_rest = ambient(up);
    vec3 share = (from_key * seen.y + from_rest * seen.x) / (from_key + from_rest);
    float distance2 = dot(position.xz, position.xz);
    float near = 1.0 - smoothstep(ground.y, ground.z, sqrt(distance2));
    vec3 light = backdrop(sight(gl_FragCoord.xy), gl_FragCoord.xy);
    light *= mix(vec3(1.0), share, near);
    light *= 1.0 + 0.22 * exp(-0.30 * distance2) * near;
    pixel_color = ground.w > 0.0 ? caught(share, near) : developed(light, gl_FragCoord.xy);
}
