// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/settled_cut.h"

#include <algorithm>

#include "sim/blade_way.h"
#include "sim/crumbs.h"
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
          probe(p.probe),
          is_torn(p.is_torn),
          is_parted(p.is_parted),
          whole_skin(p.whole_skin),
          whole_mount(p.whole_mount),
          inset(p.inset) {}
    void put_back(WorkPiece& p) {
        p.skin = std::move(skin), p.mount = std::move(mount);
        p.probe = std::move(probe);
        p.is_torn = is_torn, p.is_parted = is_parted;
        p.whole_skin = std::move(whole_skin), p.whole_mount = std::move(whole_mount);
        p.inset = std::move(inset);
        follow_matter(p);
    }

    TriMesh skin;
    Mount mount, probe;
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
    if (cut.has_folded) {
        warnings.add(frame,
                     "a blade's path turns back over itself within the work-piece, so the skin is "
                     "torn along it and left open (skin.kind = \"boundary\" is made anew and "
                     "closed)");
    }
}

// Of the pieces that a cut would make, which are to stay with what they would be cut from. A skin
// that is made anew, or torn along a path that folds, is parted as the matter is; rubble has pieces
// without a skin.
std::vector<char> pieces_to_keep(const WorkPiece& piece, const Aggregate& ahead) {
    const Pieces pieces = find_pieces(ahead);
    std::vector<char> kept = find_crumbs(pieces);
    if (piece.is_torn || is_broken(piece.matter)) return kept;
    const std::vector<SkinShare> share = skin_shares(piece.skin, piece.mount, ahead);
    const std::vector<char> unturned = find_unturned(pieces, ahead);
    for (std::size_t n = 0; n < kept.size(); ++n) {
        kept[n] = share[n] == SkinShare::none ||
                  (kept[n] && (share[n] == SkinShare::joined || unturned[n]));
    }
    return kept;
}

}  // namespace

bool keep_what_is_not_shown(std::size_t body, Simulation& simulation, const WorkPiece& piece,
                            const std::vector<char>& blades) {
    const Aggregate ahead = simulation.planned(body);
    return simulation.keep(body, ahead, pieces_to_keep(piece, ahead), blades);
}

bool settle_cut(const Machine& machine, std::span<const Drive> way, int steps,
                const std::vector<char>& blades, std::size_t body, Simulation& simulation,
                WorkPiece& piece, int frame, WarningBook& warnings) {
    simulation.plan_cuts(body, way, steps, blades);
    UncutSkin before(piece);
    const CutResult cut = cut_skins(piece, swept_triangles(machine.apparatus, way_of(blades, way)));
    follow_matter(piece);
    if (!keep_what_is_not_shown(body, simulation, piece, blades)) {
        before.put_back(piece);
        return false;
    }
    warn_of(cut, frame, warnings);
    return true;
}

}  // namespace swage
