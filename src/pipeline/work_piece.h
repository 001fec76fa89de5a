// SPDX-License-Identifier: GPL-3.0-or-later
// A body on its way through the stages: the mesh that came in, the matter that was molded from it,
// and the skin that follows the matter.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "mold/mold.h"
#include "pipeline/carried_insets.h"
#include "pipeline/input_mesh.h"
#include "scene/spec.h"
#include "skin/cut_mesh.h"
#include "skin/mount.h"
#include "skin/new_look.h"

namespace swage {

// The body's matter, with its insets, as its mesh stands in its file. Throws as mold() does, of
// insets and fineness SceneError. `solids`: gets those of its insets.
Aggregate mold_body(const InputMesh& input, const BodySpec& body,
                    std::vector<std::string>& findings, std::vector<TriMesh>* solids = nullptr);

// As a mistake where the scene says how fine the body's cells are.
[[noreturn]] void refuse_fineness(const BodySpec& body, const FinenessError& error);

struct WorkPiece {
    std::string name, label;  // label: of its objects and looks
    Aggregate matter;
    TriMesh skin;  // its positions: as mounted
    Mount mount;
    std::shared_ptr<const NewLook> look;  // of a skin that is a boundary
    std::vector<Vec3> position;           // of the skin now [m]
    Vec3Array followed;                   // of the particles that this is from [m]
    std::vector<std::string> finding;     // what of its mesh its matter has not, when molded
    Mount probe;                          // places that are followed, as the scene asks
    // Once a blade's path was curved: the skin is not cut along it, so triangles may be torn there,
    // now and in every later stage. A boundary is made anew instead.
    bool is_torn = false;
    // Once a blade or a load has parted it: its skin goes on from where it was held, and is not
    // brought to its matter's volume any more.
    bool is_parted = false;
    double roughness = 0;  // of faces where matter breaks by load (SkinSettings)
    // Once matter broke by load: what a mounted skin was made from since.
    std::optional<TriMesh> whole_skin;
    Mount whole_mount;
    std::vector<Vec3> whole_position;
    std::vector<CarriedInset> inset;  // where a stage is yet to cut it or to mold it anew

    // The skin as a mesh where it is now.
    TriMesh deformed() const;
};

// What warnings call it.
std::string name_among(const std::vector<WorkPiece>& bodies, const WorkPiece& body);

// At its start: molded as its mesh stands in its file, then turned, moved and set in motion, so
// that how it stands has no effect on how well it is resolved. `carries`: its insets' surfaces.
WorkPiece make_work_piece(const InputMesh& input, const BodySpec& body, const SkinSettings& skin,
                          bool carries = false);

// Empty where its skin is as its mesh came.
std::string division_text(const WorkPiece& piece, const InputMesh& input, const SkinSettings& skin);

// Turns about the middle of the box of the mesh that it was molded from, moves and sets in motion.
void place_at_start(const StartSpec& start, const TriMesh& mesh, Aggregate& matter);
// The box of its skin, as `shown`, where it is then.
Box box_at_start(const StartSpec& start, const TriMesh& mesh, const TriMesh& shown);

// A new representation of the work-piece as it is now, without strain, of cells of the same size,
// as hard as it has become and as fast as it goes; each of its materials is as heavy as it was. Of
// one with insets that are carried; `carries` them on.
WorkPiece mold_anew(const WorkPiece& piece, const BodySpec& body, const SkinSettings& skin,
                    bool carries = false);

// Of one body its own; of several, of all.
std::uint64_t state_hash(const std::vector<WorkPiece>& bodies);

// Whether the skin encloses what its matter takes up: that of whole matter which has flowed, but
// for springs, whose flow has no law of its volume.
bool keeps_volume(const WorkPiece& piece);

// Brings the skin to where the matter is; that of a whole body whose cells have flowed encloses
// what these take up (skin/skin_volume.h).
void follow_matter(WorkPiece& piece);

// Lets a skin go on from where it was: to be called when matter has been severed since it
// followed, which it shall not be seen to do before it moves (hold_places).
void hold_skin(WorkPiece& piece);

// The skin as it is to be seen: where the matter is and, when it is mounted, without the triangles
// that a blade has torn. `has_parted`: matter has broken or been severed since; then a mounted skin
// is parted where it broke by load, and closed; returns in how many places that was not possible. A
// boundary is made anew where matter broke, or was severed as skins are not cut.
int show_matter(WorkPiece& piece, bool has_parted);

// Cuts a skin along all that blades will sweep (skin/cut_mesh.h), that which is parted where matter
// broke as well as the whole one that it is made from; not a boundary that is made anew.
// Probes keep to their sides of that.
CutResult cut_skins(WorkPiece& piece, const std::vector<std::array<Vec3, 3>>& sweep);

}  // namespace swage
