// SPDX-License-Identifier: GPL-3.0-or-later
// What passes for compositing are made of: a normal, folded to two numbers, a depth and whose it is.
vec4 layer_of(vec3 normal, float depth, float number) {
    vec3 n = normal / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    vec2 side = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    vec2 folded = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * side;
    return vec4(folded, depth, number);
}
