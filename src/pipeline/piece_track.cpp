// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_track.h"

#include <algorithm>
#include <numeric>
#include <set>

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
        std::vector<Shells> pieces;
        if (b < told.size() && told[b].frame == store.frame_count()) {
            pieces = shells_of(told[b], last[b]->shells);
        }
        number(b, steps[b], std::move(pieces));
    }
}

// Of each of the pieces. A shell is of one alone, and what the skin has not is left out.
std::vector<PieceTrack::Shells> PieceTrack::shells_of(const NamedPieces& told,
                                                      const Components& shells) {
    if (shells.count == 0) return {};
    if (told.triangle.empty()) {
        Shells all(std::size_t(shells.count));
        std::iota(all.begin(), all.end(), 0);
        return {all};
    }
    std::vector<Shells> pieces;
    std::set<int> taken;
    for (const std::vector<int>& triangles : told.triangle) {
        Shells own;
        for (const int t : triangles) {
            if (t < 0 || std::size_t(t) >= shells.triangle_component.size()) continue;
            const int shell = shells.triangle_component[std::size_t(t)];
            if (taken.insert(shell).second) own.push_back(shell);
        }
        if (!own.empty()) pieces.push_back(std::move(own));
    }
    return pieces;
}

// The first skin that something comes off in; where nothing does, the first of all.
std::size_t PieceTrack::first_parted(const std::vector<Step>& steps) {
    for (std::size_t s = 1; s < steps.size(); ++s) {
        const std::vector<int>& parent = steps[s].parent;
        if (std::set<int>(parent.begin(), parent.end()).size() < parent.size()) return s;
    }
    return 0;
}

// `told`: pieces of the last of them, before its other shells.
void PieceTrack::number(std::size_t body, std::vector<Step>& steps, std::vector<Shells> told) {
    std::vector<int>& first_frame = first_frame_[body] = {steps.front().frame};
    const std::size_t parted = first_parted(steps);
    for (std::size_t last = steps.size(); last-- > 0; told.clear()) {
        for (std::size_t n = 0; n < told.size(); ++n) {
            std::optional<std::size_t> from;
            if (n > 0) from = parted;
            number_piece(steps, last, told[n], from, first_frame);
        }
        const std::vector<double>& volume = steps[last].volume;
        std::vector<int> order(volume.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return volume[a] > volume[b]; });
        for (const int shell : order) {
            if (steps[last].piece[shell] != Step::kNone) continue;
            number_piece(steps, last, {shell}, {}, first_frame);
        }
        of_shell_[{body, steps[last].skin}] = steps[last].piece;
    }
}

// A piece has a number of its own from where its first shell comes off something that has one, and
// is what that was part of before. What was there from the start has it from the skin `from` on,
// and is 0 before, or always.
void PieceTrack::number_piece(std::vector<Step>& steps, std::size_t last, const Shells& shells,
                              std::optional<std::size_t> from, std::vector<int>& first_frame) {
    std::vector<int> number(last + 1, 0);  // of its first shell, skin by skin
    std::size_t first = last;              // that it has none in
    bool comes_off = false;
    int at = shells.front();
    for (std::size_t s = last + 1; at != Step::kNone && s-- > 0;) {
        number[s] = steps[s].piece[at];
        if (number[s] == Step::kNone) first = s;
        comes_off |= number[s] != Step::kNone;
        at = steps[s].parent[at];
    }
    const std::size_t own_from = !comes_off && from ? std::max(first, *from) : first;
    int own = 0;
    if (comes_off || from) {
        own = static_cast<int>(first_frame.size());
        first_frame.push_back(steps[own_from].frame);
    }
    for (std::size_t s = first; s <= last; ++s) number[s] = s < own_from ? 0 : own;
    for (int shell : shells) {
        for (std::size_t s = last + 1; shell != Step::kNone && s-- > 0;) {
            if (steps[s].piece[shell] != Step::kNone) break;
            steps[s].piece[shell] = number[s];
            shell = steps[s].parent[shell];
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
