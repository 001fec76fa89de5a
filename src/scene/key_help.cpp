// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/key_help.h"

namespace swage {

namespace {

constexpr KeyHelp kSceneKeys[] = {
    {"[mesh]", "file", "the mesh to machine; a path relative to the scene"},
    {"[mesh]", "length", "scale the longest side to this; left out: the file's numbers are metres"},
    {"[mesh]", "at", "position of the middle of its box; left out: as in the file"},
    {"[mesh]", "turn",
     "rotation about the middle of its box: a vector along the axis, as long as the angle"},
    {"[mesh]", "velocity", "initial velocity"},
    {"[mesh]", "spin", "initial spin about its centre of mass"},
    {"[mesh]", "color", "red, green, blue in place of the file's colour",
     "[red, green, blue], each 0 to 1"},
    {"[mesh]", "texture",
     "picture in place of the file's colours, where the mesh has texture coordinates; a path "
     "relative to the scene",
     "name of a PNG, JPEG, BMP or TGA file", "-"},
    {"[mesh]", "cut_color",
     "colour of faces that cuts and breaks lay open; left out: as what covers most of the mesh, "
     "paler, and pale under a texture",
     "[red, green, blue], each 0 to 1"},
    {"[mesh]",
     "finish",
     "finish of that color or texture; left out: as rough and clear as the material's look, if "
     "that is "
     "not metal",
     {},
     "-"},
    {"[mesh]", "look",
     "file: as in the mesh file or, where it says nothing, as the material; material: as the "
     "material's look"},

    {"[material]",
     "name",
     "a material from assets/materials.toml or from materials.toml beside the scene",
     {},
     "-"},
    {"[material]", "mechanics",
     "cells: right for any Poisson's ratio; springs: only the connections of the papers"},
    {"[material]", "elasticity",
     "hencky: can yield and break, and is what yields; neo-hookean: rubber; storakers: foam"},
    {"[material]", "young_modulus", "required without a name", {}, "-"},
    {"[material]", "poisson_ratio", "springs always have 0.25"},
    {"[material]", "density", "required without a name", {}, "-"},
    {"[material]", "yield_stress", "stress at which plastic flow begins (von Mises)",
     "stress, more than 0 Pa, or inf", "inf"},
    {"[material]", "hardening", "increase of the yield stress per unit of plastic strain"},
    {"[material]", "flow_curve",
     "in place of yield_stress and hardening: true stress over plastic (logarithmic) strain, "
     "linear between points and constant after the last; or K (e0 + e)^n, A + B e^n, s0 + Q (1 "
     "- exp(-b e))",
     "[[0, stress], [strain, stress], ...], {K, e0, n}, {A, B, n} or {s0, Q, b}"},
    {"[material]", "back_stress",
     "part of the flow stress that follows the direction of flow, so that reversed flow begins "
     "early (kinematic hardening, Bauschinger effect): its limit, C / gamma of Armstrong and "
     "Frederick or Chaboche; flow in one direction still follows yield_stress, hardening or "
     "flow_curve"},
    {"[material]",
     "back_strain",
     "plastic strain over which back_stress builds up, 1 / gamma; requires back_stress",
     {},
     "-"},
    {"[material]", "strength", "stress at which a pulled bar breaks; requires toughness",
     "stress, more than 0 Pa and less than a tenth of young_modulus, or inf", "inf"},
    {"[material]", "toughness", "energy per area of a new crack, for both faces together"},
    {"[material]", "damping_ratio",
     "damping ratio of every vibration; in motion only, not implicit"},
    {"[material]", "friction",
     "Coulomb coefficient while sliding; between bodies the mean of both; on a tool the tool's "
     "own, if it has one"},
    {"[material]",
     "static_friction",
     "coefficient before sliding begins, at least friction; in motion only",
     {},
     "friction"},
    {"[material]", "restitution",
     "speed after over speed before an impact; in motion only, not implicit"},
    {"[material]", "stickiness", "tension that a contact can hold; in motion only, not implicit"},

    {"[material]", "look",
     "look of meshes without one in their file or [mesh]: color as on a screen (for metal, "
     "what it reflects), roughness, metalness, and how much light passes through; known "
     "materials have one",
     "{color = [red, green, blue], roughness, metalness, clear}, all 0 to 1", "-"},

    {"[[inset]]", "file",
     "a mesh inside which the matter has another material, given by the keys of [material]"},
    {"[[inset]]", "from",
     "in place of file: a corner of a box, in fractions of the work-piece's box",
     "[x, y, z], each 0 to 1"},
    {"[[inset]]", "to", "the opposite corner", "[x, y, z], each 0 to 1"},
    {"[[inset]]", "color",
     "colour of it in faces that a blade cuts; left out: as its material looks, darker if that is "
     "as the body's cut faces are",
     "[red, green, blue], each 0 to 1"},
    {"[[inset]]", "look", "look of it in faces that a blade cuts",
     "{color = [red, green, blue], roughness, metalness, clear}, all 0 to 1", "-"},

    {"[mold]", "kind", "fill the shape of the mesh, or all of its box"},
    {"[mold]", "across", "number of cells across the thinnest side of the box"},
    {"[mold]", "spacing", "in place of across: the side of a cell"},
    {"[mold]", "cell_limit", "refuse more cells in the box than this"},

    {"[[body]]", "name", "used in file names", {}, "body-2, body-3, ..."},
    {"[[body]]", "file", "the mesh of the body; a path relative to the scene"},
    {"[[body]]", "material", "left out: the work-piece's material",
     "name, or a section [body.material]"},
    {"[[body]]", "across", "left out, along with spacing: as for the work-piece", {}, "-"},

    {"[[probe]]", "name", "letters, digits and _; names its columns in curves/*.csv"},
    {"[[probe]]", "at",
     "the point of the matter to follow, in fractions of its body's box along the axes of the "
     "mesh file",
     "[x, y, z], each 0 to 1", "-"},
    {"[[probe]]", "fields",
     "fields of the matter there, as [output] has them for skins: columns in curves/*.csv beside "
     "the place"},
    {"[[probe]]", "body", "name of a [[body]]", {}, "work-piece"},

    {"[skin]", "kind",
     "mount: smooth, follows half frames; frame4: follows the paper's frames of four "
     "particles; boundary: drawn around the matter's voxels, and anew when it breaks"},
    {"[skin]", "divide",
     "halve mesh edges longer than this many cells, so that faces can bend (less where matter "
     "flows "
     "far); false: keep the mesh's own vertices only; not for kind = \"boundary\""},
    {"[skin]", "crease_angle",
     "angle between faces beyond which an edge is sharp, where the file has neither normals "
     "nor smoothing groups; 180 deg: no sharp edges; not for kind = \"boundary\"",
     "angle, 0 deg to 180 deg"},
    {"[skin]", "roughness",
     "roughness of faces where matter broke under load: distance in cells from the planes "
     "between particles; 0: on these planes"},

    {"[[stage]]", "machine",
     "one from `swage machines`, or a file of your own; its parameters are also keys of the "
     "stage",
     "name, or path relative to the scene"},
    {"[[stage]]", "name", "used in file names", {}, "number-machine"},
    {"[[stage]]", "frames",
     "frames recorded, one still each; there are at least as many equilibria"},
    {"[[stage]]", "duration", "duration of the machine's motion", {}, "frames / fps"},
    {"[[stage]]", "remold", "mold the deformed mesh anew, with its insets, before this stage"},
    {"[[stage]]", "axis",
     "world axis of the machine's length; auto: the longest side of the box, or the longest "
     "one across up for upright machines"},
    {"[[stage]]", "up",
     "world direction that is up for the machine; auto: y, or z where axis is y and the "
     "machine is not upright"},
    {"[[stage]]",
     "solver",
     "how the matter moves; see the README",
     {},
     "explicit where bodies move by themselves, else quasistatic"},
    {"[[stage]]", "tolerance", "unbalanced force over the largest force; quasistatic"},
    {"[[stage]]", "iteration_limit",
     "iterations after which the increment is halved, and up to ten times as many while the body "
     "still goes far or settles; quasistatic"},
    {"[[stage]]", "halving_limit",
     "times that an increment of the machine may be halved; quasistatic"},
    {"[[stage]]", "contact_stiffness", "stiffness of contact over that of a layer of cells",
     "number, 0.01 to 100 in explicit steps, else 0.5 to 100", "2, or a tool's own in equilibria"},
    {"[[stage]]", "grip_stiffness", "the same for grips"},
    {"[[stage]]", "step_safety", "fraction of the longest stable step; not implicit"},
    {"[[stage]]", "retry_limit",
     "times that a failed step may be halved; in motion only, not energy-stepped"},
    {"[[stage]]",
     "self_contact",
     "a body can touch itself, and its pieces each other; not implicit",
     {},
     "true in motion where a blade cuts, or has before; else false"},
    {"[[stage]]", "sleep",
     "bodies that have come to rest take no computing time; not energy-stepped"},
    {"[[stage]]", "medium_density",
     "density of the surrounding medium, for drag: air 1.2, water 1000 kg/m3"},
    {"[[stage]]", "drag_coefficient",
     "drag coefficient on a quarter of the whole surface, in any direction of motion: ball "
     "0.5, cube 0.7"},
    {"[[stage]]", "directional_drag",
     "drag on the surface that faces the flow: weight over area times terminal speed"},
    {"[[stage]]", "directional_drag_along",
     "act against the motion, or along the surface's normal"},
    {"[[stage]]", "gravity",
     "one number points down: against y, or against up with upright machines; three numbers "
     "are along the world's axes",
     "acceleration, or [x, y, z] of them", "0"},
    {"[[stage]]", "load", "forces and pressures on the surface"},
    {"[[stage]]", "limit", "force or torque of a tool or grip at which the machine stops"},
    {"[[stage]]", "gravity_strength", "factor on gravity over the stage, 0 < t < 1",
     "expression of t", "1"},

    {"[[stage.load]]", "name", "name of the load in curves", "text", "load_1, load_2, ..."},
    {"[[stage.load]]", "force",
     "total force, spread by area, of constant direction; along the machine's x, y, z. `swage "
     "check` shows these in the world's axes, which curves use"},
    {"[[stage.load]]",
     "pressure",
     "in place of force: acts along the inward normal of the deformed surface, all round a "
     "piece, also on faces that a cut or break exposes",
     {},
     "-"},
    {"[[stage.load]]", "on",
     "all of the surface that faces this side (right, top, front: the machine's x, y, z), "
     "including walls of holes; inside: the walls of closed cavities; `swage check` shows where "
     "that is"},
    {"[[stage.load]]", "from",
     "a corner of the box that the surface must lie in, from the middle of the work-piece's "
     "box, along the machine's axes"},
    {"[[stage.load]]", "to", "the opposite corner"},
    {"[[stage.load]]", "strength", "factor on the load over the stage, 0 < t < 1",
     "expression of t"},

    {"[[stage.limit]]", "part",
     "a tool or grip from `swage machines NAME`; the first limit that is reached stops the "
     "machine"},
    {"[[stage.limit]]",
     "force",
     "magnitude of its force on the matter, as in curves; reached from below to within half a "
     "percent; quasistatic, for machines that can stop (`swage machines NAME`)",
     {},
     "-"},
    {"[[stage.limit]]",
     "torque",
     "in place of force: the torque about its axis of rotation, in either sense, which curves "
     "have as `torque about its axis`; for `bend` the moment at the support",
     {},
     "-"},

    {"[render]", "size", "size of the stills", "[width, height], whole numbers up to 16384",
     "[1280, 720]"},
    {"[render]", "fps",
     "frames a second of the film; 23.976 is exactly 24000/1001, and so the others"},
    {"[render]", "first_frame",
     "number of the first still, the start, in the names of stills, passes and meshes of every "
     "frame, as a time code of USD and in --frames; curves, run.json and what is told count "
     "from 1"},
    {"[render]", "film", "write film.mp4 too"},
    {"[render]", "tools", "draw tools, grips and blades"},
    {"[render]", "hide",
     "tools, grips and blades that are not drawn, by their names; of repeated ones NAME hides all, "
     "NAME_2 the second"},
    {"[render]", "ground", "draw a ground under everything; false also hides an endless floor"},
    {"[render]", "legend", "draw a scale for color on the stills"},
    {"[render]", "background",
     "transparent: stills with alpha (straight, for compositing in sRGB), with only the "
     "shadows of the ground, and no film"},
    {"[render]", "passes",
     "files beside each still, for compositing, without blending at edges: depth (EXR, metres "
     "along the view), matte (PNG, a colour for each body, tool and the ground, which "
     "mattes.json names), normal (EXR, along the world's axes), motion (EXR, pixels to the "
     "next still, forward, and the one before, backward; y up), piece (PNG, as matte, a colour "
     "for "
     "each piece of a body, which pieces.json names); and antialiased as the still is, beauty "
     "(EXR, its light before the tone curve, premultiplied)"},
    {"[render]", "gl", "graphics library"},
    {"[render]",
     "color",
     "colour bodies by a field of their matter, with a scale; the run then records it as for "
     "[output] fields; left out: their own look",
     {},
     "-"},
    {"[render]", "color_range",
     "ends of the scale; left out: from 0 (for signed fields, the smallest value) to the "
     "largest value of all frames; an arrow marks an end beyond which values lie"},
    {"[render]", "field_of_view", "vertical field of view"},
    {"[render]", "up",
     "axis that points upward in pictures; auto: against gravity if all stages with gravity "
     "agree, else y"},
    {"[render]", "camera", "position of the camera"},
    {"[render]", "light", "direction of the light", "section"},

    {"[render.camera]", "azimuth",
     "about the upward axis; y up: from z toward x, z up: from x toward y; auto: 34.4 deg, or "
     "another side from which tools hide much less of the bodies",
     "angle [rad] or auto", "auto"},
    {"[render.camera]", "elevation",
     "above the horizon; auto: 20.1 deg, or lower if tools then hide much less of the bodies",
     "angle, -90 deg to 90 deg, or auto", "auto"},
    {"[render.camera]", "zoom", "1 frames the bodies throughout their motion"},
    {"[render.camera]", "eye", "with target, in place of azimuth, elevation and zoom"},
    {"[render.camera]", "target",
     "point to look at, from the eye or, without one, from azimuth, elevation and zoom"},
    {"[render.camera]", "orbit",
     "angle by which azimuth turns over the film; whole turns keep a constant pace and end one "
     "step short of the first still"},
    {"[render.camera]", "follow",
     "go along with the bodies, whose largest extent zoom = 1 frames then; not with a target"},
    {"[render.camera]", "keys", "in place of the above but follow: the same keys at several times"},
    {"[[render.camera.keys]]", "at", "fraction of the film", {}, "-"},
    {"[[render.camera.keys]]", "azimuth", "as in [render.camera]"},
    {"[[render.camera.keys]]", "elevation", "as in [render.camera]", "angle, -90 deg to 90 deg"},

    {"[render.light]",
     "azimuth",
     "direction of the lamp that casts the shadows, about the upward axis from the film's "
     "first view toward its right; the other lamps turn with it",
     {},
     "-45.8 deg"},
    {"[render.light]", "elevation", "elevation of that lamp above the horizon",
     "angle, 5 deg to 90 deg", "51.6 deg"},

    {"[output]", "meshes_per_frame", "write the skin of every frame"},
    {"[output]", "fields",
     "fields of the matter at each vertex of the skin: in meshes/*.ply as properties of these "
     "names (OBJ cannot hold them), in `swage export`, and for `swage render --color`; "
     "stresses in Pa"},
    {"[output]", "keep_stages",
     "keep how each stage ends, so that `swage run --go-on` works only those stages anew that "
     "were changed"},
};

constexpr KeyHelp kMachineKeys[] = {
    {"top of the file", "help", "text that `swage machines` shows"},
    {"top of the file", "moves", "for bodies in motion: stages without a solver are explicit"},
    {"top of the file", "upright",
     "the work-piece lies on it: gravity given as one number points against up"},
    {"top of the file", "axis", "as in [[stage]], which overrides it"},
    {"top of the file", "up", "as in [[stage]], which overrides it"},
    {"top of the file", "parameter",
     "sections [parameter.NAME]; NAME becomes a key of stages and a variable in expressions"},
    {"top of the file", "tool", "bodies that push"},
    {"top of the file", "grip", "parts of the surface that are held"},
    {"top of the file", "blade", "surfaces that cut"},
    {"top of the file", "load", "the keys of [[stage.load]]; name is required"},
    {"top of the file", "check", "conditions that should hold"},

    {"[parameter.NAME]", "quantity", "kind of quantity", {}, "-"},
    {"[parameter.NAME]", "default", "may use the parameters above it", {}, "-"},
    {"[parameter.NAME]", "low", "lowest value allowed", {}, "-"},
    {"[parameter.NAME]", "high", "highest value allowed", {}, "-"},
    {"[parameter.NAME]", "help", "text that `swage machines` shows"},

    {"[[tool]]", "name",
     "letters, digits and _; expressions can use its middle as NAME_x, NAME_y, NAME_z"},
    {"[[tool]]", "repeat",
     "how many of it there are, called NAME_1, NAME_2, ..., 0 to 100; its expressions can use "
     "number. May use parameters that do not depend on the work-piece; left out: one, NAME"},
    {"[[tool]]", "shape", "mesh: any closed mesh", {}, "-"},
    {"[[tool]]", "radius", "radius of a cylinder or sphere", {}, "-"},
    {"[[tool]]",
     "length",
     "length of a cylinder along its axis, or of a mesh along its longest side",
     {},
     "-"},
    {"[[tool]]", "size", "size of a box", {}, "-"},
    {"[[tool]]", "hole", "radius of a hole through a cylinder, along its axis; 0: none"},
    {"[[tool]]", "rounding", "radius of the edges of a box or cylinder, and of its hole's"},
    {"[[tool]]", "file", "mesh file; a path relative to the machine file"},
    {"[[tool]]", "axis", "direction of the shape's z axis"},
    {"[[tool]]", "turn", "rotation about that axis"},
    {"[[tool]]", "at", "its middle, relative to the middle of the work-piece's box", {}, "-"},
    {"[[tool]]",
     "touch",
     "direction in which it slides in from far outside until it touches the work-piece",
     {},
     "-"},
    {"[[tool]]", "gap", "distance that touch leaves"},
    {"[[tool]]", "friction", "left out: that of the body that touches it"},
    {"[[tool]]", "contact_stiffness", "used in equilibria if the stage does not give it", {}, "2"},
    {"[[tool]]", "color", "red, green, blue", "[red, green, blue], each 0 to 1"},
    {"[[tool]]", "finish",
     "endless: matt and fading into the backdrop, in its color; the backdrop's is [0.748, "
     "0.755, 0.764]"},
    {"[[tool]]", "motion", "a section [tool.motion]", "section"},

    {"[tool.motion]", "move",
     "displacement from the start; may use t, 0 to 1 over the stage, and stop"},
    {"[tool.motion]", "turn", "angle of rotation; may use t and stop"},
    {"[tool.motion]", "axis", "axis of rotation", {}, "[0, 0, 1]"},
    {"[tool.motion]",
     "pivot",
     "fixed point of the rotation; may use t and stop; left out: the middle of the "
     "work-piece's box, not the tool's",
     {},
     "[0, 0, 0]"},

    {"[[grip]]", "name", "letters, digits and _"},
    {"[[grip]]", "repeat", "as in [[tool]]"},
    {"[[grip]]", "from", "a corner of a box; the surface in it is held", {}, "-"},
    {"[[grip]]", "to", "the opposite corner", {}, "-"},
    {"[[grip]]",
     "along",
     "axes along which it holds: xyz clamps, y acts as a smooth plane; grips that hold along "
     "different axes, without turning, may share what they hold, as planes of symmetry do",
     {},
     "\"xyz\""},
    {"[[grip]]", "drawn", "false: no clamp is drawn around what it holds"},
    {"[[grip]]", "motion", "a section [grip.motion]: the keys of [tool.motion]", "section"},

    {"[[blade]]", "name", "letters, digits and _"},
    {"[[blade]]", "repeat", "as in [[tool]]"},
    {"[[blade]]", "edge",
     "where the edge starts: its points, or a single one, a curve, that changes with `along`"},
    {"[[blade]]", "points", "how many points stand for such a curve"},
    {"[[blade]]", "thickness", "thickness in pictures"},
    {"[[blade]]", "motion", "a section [blade.motion]: the keys of [tool.motion]", "section"},

    {"[[check]]", "holds", "a condition; may use everything but t", {}, "-"},
    {"[[check]]", "otherwise", "message to the user if it does not hold"},
};

}  // namespace

std::span<const KeyHelp> scene_key_help() { return kSceneKeys; }
std::span<const KeyHelp> machine_key_help() { return kMachineKeys; }

}  // namespace swage
