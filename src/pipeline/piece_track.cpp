// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_track.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "geometry/mesh_check.h"
#include "pipeline/signals.h"
#include "pipeline/surface_match.h"

namespace swage {

struct PieceTrack::Skin {
    int id;
    TriMesh mesh;
    std::vector<Vec3> position;  // in the last frame that it was in
    Components shells;

    Skin(int number, TriMesh surface, std::vector<Vec3> place)
        : id(number),
          mesh(std::move(surface)),
          position(std::move(place)),
          shells(surface_components(mesh)) {}

    // Of each shell.
    std::vector<double> volume() const { return component_volumes(mesh, position, shells); }
};

// A skin, from when it is there.
struct PieceTrack::Step {
    int skin = 0, frame = 1;
    std::vector<int> parent;  // of each shell, in the skin before
    std::vector<double> volume;
    std::vector<int> piece = std::vector<int>(parent.size(), kNone);
    static constexpr int kNone = -1;
};

PieceTrack::PieceTrack(const FrameStore& store, const std::vector<NamedPieces>& told) {
    std::vector<std::optional<Skin>> last;
    std::vector<std::vector<Step>> steps;  // of each body
    for (int frame = 1; frame <= store.frame_count(); ++frame) {
        throw_if_interrupted();
        StoredFrame stored = store.frame(frame - 1);
        last.resize(std::max(last.size(), stored.body.size()));
        steps.resize(last.size());
        for (std::size_t b = 0; b < stored.body.size(); ++b) {
            StoredBody& body = stored.body[b];
            if (last[b] && last[b]->id == body.skin) {
                last[b]->position = std::move(body.position);
                continue;
            }
            Skin now(body.skin, store.skin(body.skin), std::move(body.position));
            std::vector<int> parent(std::size_t(now.shells.count), Step::kNone);
            if (last[b]) {
                steps[b].back().volume = last[b]->volume();
                if (last[b]->shells.count > 0) {
                    parent = parent_shells(now.mesh, now.position, now.shells, last[b]->mesh,
                                           last[b]->position, last[b]->shells);
                }
            }
            steps[b].push_back({now.id, frame, std::move(parent), {}});
            last[b] = std::move(now);
        }
    }
    first_frame_.resize(last.size());
    for (std::size_t b = 0; b < last.size(); ++b) {
        if (!last[b]) continue;
        steps[b].back().volume = last[b]->volume();
        const std::vector<int>& shell = last[b]->shells.triangle_component;
        std::vector<int> first;  // shells of the last skin
        if (b < told.size() && told[b].frame == store.frame_count()) {
            for (const int t : told[b].triangle) {
                if (t >= 0 && std::size_t(t) < shell.size()) first.push_back(shell[t]);
            }
        }
        number(b, steps[b], std::move(first));
    }
}

// `first`: of the last of them, before its others.
void PieceTrack::number(std::size_t body, std::vector<Step>& steps, std::vector<int> first) {
    std::vector<int>& first_frame = first_frame_[body] = {steps.front().frame};
    for (std::size_t last = steps.size(); last-- > 0; first.clear()) {
        const std::vector<double>& volume = steps[last].volume;
        std::vector<int> order(volume.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return volume[a] > volume[b]; });
        order.insert(order.begin(), first.begin(), first.end());
        for (const int shell : order) {
            if (steps[last].piece[shell] != Step::kNone) continue;
            // Back to where it came off something that has a number, or to the start.
            std::vector<int*> unnumbered;
            int at = shell, number = 0;
            for (std::size_t s = last;; --s) {
                unnumbered.push_back(&steps[s].piece[at]);
                const int parent = steps[s].parent[at];
                if (s == 0 || parent == Step::kNone) break;
                if (steps[s - 1].piece[parent] != Step::kNone) {
                    number = static_cast<int>(first_frame.size());
                    first_frame.push_back(steps[s].frame);
                    break;
                }
                at = parent;
            }
            for (int* piece : unnumbered) *piece = number;
        }
        of_shell_[{body, steps[last].skin}] = steps[last].piece;
    }
}

std::vector<int> PieceTrack::of_triangles(std::size_t body, int skin, const TriMesh& mesh) const {
    const std::vector<int>& of_shell = of_shell_.at({body, skin});
    std::vector<int> piece = surface_components(mesh).triangle_component;
    for (int& one : piece) one = of_shell.at(static_cast<std::size_t>(one));
    return piece;
}

}  // namespace swage
