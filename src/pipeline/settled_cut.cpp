// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/settled_cut.h"

#include <algorithm>

#include "sim/sever.h"
#include "skin/broken_skin.h"
#include "skin/skin_pieces.h"

namespace swage {

namespace {

// What cut_skins() changes, but for what follows from it.
struct UncutSkin {
    explicit UncutSkin(const WorkPiece& p)
        : skin(p.skin),
          mount(p.mount),
          is_torn(p.is_torn),
          is_parted(p.is_parted),
          whole_skin(p.whole_skin),
          whole_mount(p.whole_mount),
          inset(p.inset) {}
    void put_back(WorkPiece& p) {
        p.skin = std::move(skin), p.mount = std::move(mount);
        p.is_torn = is_torn, p.is_parted = is_parted;
        p.whole_skin = std::move(whole_skin), p.whole_mount = std::move(whole_mount);
        p.inset = std::move(inset);
        follow_matter(p);
    }

    TriMesh skin;
    Mount mount;
    bool is_torn, is_parted;
    std::optional<TriMesh> whole_skin;
    Mount whole_mount;
    std::vector<CarriedInset> inset;
};

void warn_of(const CutResult& cut, int frame, WarningBook& warnings) {
    if (cut.open_parts > 0) {
        warnings.add(frame,
                     fmt::format("{} open part{} of the skin could not be closed where it is cut",
                                 cut.open_parts, cut.open_parts == 1 ? "" : "s"));
    }
    if (cut.has_curved) {
        warnings.add(frame,
                     "a blade's path bends or turns within the work-piece, so the skin is torn "
                     "along it and left open (skin.kind = \"boundary\" is made anew and closed)");
    }
}

// One that is made anew, or torn along a path that bends, is parted as the matter is; rubble has
// pieces without a skin.
bool is_cut_along(const WorkPiece& piece) { return !piece.is_torn && !is_broken(piece.matter); }

}  // namespace

bool keep_what_is_not_shown(std::size_t body, Simulation& simulation, const WorkPiece& piece) {
    if (!is_cut_along(piece)) return true;
    const Aggregate ahead = simulation.planned(body);
    const std::vector<char> bare = pieces_without_skin(piece.skin, piece.mount, ahead);
    if (std::ranges::none_of(bare, [](char one) { return one != 0; })) return true;
    return simulation.keep(body, ahead, bare);
}

bool settle_cut(const Machine& machine, std::span<const Drive> way, int steps, std::size_t body,
                Simulation& simulation, WorkPiece& piece, int frame, WarningBook& warnings) {
    simulation.plan_cuts(body, way, steps);
    UncutSkin before(piece);
    const CutResult cut = cut_skins(piece, swept_triangles(machine.apparatus, way));
    follow_matter(piece);
    if (!keep_what_is_not_shown(body, simulation, piece)) {
        before.put_back(piece);
        return false;
    }
    warn_of(cut, frame, warnings);
    return true;
}

}  // namespace swage
