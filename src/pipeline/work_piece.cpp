// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work_piece.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "base/hash.h"
#include "base/log.h"
#include "base/units.h"
#include "geometry/box_mesh.h"
#include "geometry/mesh_read.h"
#include "matter/material_volumes.h"
#include "mold/carry_hardening.h"
#include "mold/carry_motion.h"
#include "mold/mold.h"
#include "mold/prepare.h"
#include "pipeline/body_look.h"
#include "pipeline/probes.h"
#include "sim/cell_volume.h"
#include "skin/boundary.h"
#include "skin/broken_skin.h"
#include "skin/cut_places.h"
#include "skin/divided_mesh.h"
#include "skin/skin_volume.h"
#include "skin/whole_parts.h"

namespace swage {

namespace {

// Where this mesh is; a box is one of `box`.
TriMesh inset_solid(const InsetSpec& spec, const InputMesh& input, const Box& box,
                    std::vector<std::string>& findings) {
    if (spec.file.empty()) {
        return box_mesh(box.low + spec.from.cwiseProduct(box.size()),
                        box.low + spec.to.cwiseProduct(box.size()));
    }
    InputMesh read;
    read.mesh = read_mesh(spec.file, {}, &read.finding);
    for (Vec3& p : read.mesh.position) p *= input.scale;
    read.report = check_mesh(read.mesh);
    for (const std::string& finding : read.finding) {
        findings.push_back(spec.file.filename().string() + ": " + finding);
    }
    make_solid(read, MoldKind::shape);
    return read.to_mold();
}

[[noreturn]] void refuse_inset(const InsetSpec& spec, const Error& error) {
    throw SceneError({mistake_at(spec.place, error.what(), error.code())});
}

TriMesh block_mesh(const TriMesh& mesh) {
    const Box box = box_of(mesh.position);
    return box_mesh(box.low, box.high);
}

// Makes it as heavy as that [kg].
void weigh(double mass, Aggregate& matter) {
    const double share = mass / matter.mass();
    matter.material.density *= share;
    for (double& m : matter.particle_mass) m *= share;
}

// One look all over, where there is one.
void paint(TriMesh& skin, const std::optional<SurfaceMaterial>& look) {
    if (!look) return;
    skin.material = {*look};
    skin.triangle_material.assign(skin.triangle.size(), 0);
    skin.position_color.clear();
}

// Every body has a look of a name of its own, that those of several files can be told apart.
void name_looks(TriMesh& skin, const std::string& label) {
    if (skin.material.empty()) skin.material.emplace_back();
    if (skin.triangle_material.empty()) skin.triangle_material.resize(skin.triangle.size(), 0);
    for (SurfaceMaterial& look : skin.material) {
        if (look.name.empty()) look.name = label;
    }
}

// NOTE: where its layers are filled in part at both ends, what is pressed flows too soon, by up to
// 8 % of the force at four cells.
double in_whole_layers(double spacing, double thickness) {
    constexpr double kFewest = 3;  // of less the spacing would change by more than a sixth
    const double layers = std::round(thickness / spacing);
    return layers < kFewest ? std::min(spacing, thickness) : thickness / layers;
}

void lay_boundary(WorkPiece& piece) {
    BoundarySkin anew = boundary_skin(piece.matter, piece.look.get(), piece.roughness);
    piece.skin = std::move(anew.mesh);
    piece.mount = std::move(anew.mount);
}

// A boundary that a blade could only cut where the next break would have it another way.
bool is_made_anew(const WorkPiece& piece) {
    return piece.look != nullptr && (piece.is_torn || is_broken(piece.matter));
}

// Where matter broke by load. Returns in how many places the skin could not be closed.
int part_skin(WorkPiece& piece) {
    if (!is_broken(piece.matter)) return 0;
    if (!piece.whole_skin) {
        piece.whole_skin = piece.skin;
        piece.whole_mount = piece.mount;
    }
    BrokenSkin broken =
        break_skin(*piece.whole_skin, piece.whole_mount, piece.matter, piece.roughness);
    piece.skin = std::move(broken.mesh);
    piece.mount = std::move(broken.mount);
    return broken.open_faces;
}

}  // namespace

void refuse_fineness(const BodySpec& body, const FinenessError& error) {
    const bool is_limit = error.is_limit() && body.limit_place.source != nullptr;
    const std::string of = body.name == BodySpec().name ? "" : body.name + ": ";
    throw SceneError({mistake_at(is_limit ? body.limit_place : body.fineness_place,
                                 of + error.what(), error.code())});
}

TriMesh WorkPiece::deformed() const {
    TriMesh mesh = skin;
    if (!mesh.smooth_normal.empty()) mesh.smooth_normal = smooth_normals(skin, position);
    mesh.position = position;
    return mesh;
}

namespace {

std::vector<Inset> read_insets(const InputMesh& input, const BodySpec& body,
                               std::vector<std::string>& findings) {
    std::vector<Inset> insets;
    const Box box = box_of(input.to_mold().position);
    for (const InsetSpec& spec : body.inset) {
        try {
            insets.push_back({inset_solid(spec, input, box, findings), spec.material});
        } catch (const Error& error) {
            refuse_inset(spec, error);
        }
    }
    return insets;
}

Aggregate mold_with(const InputMesh& input, const BodySpec& body, const std::vector<Inset>& insets,
                    std::vector<std::string>& findings) {
    try {
        return mold(input.to_mold(), body.material, body.mold, insets, &findings);
    } catch (const InsetError& error) {
        refuse_inset(body.inset[error.inset()], error);
    } catch (const FinenessError& error) {
        refuse_fineness(body, error);
    }
}

}  // namespace

Aggregate mold_body(const InputMesh& input, const BodySpec& body,
                    std::vector<std::string>& findings, std::vector<TriMesh>* solids) {
    std::vector<Inset> insets = read_insets(input, body, findings);
    Aggregate matter = mold_with(input, body, insets, findings);
    for (Inset& one : insets) {
        if (solids != nullptr) solids->push_back(std::move(one.solid));
    }
    return matter;
}

namespace {

// Where a body's points are at its start, of those of its mesh.
struct StartPlace {
    Vec3 middle, at;
    Mat3 turn;

