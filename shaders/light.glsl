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

const vec3 PAPER = vec3(0.52, 0.53, 0.545);

// The backdrop: one seamless sweep of paper from floor to wall, darker to the corners.
vec3 backdrop(vec3 direction, vec2 pixel) {
    float height = smoothstep(-0.75, 0.35, direction.y);
    vec3 paper = mix(PAPER, vec3(0.30, 0.325, 0.36), height);
    vec2 p = (2.0 * pixel * size.zw - 1.0) * vec2(0.75, 0.65);
    return paper * (1.0 - 0.30 * dot(p, p));
}

// How much of a lobe about `direction` a lamp's rectangle fills. The lobe's slopes are spread as
// those of Trowbridge and Reitz (GGX), whose share along one axis lies under x / sqrt(x^2 + s^2);
// `spread2` is s^2. What a lamp sends in all stays the same at any spread.
float soft_box(vec3 direction, vec3 towards, vec2 half_size, float spread2) {
    vec3 level = vec3(towards.z, 0.0, -towards.x);
    float length2 = dot(level, level);
    level = length2 > 1e-8 ? level * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
    float along = dot(direction, towards);
    float ahead = 0.5 * (along + sqrt(along * along + 0.25 * spread2 + 1e-3));
    vec2 at = vec2(dot(direction, level), dot(direction, cross(towards, level))) / ahead;
    vec2 low = at - half_size, high = at + half_size;
    vec2 filled = high * inversesqrt(high * high + spread2) - low * inversesqrt(low * low + spread2);
    return 0.25 * filled.x * filled.y * min(1.0 + along, 1.0);  // nothing right behind
}

// Half sizes of the lamps at distance 1, and their brightness: pi over the area is that of what a
// matt surface returns.
const vec2 KEY_BOX = vec2(0.50, 0.40), FILL_BOX = vec2(0.25, 0.60), RIM_BOX = vec2(0.70, 0.20);
const vec2 CARD = vec2(0.22, 0.70);
const float ROOM = 3.0;  // distance of the walls [stage]

float spread2_of(float roughness) {
    float s = 2.0 * roughness * roughness;  // a mirror turned by an angle turns its ray by twice
    return s * s + 1e-3;
}

// The direction in which a ray from `position` meets the room's wall, seen from its middle: what
// stands at some distance is seen elsewhere from each place, which gives flat faces a gradient
// (S. Lagarde and A. Zanuttini, "Local Image-based Lighting with Parallax-corrected Cubemaps",
// SIGGRAPH talks 2012).
vec3 on_wall(vec3 position, vec3 ray) {
    float along = dot(position, ray);
    float far = sqrt(max(along * along - dot(position, position) + ROOM * ROOM, 0.25)) - along;
    return normalize(position + far * ray);
}

vec3 key_mirrored(vec3 wall, float spread2) {
    return KEY * (PI / (4.0 * KEY_BOX.x * KEY_BOX.y)) * soft_box(wall, key.xyz, KEY_BOX, spread2);
}

// What a mirror at `position` sees of the rest: the sweep of paper behind, a dark room in front, a
// floor that is light about the middle, and two lamps.
vec3 surroundings(vec3 position, vec3 ray, vec3 wall, float spread2) {
    float spread = sqrt(spread2);
    float front = wall.x * key.w + wall.z * fill.w;
    float dark = smoothstep(-0.5 - spread, 0.6 + spread, front);
    vec3 paper = mix(vec3(0.50, 0.51, 0.525), vec3(0.20, 0.22, 0.25),
                     smoothstep(-0.3 - spread, 0.8 + spread, wall.y));
    vec3 light = paper * (1.0 - 0.85 * dark);
    float down = max(-ray.y, 0.02);
    vec3 meets = position + ray * (max(position.y - ground.x, 0.0) / down);
    float away = length(meets.xz);
    vec3 floor_light = mix(vec3(0.60, 0.595, 0.58), vec3(0.13, 0.135, 0.14),
                           smoothstep(0.3 - spread, 3.6 + 2.0 * spread, away));
    light = mix(floor_light, light, smoothstep(-0.08 - spread, 0.04 + spread, ray.y));
    // A white card left of the camera, which lights nothing: a streak along what is round.
    vec3 card = vec3(0.9 * key.w - 0.436 * fill.w, 0.0, 0.9 * fill.w + 0.436 * key.w);
    light += 1.1 * soft_box(wall, card, CARD, spread2);
    light += FILL * (PI / (4.0 * FILL_BOX.x * FILL_BOX.y)) *
             soft_box(wall, fill.xyz, FILL_BOX, spread2);
    light += RIM * (PI / (4.0 * RIM_BOX.x * RIM_BOX.y)) *
             soft_box(wall, rim.xyz, RIM_BOX, spread2);
    return light;
}

// The backdrop where it lies as a floor, with `share` of its light, lighter about the middle. One
// that is less `wide` than the action would be a light disc in it.
vec3 paper_floor(vec3 position, vec2 pixel, vec3 share, float near, float wide) {
    vec3 light = backdrop(sight(pixel), pixel) * mix(vec3(1.0), share, near);
    float lighter = 0.22 * smoothstep(0.0, 1.0, wide);
    return light * (1.0 + lighter * exp(-0.30 * dot(position.xz, position.xz)) * near);
}

// What a level floor has of light that nothing keeps from it.
vec3 open_light() { return KEY * max(key.y, 0.0) + ambient(vec3(0.0, 1.0, 0.0)); }
