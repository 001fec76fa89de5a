// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_track.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "pipeline/signals.h"
#include "pipeline/surface_match.h"

namespace swage {

struct PieceTrack::Skin {
    int id;
    TriMesh mesh;
    std::vector<Vec3> position;  // in the last frame that it was in
    Components shells;
    std::vector<double> area;  // of each
    std::vector<int> piece;    // likewise

    Skin(int number, TriMesh surface, std::vector<Vec3> place)
        : id(number),
          mesh(std::move(surface)),
          position(std::move(place)),
          shells(surface_components(mesh)),
          area(std::size_t(shells.count), 0.0),
          piece(area.size(), 0) {
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
            area[std::size_t(shells.triangle_component[t])] +=
                0.5 * area_vector(mesh.position, mesh.triangle[t]).norm();
        }
    }
};

std::vector<int> PieceTrack::parents(const Skin& now, const Skin& before) {
    return parent_shells(now.mesh, now.position, now.shells, before.mesh, before.position,
                         before.shells);
}

PieceTrack::PieceTrack(const FrameStore& store) {
    std::vector<std::optional<Skin>> last;
    for (int frame = 1; frame <= store.frame_count(); ++frame) {
        throw_if_interrupted();
        StoredFrame stored = store.frame(frame - 1);
        last.resize(std::max(last.size(), stored.body.size()));
        first_frame_.resize(last.size());
        for (std::size_t b = 0; b < stored.body.size(); ++b) {
            StoredBody& body = stored.body[b];
            if (last[b] && last[b]->id == body.skin) {
                last[b]->position = std::move(body.position);
                continue;
            }
            Skin now(body.skin, store.skin(body.skin), std::move(body.position));
            if (last[b]) {
                number_shells(now, *last[b], frame, first_frame_[b]);
            } else {
                first_frame_[b] = {frame};
            }
            of_shell_[{b, now.id}] = now.piece;
            last[b] = std::move(now);
        }
    }
}

void PieceTrack::number_shells(Skin& now, const Skin& before, int frame,
                               std::vector<int>& first_frame) {
    if (before.area.empty()) return;
    const std::vector<int> parent = parents(now, before);
    std::vector<std::size_t> order(now.area.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return now.area[a] > now.area[b]; });
    std::vector<char> is_taken(before.area.size(), 0);
    for (const std::size_t s : order) {
        const auto from = static_cast<std::size_t>(parent[s]);
        if (!is_taken[from]) {
            now.piece[s] = before.piece[from];
            is_taken[from] = 1;
        } else {
            now.piece[s] = static_cast<int>(first_frame.size());
            first_frame.push_back(frame);
        }
    }
}

std::vector<int> PieceTrack::of_triangles(std::size_t body, int skin, const TriMesh& mesh) const {
    const std::vector<int>& of_shell = of_shell_.at({body, skin});
    std::vector<int> piece = surface_components(mesh).triangle_component;
    for (int& one : piece) one = of_shell.at(static_cast<std::size_t>(one));
    return piece;
}

}  // namespace swage
