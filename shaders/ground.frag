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
    vec3 share = (KEY * max(key.y, 0.0) * seen.y + ambient(up) * seen.x) / open_light();
    float near = 1.0 - smoothstep(ground.y, ground.z, length(position.xz));
    vec3 floor_light = paper_floor(position, gl_FragCoord.xy, share, near, ground.z);
    pixel_color = ground.w > 0.0
                      ? caught(paper_floor(position, gl_FragCoord.xy, vec3(1.0), near, ground.z),
                               floor_light)
                      : developed(floor_light, gl_FragCoord.xy);
}
