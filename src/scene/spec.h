// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as its file says it, checked, in SI, with every default filled in.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/trimesh.h"
#include "machines/machine_spec.h"
#include "matter/material.h"
#include "matter/skin_field.h"
#include "mold/mold.h"
#include "render/settings.h"
#include "scene/document.h"
#include "sim/settings.h"
#include "skin/settings.h"

namespace swage {

struct MeshSpec {
    std::filesystem::path file;    // absolute
    std::optional<double> length;  // [m] of the longest side of the box; none: file's own
    std::filesystem::path
        texture;          // absolute; all over it, instead of what its file says; or empty
    Place texture_place;  // where the scene says which
};

// Where the work-piece is of another material: inside a mesh, placed and scaled as the work-piece's
// file is, or a box.
struct InsetSpec {
    std::filesystem::path file;                   // absolute; empty: the box
    Vec3 from = Vec3::Zero(), to = Vec3::Ones();  // in shares of the work-piece's own box
    Material material;
    std::optional<Vec3> color;            // linear RGB, of cut faces that show it; none: as `look`
    std::optional<SurfaceMaterial> look;  // of its material, where anyone says
    Place place;                          // where the scene says which
};

// A place of a body to be followed.
struct ProbeSpec {
    std::string name;
    Vec3 at = Vec3::Zero();           // in shares of the body's own box
    Place place;                      // where the scene says that
    std::vector<SkinField> fields{};  // of the matter there
};

// Where a body stands and how it moves before the first stage.
struct StartSpec {
    std::optional<Vec3> at;        // [m], of the middle of its box; none: where its file has it
    Vec3 turn = Vec3::Zero();      // about the middle of its box: axis times angle [rad]
    Vec3 velocity = Vec3::Zero();  // [m/s]
    Vec3 spin = Vec3::Zero();      // about its centre of mass [rad/s]
    bool moves() const;
};

struct BodySpec {
    // Compiled once: a copy is thousands of instructions, which many places make.
    BodySpec();
    ~BodySpec();
    BodySpec(const BodySpec&);
    BodySpec(BodySpec&&) noexcept;
    BodySpec& operator=(const BodySpec&);
    BodySpec& operator=(BodySpec&&) noexcept;

    std::string name = "work-piece";  // a file name
    MeshSpec mesh;
    StartSpec start;
    std::optional<Vec3> color;  // linear RGB, instead of what its file says
    std::optional<bool> metal;  // that is, or the texture; none: matt, or clear, as the material
    std::optional<Vec3> cut_color;  // linear RGB, of faces that cuts and breaks lay open
    bool wears_material = false;    // looks as its material does whatever its file says
    Material material;
    std::optional<SurfaceMaterial> look;  // of that, where anyone says
    bool gives_look = false;              // the scene does
    bool gives_damping = false;           // the scene, of it or an inset
    std::vector<InsetSpec> inset;
    std::vector<ProbeSpec> probe;
    MoldSettings mold;
    Place fineness_place, limit_place;  // where the scene says how fine that is, and its limit

    // Whether the scene says how all of it looks, whatever its file says.
    bool is_painted() const { return color || wears_material || !mesh.texture.empty(); }
    // Of its objects and looks in files: what its mesh is called, where nobody named it.
    std::string label() const;
    std::vector<const Material*> materials() const;  // its own first
};

struct StageSpec {
    // As BodySpec.
    StageSpec();
    ~StageSpec();
    StageSpec(const StageSpec&);
    StageSpec(StageSpec&&) noexcept;
    StageSpec& operator=(const StageSpec&);
    StageSpec& operator=(StageSpec&&) noexcept;

    std::string name;  // "1-bend": number and machine, or the user's own; a file name
    MachineSpec machine;
    std::map<std::string, double> parameter;  // only those that the scene gives, SI
    // Where the scene names the machine, and where each of those parameters.
    Place place;
    std::map<std::string, Place> parameter_place;
    // The work frame's x, forward or automatic (longest side of the box), and y.
    WorldAxis axis = WorldAxis::automatic, up = WorldAxis::automatic;
    int frames = 60;      // >= 1
    double duration = 0;  // [s] of machine time, > 0 once it is read
    bool remold = false;  // mold the deformed mesh anew before this stage
    SimSettings sim;
};

struct OutputSpec {
    bool meshes_per_frame = false;
    std::vector<SkinField> fields;  // of the matter, at the skin's vertices
    bool keep_stages = true;        // each of a run that is done can be gone on from
};

struct SceneSpec {
    // As BodySpec.
    SceneSpec();
    ~SceneSpec();
    SceneSpec(const SceneSpec&);
    SceneSpec(SceneSpec&&) noexcept;
    SceneSpec& operator=(const SceneSpec&);
    SceneSpec& operator=(SceneSpec&&) noexcept;

    std::filesystem::path file;  // absolute
    std::string name;            // stem of the file
    // Where it was piped in: what was. `file` is then a name in the working directory, no file.
    std::optional<std::string> piped;
    std::vector<BodySpec> body;  // the first is the work-piece, which machines are set up at and
                                 // take hold of
    SkinSettings skin;
    std::vector<StageSpec> stage;

    const BodySpec& work_piece() const { return body.front(); }
    template <typename Test>
    bool any_material(const Test& test) const {
        for (const BodySpec& one : body) {
            for (const Material* m : one.materials()) {
                if (test(*m)) return true;
            }
        }
        return false;
    }
    template <typename Test>
    bool any_stage(const Test& test) const {
        return std::any_of(stage.begin(), stage.end(), test);
    }
    // Whether any of its materials does, or any of its stages.
    bool breaks() const;
    bool yields() const;
    bool damps() const;
    bool moves() const;
    RenderSettings render;
    OutputSpec output;
    std::vector<Said> said;  // all that it says, with what was set on the command line
    // Of known materials by their names [J/m2]: who gives them as much is asked about the unit.
    std::map<std::string, double> strange_toughness;
    // Every file that was read but for the meshes of bodies: the scene, materials, machines, the
    // meshes of tools and insets.
    std::vector<std::filesystem::path> inputs;
};

}  // namespace swage
