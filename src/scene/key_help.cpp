// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/key_help.h"

namespace swage {

const std::vector<KeyHelp>& scene_key_help() {
    static const std::vector<KeyHelp> all = {
        {"[mesh]", "file", "the mesh to be worked on, relative to the scene"},
        {"[mesh]", "length", "what its longest side becomes; left out: the file's numbers are m"},
        {"[mesh]", "at", "where the middle of its box is put; left out: where the file has it"},
        {"[mesh]", "turn", "about the middle of its box: the axis, as long as the angle"},
        {"[mesh]", "velocity", "at the start"},
        {"[mesh]", "spin", "at the start, about its centre of mass"},
        {"[mesh]", "color", "red, green, blue instead of what its file says",
         "[red, green, blue], each 0 to 1"},
        {"[mesh]",
         "finish",
         "of that color; left out: as matt or clear as the material looks, where it is no metal",
         {},
         "-"},
        {"[mesh]", "look",
         "file: as the mesh's file says, and where it says nothing as the material does; material: "
         "as the material's look has it"},

        {"[material]",
         "name",
         "one of assets/materials.toml or of materials.toml beside the scene",
         {},
         "-"},
        {"[material]", "mechanics",
         "cells are right for any Poisson's ratio; springs are the "
         "papers' connections alone"},
        {"[material]", "elasticity",
         "hencky: what may yield and break; neo-hookean: rubber; storakers: foam"},
        {"[material]", "young_modulus", "needed without a name", {}, "-"},
        {"[material]", "poisson_ratio", "springs have 0.25 whatever it says"},
        {"[material]", "density", "needed without a name", {}, "-"},
        {"[material]", "yield_stress", "where it begins to flow (von Mises)",
         "stress, more than 0 Pa, or inf", "inf"},
        {"[material]", "hardening", "rise of the yield stress per plastic strain"},
        {"[material]", "flow_curve",
         "instead of yield_stress and hardening: true stress over plastic (logarithmic) strain, "
         "straight from point to point and flat behind the last; or as K (e0 + e)^n, A + B e^n, "
         "s0 + Q (1 - exp(-b e))",
         "[[0, stress], [strain, stress], ...], {K, e0, n}, {A, B, n} or {s0, Q, b}"},
        {"[material]", "back_stress",
         "of the stress at which it flows, the part that has the sense of the flow, so that flow "
         "back sets in early (kinematic hardening, Bauschinger's effect): what it grows to, C / "
         "gamma of Armstrong and Frederick or Chaboche; a pull that goes on bears what "
         "yield_stress, hardening or flow_curve say as before"},
        {"[material]",
         "back_strain",
         "the plastic strain over which back_stress grows, 1 / gamma; goes with it",
         {},
         "-"},
        {"[material]", "strength", "stress at which a pulled bar breaks; goes with toughness",
         "stress, more than 0 Pa and less than a tenth of young_modulus, or inf", "inf"},
        {"[material]", "toughness", "energy of a new crack, both its faces together"},
        {"[material]", "damping_ratio", "of every swing; explicit and energy-chosen steps only"},
        {"[material]", "friction",
         "Coulomb's, sliding; between bodies the mean of both; on a tool its own where it has one"},
        {"[material]",
         "static_friction",
         "before it slides, at least friction; motion only",
         {},
         "friction"},
        {"[material]", "restitution",
         "speed after over speed before a meeting; explicit and "
         "energy-chosen steps only"},
        {"[material]", "stickiness",
         "tension that a contact holds; explicit and energy-chosen "
         "steps only"},

        {"[material]", "look",
         "of meshes whose file or [mesh] says none: color as on a screen (of metal what it "
         "reflects), roughness, metalness, and how much light goes through; a known material has "
         "one",
         "{color = [red, green, blue], roughness, metalness, clear}, all 0 to 1", "-"},

        {"[[inset]]", "file",
         "a mesh inside which the matter is of another material; the keys of "
         "[material] say which"},
        {"[[inset]]", "from", "instead of file: a corner of a box, in shares of the work-piece's",
         "[x, y, z], each 0 to 1"},
        {"[[inset]]", "to", "the opposite corner", "[x, y, z], each 0 to 1"},

        {"[mold]", "kind", "fill the mesh's shape, or the whole of its box"},
        {"[mold]", "across", "cells over the thinnest side of the box"},
        {"[mold]", "spacing", "instead of across: the side of a cell"},
        {"[mold]", "cell_limit", "more cells in the box than this are refused"},

        {"[[body]]", "name", "of its files", {}, "body-2, body-3, ..."},
        {"[[body]]", "file", "the mesh of the body, relative to the scene"},
        {"[[body]]", "material", "left out: that of the work-piece",
         "name, or a section [body.material]"},
        {"[[body]]", "across", "left out, like spacing: as the work-piece has it", {}, "-"},

        {"[[probe]]", "name", "letters, digits and _; of its columns in curves/*.csv"},
        {"[[probe]]", "at",
         "a place of the matter that is followed, in shares of its body's box; along the axes of "
         "the mesh's file",
         "[x, y, z], each 0 to 1", "-"},
        {"[[probe]]", "body", "the name of a [[body]]", {}, "work-piece"},

        {"[skin]", "kind",
         "mount: smooth, follows half frames; frame4: the paper's frames of four "
         "particles; boundary: drawn round the matter's voxels, anew once it breaks"},
        {"[skin]", "divide",
         "halve the edges of the mesh that are longer than a cell and a half, so that its faces "
         "can bend; false: its own vertices and no others; not for kind = \"boundary\""},
        {"[skin]", "crease_angle",
         "between faces, beyond which an edge is sharp where the file has neither normals nor "
         "smoothing groups; 180 deg: none is; not for kind = \"boundary\"",
         "angle, 0 deg to 180 deg"},
        {"[skin]", "roughness",
         "of faces where matter broke by load, in cells: how far off the planes between particles "
         "they lie; 0: on them"},

        {"[[stage]]", "machine",
         "one that `swage machines` lists, or a file of your own; its "
         "parameters are keys of the stage too",
         "name, or path from the scene"},
        {"[[stage]]", "name", "of its files", {}, "number-machine"},
        {"[[stage]]", "frames", "of the film; equilibria are at least as many"},
        {"[[stage]]", "duration", "of the machine's motion", {}, "frames / fps"},
        {"[[stage]]", "remold", "mold the deformed mesh anew before the stage"},
        {"[[stage]]", "axis",
         "of the world, along which the machine has its length; auto: the "
         "longest side of the box, across up if the machine is upright"},
        {"[[stage]]", "up",
         "the way in the world that the machine calls up; auto: y, or, if it is not upright, z "
         "where axis is y"},
        {"[[stage]]",
         "solver",
         "how matter moves; see the README",
         {},
         "explicit where things move by themselves, else quasistatic"},
        {"[[stage]]", "tolerance", "forces out of balance, over the largest force; quasistatic"},
        {"[[stage]]", "iteration_limit", "one more halves the increment; quasistatic"},
        {"[[stage]]", "halving_limit", "of an increment of the machine; quasistatic"},
        {"[[stage]]", "contact_stiffness", "of contact, over that of a layer of cells",
         "number, 0.01 to 100 in explicit steps, else 0.5 to 100",
         "2, or what a tool says where nothing moves"},
        {"[[stage]]", "grip_stiffness", "the same of grips"},
        {"[[stage]]", "step_safety", "share of the longest stable step; not implicit"},
        {"[[stage]]", "retry_limit", "halvings of a step that goes wrong; steps of motion"},
        {"[[stage]]", "self_contact", "a body meets itself; not in implicit steps"},
        {"[[stage]]", "sleep", "bodies that have come to rest cost nothing; not energy-stepped"},
        {"[[stage]]", "medium_density", "of what is around, for drag: air 1.2, water 1000 kg/m3"},
        {"[[stage]]", "drag_coefficient",
         "of a quarter of the whole surface, whichever way it moves: ball 0.5, cube 0.7"},
        {"[[stage]]", "directional_drag",
         "on the surface that meets the flow: weight over area "
         "and speed at the end"},
        {"[[stage]]", "directional_drag_along",
         "against the motion, or along the surface's normal"},
        {"[[stage]]", "gravity",
         "a single number points down: against y, or up with machines that are upright; three are "
         "along the world's axes",
         "acceleration, or [x, y, z] of them", "0"},
        {"[[stage]]", "load", "forces and pressures on the surface"},
        {"[[stage]]", "limit", "what a tool or grip may bear: at it the machine comes no farther"},
        {"[[stage]]", "gravity_strength", "gravity's share over the stage, 0 < t < 1",
         "expression of t", "1"},

        {"[[stage.load]]", "name", "of the load in curves", "text", "load_1, load_2, ..."},
        {"[[stage.load]]", "force",
         "in all, spread by area; keeps its direction; along the machine's x, y, z, which `swage "
         "check` tells in the world's, by which curves are"},
        {"[[stage.load]]",
         "pressure",
         "instead of force: along the inward normal as it deforms; all round a piece, also on what "
         "cuts and breaks lay open",
         {},
         "-"},
        {"[[stage.load]]", "on",
         "all of the surface that looks to this side (right, top, front: the machine's x, y, z), "
         "walls of holes too; `swage check` tells where that is"},
        {"[[stage.load]]", "from",
         "a corner of a box, from the middle of the work-piece's along the machine's axes, that "
         "the surface has to lie in"},
        {"[[stage.load]]", "to", "the opposite corner"},
        {"[[stage.load]]", "strength", "share of the load over the stage, 0 < t < 1",
         "expression of t"},

        {"[[stage.limit]]", "part",
         "whose: `swage machines NAME` lists them; of several limits the first that is reached "
         "stops all"},
        {"[[stage.limit]]",
         "force",
         "the size of the force that it exerts on the matter, as in curves; met from below to half "
         "a percent; quasistatic, with machines that can stop (`swage machines NAME`)",
         {},
         "-"},
        {"[[stage.limit]]",
         "torque",
         "instead of force: that about the axis that it turns about, whichever way, which curves "
         "have as `torque about its axis`; of a `bend` the moment at the support",
         {},
         "-"},

        {"[render]", "size", "of the stills", "[width, height], whole numbers up to 16384",
         "[1280, 720]"},
        {"[render]", "fps",
         "frames a second of the film; 23.976 is exactly 24000/1001, and so the others"},
        {"[render]", "first_frame",
         "number of the first still, the start, in the names of stills, passes and meshes of every "
         "frame, as a time code of USD and in --frames; curves, run.json and what is told count "
         "from 1"},
        {"[render]", "film", "write film.mp4 too"},
        {"[render]", "tools", "draw tools, grips and blades"},
        {"[render]", "ground", "draw a ground under it all; false hides an endless floor too"},
        {"[render]", "legend", "put a scale of what color shows on the stills"},
        {"[render]", "background",
         "transparent: stills have alpha (straight, to be laid over sRGB bytes), of the ground "
         "only "
         "its shadows, and there is no film"},
        {"[render]", "passes",
         "files beside each still, for compositing, without blending at edges: depth (EXR, metres "
         "along the view), matte (PNG, a colour for each body, tool and the ground, which "
         "mattes.json names), normal (EXR, by the world's axes), motion (EXR, pixels to the next "
         "still, forward, and the one before, backward; y up), piece (PNG, as matte, a colour for "
         "each piece of a body, which pieces.json names); and blended as the still is, beauty "
         "(EXR, its light before the tone curve, premultiplied)"},
        {"[render]", "gl", "who draws"},
        {"[render]",
         "color",
         "bodies by a field of their matter, which the run then holds as if [output] fields asked "
         "for it, with a scale; left out, as they look",
         {},
         "-"},
        {"[render]", "color_range",
         "at the ends of the scale; left out, from 0 (of what has a sign, from the least) to the "
         "largest of all frames; an end beyond which anything lies is an arrow"},
        {"[render]", "field_of_view", "of the camera, vertical"},
        {"[render]", "up",
         "what the pictures have upward; auto: against gravity where all stages that have it "
         "agree, "
         "else y"},
        {"[render]", "camera", "where one looks from"},
        {"[render]", "light", "where it comes from", "section"},

        {"[render.camera]", "azimuth",
         "about the upward axis; y up: from z toward x, z up: from x toward y; auto: 34.4 deg, or "
         "another side where tools hide much less of the bodies",
         "angle [rad] or auto", "auto"},
        {"[render.camera]", "elevation",
         "above the horizon; auto: 20.1 deg, or lower where tools hide much less of the bodies",
         "angle, -90 deg to 90 deg, or auto", "auto"},
        {"[render.camera]", "zoom", "1 frames the bodies on all of their way"},
        {"[render.camera]", "eye", "with target, instead of azimuth, elevation and zoom"},
        {"[render.camera]", "target",
         "what is looked at, from the eye or, without one, from azimuth, elevation and zoom"},
        {"[render.camera]", "orbit",
         "by which azimuth turns over the film, at one pace if by whole turns, whose last still is "
         "a step short of the first"},
        {"[render.camera]", "keys", "instead of all that: the same keys at several times"},
        {"[[render.camera.keys]]", "at", "share of the film", {}, "-"},
        {"[[render.camera.keys]]", "azimuth", "as in [render.camera]"},
        {"[[render.camera.keys]]", "elevation", "likewise", "angle, -90 deg to 90 deg"},

        {"[render.light]",
         "azimuth",
         "of the lamp that throws the shadows, about the upward axis from the film's first view "
         "toward its right; the other lamps turn with it",
         {},
         "-45.8 deg"},
        {"[render.light]", "elevation", "of that lamp, above the horizon", "angle, 5 deg to 90 deg",
         "51.6 deg"},

        {"[output]", "meshes_per_frame", "write the skin of every frame"},
        {"[output]", "fields",
         "of the matter, at each vertex of the skin: in meshes/*.ply as properties of these names "
         "(OBJ has no place for them), in `swage export`, and for pictures by `swage render "
         "--color`; stresses in Pa"},
    };
    return all;
}

const std::vector<KeyHelp>& machine_key_help() {
    static const std::vector<KeyHelp> all = {
        {"top of the file", "help", "what `swage machines` tells of it"},
        {"top of the file", "moves",
         "for bodies in motion: stages are explicit when they say no "
         "solver"},
        {"top of the file", "upright",
         "the work-piece lies on it: a gravity that is a single number points against up"},
        {"top of the file", "axis", "as in [[stage]], which may say otherwise"},
        {"top of the file", "up", "as in [[stage]], which may say otherwise"},
        {"top of the file", "parameter",
         "sections [parameter.NAME]; NAME is then a key of stages "
         "and a variable of expressions"},
        {"top of the file", "tool", "what pushes"},
        {"top of the file", "grip", "what holds"},
        {"top of the file", "blade", "what cuts"},
        {"top of the file", "load", "the keys of [[stage.load]], name needed"},
        {"top of the file", "check", "what had better hold"},

        {"[parameter.NAME]", "quantity", "what it is a number of", {}, "-"},
        {"[parameter.NAME]", "default", "may use parameters above", {}, "-"},
        {"[parameter.NAME]", "low", "the least allowed", {}, "-"},
        {"[parameter.NAME]", "high", "the most allowed", {}, "-"},
        {"[parameter.NAME]", "help", "what `swage machines` tells of it"},

        {"[[tool]]", "name", "letters, digits and _; NAME_x, NAME_y, NAME_z are its middle"},
        {"[[tool]]", "shape", "mesh: any closed one", {}, "-"},
        {"[[tool]]", "radius", "of a cylinder or sphere", {}, "-"},
        {"[[tool]]",
         "length",
         "of a cylinder along its axis, of a mesh along its longest side",
         {},
         "-"},
        {"[[tool]]", "size", "of a box", {}, "-"},
        {"[[tool]]", "rounding", "radius of a box's edges"},
        {"[[tool]]", "file", "of a mesh, relative to the machine file"},
        {"[[tool]]", "axis", "where the shape's z axis points"},
        {"[[tool]]", "turn", "about that axis"},
        {"[[tool]]", "at", "its middle, from the middle of the work-piece's box", {}, "-"},
        {"[[tool]]", "touch", "the way it is slid, from far outside, until it touches", {}, "-"},
        {"[[tool]]", "gap", "that touch leaves"},
        {"[[tool]]", "friction", "left out: that of what touches it"},
        {"[[tool]]",
         "contact_stiffness",
         "where nothing moves and the stage does not say",
         {},
         "2"},
        {"[[tool]]", "color", "red, green, blue", "[red, green, blue], each 0 to 1"},
        {"[[tool]]", "finish",
         "endless: matt, and fades out into the backdrop; in its color, of which [0.748, 0.755, "
         "0.764] is the backdrop's own"},
        {"[[tool]]", "motion", "a section [tool.motion]", "section"},

        {"[tool.motion]", "move",
         "from where it stood; may use t, 0 to 1 over the stage, and stop"},
        {"[tool.motion]", "turn", "an angle; may use t and stop"},
        {"[tool.motion]", "axis", "of the turn", {}, "[0, 0, 1]"},
        {"[tool.motion]",
         "pivot",
         "that the turn leaves where it is; may use t and stop; left out, the middle of the "
         "work-piece's "
         "box, not the tool's",
         {},
         "[0, 0, 0]"},

        {"[[grip]]", "name", "letters, digits and _"},
        {"[[grip]]", "from", "a corner of a box; surface in it is held", {}, "-"},
        {"[[grip]]", "to", "the opposite corner", {}, "-"},
        {"[[grip]]",
         "along",
         "axes along which it holds: xyz clamps, y is a smooth plane",
         {},
         "\"xyz\""},
        {"[[grip]]", "motion", "a section [grip.motion]: the keys of [tool.motion]", "section"},

        {"[[blade]]", "name", "letters, digits and _"},
        {"[[blade]]", "edge", "where it starts"},
        {"[[blade]]", "thickness", "of what is drawn"},
        {"[[blade]]", "motion", "a section [blade.motion]: the keys of [tool.motion]", "section"},

        {"[[check]]", "holds", "a condition; may use all but t", {}, "-"},
        {"[[check]]", "otherwise", "what the user is told where it does not hold"},
    };
    return all;
}

}  // namespace swage