    StartPlace(const StartSpec& start, const TriMesh& mesh)
        : middle(box_of(mesh.position).center()),
          at(start.at.value_or(middle)),
          turn(turn_by(start.turn).toRotationMatrix()) {}
    Vec3 operator()(const Vec3& point) const { return turn * (point - middle) + at; }
};

}  // namespace

Box box_at_start(const StartSpec& start, const TriMesh& mesh, const TriMesh& shown) {
    const StartPlace place(start, mesh);
    Box box;
    for (const Vec3& point : shown.position) box.grow(place(point));
    return box;
}

void place_at_start(const StartSpec& start, const TriMesh& mesh, Aggregate& matter) {
    const StartPlace place(start, mesh);
    Vec3 moment = Vec3::Zero();
    double mass = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 x = place(matter.particle_position.at(p));
        matter.particle_position.set(p, x);
        moment += matter.particle_mass[p] * x;
        mass += matter.particle_mass[p];
    }
    const Vec3 centre = moment / mass;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 arm = matter.particle_position.at(p) - centre;
        matter.particle_velocity.set(p, start.velocity + start.spin.cross(arm));
    }
}

namespace {

// Its matter and what it found are there.
void dress(const InputMesh& input, const BodySpec& body, const SkinSettings& skin,
           WorkPiece& piece) {
    piece.name = body.name;
    piece.label = body.label();
    piece.roughness = skin.roughness;
    if (skin.kind == SkinKind::boundary) {
        TriMesh like = body.mold.kind == MoldKind::block ? block_mesh(input.to_mold()) : input.mesh;
        paint(like, body_look(body, input.mesh));
        color_inside(body, like);
        name_looks(like, piece.label);
        piece.look = std::make_shared<const NewLook>(like);
        lay_boundary(piece);
    } else {
        piece.skin = input.mesh;
        if (skin.longest_edge)
            piece.skin =
                divide_edges(input.mesh, *skin.longest_edge * piece.matter.lattice.spacing);
        paint(piece.skin, body_look(body, input.mesh));
        color_inside(body, piece.skin);
        name_looks(piece.skin, piece.label);
        piece.mount = mount_mesh(piece.skin.position, piece.matter, skin.kind);
    }
    piece.probe = mount_probes(body, input.to_mold(), piece.matter);
    piece.position = piece.skin.position;
    piece.followed = piece.matter.particle_position;
}

}  // namespace

