// SPDX-License-Identifier: GPL-3.0-or-later
// The unit normal on the side that is looked at. A body cut open shows its inside, so both sides
// count; where a mesh gives no normal, the triangle's own is taken.
vec3 facing_normal(vec3 given, vec3 position, vec3 eye_position) {
    vec3 face = cross(dFdx(position), dFdy(position));
    float length2 = dot(given, given);
    vec3 n = length2 > 1e-12 ? given * inversesqrt(length2)
                             : face * inversesqrt(max(dot(face, face), 1e-30));
    if (length2 > 1e-12 ? !gl_FrontFacing : dot(n, eye_position - position) < 0.0) n = -n;
    return n;
}
