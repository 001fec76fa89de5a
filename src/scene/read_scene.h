// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files. Quantities carry units ("18 cm"); a bare number is SI.
//
//     [mesh]      file, length; where the body starts: at, turn, velocity, spin; color
//     [material]  name; mechanics ("cells", "springs"), elasticity ("hencky", "neo-hookean"),
//                 young_modulus, poisson_ratio, density, yield_stress, hardening, strength,
//                 toughness, damping_ratio, friction, static_friction, restitution, stickiness
//     [mold]      across or spacing, kind ("shape", "block"), cell_limit
//     [[body]]    another body: the keys of [mesh]; name; across or spacing; material, a name or a
//                 section [body.material]; what it leaves out is as the work-piece has it
//     [skin]      kind ("mount", "frame4", "boundary")
//     [[stage]]   machine, name, frames, duration, axis, up, remold; solver ("quasistatic",
//                 "explicit", "euler", "energy-stepped", "implicit"), gravity,
//                 gravity_strength; tolerance, iteration_limit, halving_limit, contact_stiffness,
//                 grip_stiffness, step_safety, retry_limit, self_contact, sleep (see sim/settings.h); and
//                 the machine's parameters
//     [[stage.load]]  name, force or pressure, on, from, to, strength (see scene/read_load.h)
//     [render]    size, fps, film, tools, ground, gl ("auto", "osmesa", "egl"), field_of_view
//     [render.camera]  azimuth, elevation, zoom, or eye and target; orbit; or keys = [{at, ...}]
//     [output]    meshes_per_frame
//
// Paths are relative to the file they stand in. A material may be given by its name, by the first
// two numbers and whatever else is known, or by its name with some numbers overridden.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/find.h"
#include "scene/mistake.h"
#include "scene/spec.h"

namespace swage {

struct SceneReading {
    std::optional<SceneSpec> scene;  // nothing when there was a mistake (not a warning)
    std::vector<Mistake> mistakes;   // of all files, the scene's first, in the order of each file
};

// `overrides`: "stage.1.angle=45 deg", "material.young_modulus=2 GPa", "render.size=[640, 360]". A
// stage goes by its number, its name, its machine, or * for all. Everything that is wrong in the
// scene and in the files it names is found in one reading; throws nothing for what a user may
// write.
SceneReading read_scene(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides, const AssetPaths& assets);

}  // namespace swage