std::string name_among(const std::vector<WorkPiece>& bodies, const WorkPiece& body) {
    return bodies.size() == 1 ? "the work-piece" : body.name;
}

WorkPiece make_work_piece(const InputMesh& input, const BodySpec& body, const SkinSettings& skin,
                          bool carries) {
    WorkPiece piece;
    const std::vector<Inset> insets = read_insets(input, body, piece.finding);
    piece.matter = mold_with(input, body, insets, piece.finding);
    dress(input, body, skin, piece);
    if (carries) {
        const TriMesh& dressed = piece.look ? piece.look->mesh() : piece.skin;
        piece.inset =
            carry_insets(insets, inset_looks(body, dressed), &input.to_mold(), piece.matter);
    }
    const StartSpec& start = body.start;
    const bool stands = !start.at && start.turn == Vec3::Zero();
    if (!stands || start.moves()) place_at_start(start, input.to_mold(), piece.matter);
    if (!stands) follow_matter(piece);
    return piece;
}

std::string division_text(const WorkPiece& piece, const InputMesh& input,
                          const SkinSettings& skin) {
    const std::size_t before = input.mesh.triangle.size(), after = piece.skin.triangle.size();
    if (piece.look || after == before) return {};
    return fmt::format("skin: {} triangles divided into {}, with no edge longer than {} cell{}",
                       before, after, *skin.longest_edge, *skin.longest_edge == 1 ? "" : "s");
}

namespace {

constexpr double kOtherVolume = 0.01;  // from here on it is told

// What a skin encloses beside what it stands for: the new matter fills it all.
void note_volume(const Aggregate& was, const TriMesh& skin, std::vector<std::string>& finding) {
    const double matter = present_volume(was), share = signed_volume(skin) / matter - 1;
    if (!(std::abs(share) > kOtherVolume)) return;
    finding.push_back(fmt::format(
        "molded anew: the skin encloses {:.3g} % {} than the {} that its matter took up; the new "
        "matter fills it, at {:.3g} times the density",
        100 * std::abs(share), share > 0 ? "more" : "less", volume_text(matter), 1 / (1 + share)));
}

}  // namespace

WorkPiece mold_anew(const WorkPiece& piece, const BodySpec& body, const SkinSettings& skin,
                    bool carries) {
    InputMesh input;
    input.mesh = piece.deformed();
    input.report = check_mesh(input.mesh);
    // Pieces that touch where they were cut are no bodies to be united.
    if (!input.report.bounds_a_volume()) make_solid(input, body.mold.kind, skin.crease_angle);
    BodySpec as_it_stands = body;
    as_it_stands.probe.clear();
    // It is painted already, but where it was cut; what is made for a block's box is not.
    const bool is_blank = skin.kind == SkinKind::boundary && body.mold.kind == MoldKind::block;
    if (!is_blank) {
        as_it_stands.color.reset(), as_it_stands.wears_material = false;
        as_it_stands.mesh.texture.clear();
    }
    // Bent, its box says nothing of how thick it is.
    as_it_stands.mold.across.reset();
    as_it_stands.mold.spacing = in_whole_layers(piece.matter.lattice.spacing,
                                                surface_box(input.to_mold()).size().minCoeff());
    WorkPiece anew;
    if (piece.inset.size() != piece.matter.inset.size()) {
        fail(ExitCode::stopped, "cannot mold anew: the insets' surfaces were not carried");
    }
    const std::vector<Inset> insets = insets_now(piece.inset, piece.matter, anew.finding);
    std::vector<SurfaceMaterial> looks;
    for (const CarriedInset& one : piece.inset) looks.push_back(one.look);
    const std::vector<double> masses = material_masses(piece.matter);
    anew.matter = mold(input.to_mold(), body.material, as_it_stands.mold, insets, &anew.finding,
                       insets.empty() ? nullptr : &masses);
    dress(input, as_it_stands, skin, anew);
    note_volume(piece.matter, input.to_mold(), anew.finding);
    if (carries) anew.inset = carry_insets(insets, std::move(looks), nullptr, anew.matter);
    const std::string divided = division_text(anew, input, skin);
    if (!divided.empty()) log_info("{}", divided);
    // Pressed, drawn or where its pieces lie in each other, matter takes up another volume.
    weigh(piece.matter.mass(), anew.matter);
    std::vector<Vec3> probed;
    skin_positions(piece.probe, piece.matter, probed);
    anew.probe = mount_mesh(probed, anew.matter, SkinKind::mount);
    carry_hardening(piece.matter, anew.matter);
    carry_motion(piece.matter, anew.matter);
    return anew;
}

