// SPDX-License-Identifier: GPL-3.0-or-later
// The studio: a key light that casts the shadow, and around it soft boxes, sky and floor, as
// functions of direction. Light is linear; 1 is white before the film curve.
const vec3 KEY = vec3(0.84, 0.81, 0.765);   // what a white matt surface returns, facing it
const vec3 SKY = vec3(0.27, 0.285, 0.31);
const vec3 FLOOR = vec3(0.13, 0.125, 0.12);
const vec3 FILL = vec3(0.11, 0.12, 0.14);
const vec3 RIM = vec3(0.20, 0.20, 0.21);

// What a white matt surface returns of everything but the key light.
vec3 ambient(vec3 n) {
    vec3 light = mix(FLOOR, SKY, 0.5 + 0.5 * n.y);
    float f = max(0.0, 0.4 + 0.6 * dot(n, fill.xyz));
    float r = max(0.0, 0.2 + 0.8 * dot(n, rim.xyz));
    return light + FILL * f * f + RIM * r * r;
}

// A lamp with a soft edge, seen along `direction`; `blur` widens the edge.
float soft_box(vec3 direction, vec3 towards, float cosine, float blur) {
    float b = 0.03 + 0.55 * blur;
    return smoothstep(cosine - b, cosine + b, dot(direction, towards)) / (1.0 + 2.5 * blur);
}

// What a mirror of the given roughness sees.
vec3 surroundings(vec3 direction, float roughness) {
    float blur = roughness * roughness;
    float horizon = smoothstep(-0.12 - 0.6 * blur, 0.10 + 0.6 * blur, direction.y);
    vec3 wall = mix(vec3(0.20, 0.205, 0.215), vec3(0.62, 0.64, 0.67),
                    smoothstep(0.0, 0.95, direction.y));
    vec3 light = mix(vec3(0.42, 0.415, 0.405), wall, horizon);
    light += 2.6 * KEY * soft_box(direction, key.xyz, 0.90, blur);
    light += 1.5 * soft_box(direction, rim.xyz, 0.86, blur) * vec3(0.95, 0.98, 1.0);
    light += 0.8 * soft_box(direction, fill.xyz, 0.80, blur) * vec3(0.95, 0.98, 1.0);
    return light;
}

// Where nothing is behind, the ground is as black and as dense as what it keeps of the light:
// premultiplied, as all of a picture is until it is read back.
vec4 caught(vec3 share, float near) {
    return vec4(0.0, 0.0, 0.0, near * (1.0 - min(dot(share, vec3(1.0 / 3.0)), 1.0)));
}

// The backdrop: one seamless sweep of paper from floor to wall, darker to the corners.
vec3 backdrop(vec3 direction, vec2 pixel) {
    float height = smoothstep(-0.75, 0.35, direction.y);
    vec3 paper = mix(vec3(0.52, 0.53, 0.545), vec3(0.30, 0.325, 0.36), height);
    vec2 p = (2.0 * pixel * size.zw - 1.0) * vec2(0.75, 0.65);
    return paper * (1.0 - 0.30 * dot(p, p));
}