std::uint64_t state_hash(const std::vector<WorkPiece>& bodies) {
    if (bodies.size() == 1) return state_hash(bodies[0].matter);
    Hasher hasher;
    for (const WorkPiece& body : bodies) {
        const std::uint64_t own = state_hash(body.matter);
        hasher.add_bytes(&own, sizeof own);
    }
    return hasher.value();
}

bool keeps_volume(const WorkPiece& piece) {
    return !piece.is_parted && piece.matter.has_flowed() &&
           piece.matter.material.mechanics == Mechanics::cells;
}

void hold_skin(WorkPiece& piece) {
    piece.is_parted = true;
    if (!is_broken(piece.matter)) follow_one_piece(piece.skin, piece.mount, piece.matter);
    std::swap(piece.matter.particle_position, piece.followed);
    hold_insets(piece.inset, piece.matter);
    if (piece.whole_skin) {
        hold_places(piece.whole_mount, piece.matter, piece.whole_position);
    } else {
        hold_places(piece.mount, piece.matter, piece.position);
    }
    std::swap(piece.matter.particle_position, piece.followed);
}

CutResult cut_skins(WorkPiece& piece, const std::vector<std::array<Vec3, 3>>& sweep) {
    const bool is_cut = !is_made_anew(piece);
    const Insides insides = is_cut ? insides_now(piece.inset) : Insides();
    cut_insets(piece.inset, piece.matter, sweep);
    keep_to_sides(piece.probe, piece.matter, sweep,
                  box_of(piece.position).widened(piece.matter.lattice.spacing));
    if (!is_cut) return {};
    CutResult shown =
        cut_skin(piece.skin, piece.position, piece.mount, piece.matter, sweep, insides);
    piece.is_torn = piece.is_torn || shown.has_folded;
    piece.is_parted = piece.is_parted || shown.cuts > 0;
    if (piece.look) {
        // What it cannot be cut along, or not so that it closes, is made anew once it is severed.
        piece.is_torn = piece.is_torn || shown.open_parts > 0;
        shown.open_parts = 0, shown.has_folded = false;
    }
    if (!piece.whole_skin) return shown;
    CutResult whole = cut_skin(*piece.whole_skin, piece.whole_position, piece.whole_mount,
                               piece.matter, sweep, insides);
    whole.open_parts = std::max(whole.open_parts, shown.open_parts);
    return whole;
}

void follow_matter(WorkPiece& piece) {
    skin_positions(piece.mount, piece.matter, piece.position);
    if (keeps_volume(piece)) {
        const double share = present_volume(piece.matter) / piece.matter.volume();
        enclose_volume(piece.skin, piece.mount, piece.matter, share * signed_volume(piece.skin),
                       piece.position);
    }
    piece.followed = piece.matter.particle_position;
    follow_insets(piece.inset, piece.matter);
    if (piece.whole_skin) skin_positions(piece.whole_mount, piece.matter, piece.whole_position);
}

int show_matter(WorkPiece& piece, bool has_parted) {
    int open = 0;
    if (has_parted && !piece.is_parted && is_broken(piece.matter)) {
        if (keeps_volume(piece)) hold_skin(piece);
        piece.is_parted = true;
    }
    if (has_parted && is_made_anew(piece)) lay_boundary(piece);
    if (has_parted && !piece.look) open = part_skin(piece);
    follow_matter(piece);
    if (piece.is_torn && !piece.look) {
        remove_torn_triangles(piece.skin, piece.mount, piece.matter);
    }
    return open;
}

}  // namespace swage
