// SPDX-License-Identifier: GPL-3.0-or-later
// A piece in which blades have left no whole cell, as contact in motion has it: a body of its own.
// It ends where the blades went (sim/thin_ends.h), and else by the surface as molded. A layer of
// particles has the cells between them, half a spacing to either side; what else there may be has a
// cell about each particle. Where it reaches beyond these they go on as they are. Corners of these
// cells, which are no particles, follow the nearest of the piece's,
//
//     x = sum_p w_p x_p + h n,   n = c sqrt((1 + b^2) / (c.c + b^2)),   c = t_1 x t_2,
//     t_i = sum_p c_ip x_p,   b = 0.3:
//
// one of a layer its own particle, along the mean normal n around; one of other cells the linear
// map that fits the particles around best. Forces on them go to the particles by the slope of that,
// so that force, moment and energy are kept.
//
// NOTE: with cells about the particles of a layer too, nothing kept these from going up and down by
// turns, which leaves the corners between them where they are: a layer does not resist bending, and
// it crumpled to half of its thickness. And with b = 0 the normal of one that folds turns at any
// speed: upright slices of sponge that fell in on themselves had energy from nowhere.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "matter/aggregate.h"
#include "sim/contact_side.h"
#include "sim/contact_sums.h"
#include "sim/cut_surface.h"
#include "sim/rest_surface.h"
#include "sim/thin_ends.h"
#include "sim/thin_near.h"

namespace swage {

// The particles of each piece that holds no whole cell, in their order. None of what may break: its
// crumbs are too many.
std::vector<std::vector<ParticleId>> thin_pieces(const Aggregate& matter);

class ThinPiece {
  public:
    // Null where the particles lie in a row, which does not tell how they turn, or have no surface
    // on their side, as corners of cells that hold little. `of` must outlive it; `molded`: its
    // surface; `near`: of it as it is now.
    static std::unique_ptr<ThinPiece> find(const Aggregate& of, const RestSurface& molded,
                                           const ThinNear& near, std::vector<ParticleId> particles);

    const std::vector<ParticleId>& particles() const { return particle_; }
    // Its cells, where they were when last asked to follow the particles.
    Aggregate& matter() { return matter_; }
    void follow();
    std::unique_ptr<ContactSide> contact_side() {
        return std::make_unique<ContactSide>(matter_, molded_, ends_);
    }

    // As forces [N] on its corners what does the same to their speeds as those on the particles do.
    Vec3Array& begin_forces(const Vec3Array& of);
    // What contact has added to these goes to the particles, whose speeds go on for `step` [s] with
    // all forces and gravity [m/s2]; the powers in `sums` are those of that.
    void end_forces(const Vec3& gravity, double step, Vec3Array& of, ContactSums& sums);

  private:
    struct Share {
        ParticleId particle;
        int number;                    // in particle_
        double weight, first, second;  // w, c_1, c_2 [1, 1/m, 1/m]
    };
    struct Corner {
        int begin, end;  // shares
        double off;      // h [m]; 0: the particles do not lie in a plane
    };
    struct Frame {  // of a corner, as it was last found
        Vec3 first, second, normal;
        double size;
    };

    ThinPiece(const Aggregate& of, std::vector<ParticleId> particles)
        : of_(&of), particle_(std::move(particles)) {}
    int number_at(const Vec3i& site) const;  // the piece's particle there, -1: none
    int number_of(ParticleId particle) const;
    Vec3i site_of(std::size_t number) const;
    bool find_layer();
    bool may_hold_matter(const Vec3i& site, const RestSurface& molded) const;
    bool make_cells(const RestSurface& molded);
    std::vector<int> numbers_within(double reach, const Vec3& place) const;
    bool add_corner(std::size_t corner);
    bool add_corner(const Vec3& place, double reach, ParticleId own);
    void add_point(const Vec3i& cell, const Vec3& at, double area, const Vec3& normal);
    void add_molded(const ThinEnds& ends, const std::vector<int>& points);
    void add_new(const ThinEnds& ends, const RestSurface& molded);
    std::vector<CutPlane> planes_of(const Vec3i& cell, const ThinEnds& ends) const;
    void find_ends(const ThinEnds& ends);
    // Of what the particles have a corner's middle and t_1, t_2.
    struct Blend {
        Vec3 middle, first, second;
    };
    template <typename Value>
    Blend blend(std::size_t corner, const Value& value) const {
        Blend all{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        for (int n = corner_[corner].begin; n < corner_[corner].end; ++n) {
            const Share& by = share_[std::size_t(n)];
            const Vec3 one = value(std::size_t(by.particle));
            all.middle += by.weight * one;
            all.first += by.first * one;
            all.second += by.second * one;
        }
        return all;
    }
    Vec3 rate(std::size_t corner, const Blend& of) const;  // of rates that of its place

    const Aggregate* of_;
    std::vector<ParticleId> particle_;
    std::vector<std::pair<std::uint64_t, int>> by_site_;  // key_of(); number in particle_
    int axis_ = -1, layer_ = 0;  // across which it is a layer, and where on it; -1: it is none
    Aggregate matter_;
    std::shared_ptr<const RestSurface> molded_;  // of what it has of the surface as molded
    std::shared_ptr<const CutSurface> ends_;     // of its cells
    std::vector<Share> share_;
    std::vector<Corner> corner_;
    std::vector<Frame> frame_;
    Vec3Array force_, before_, done_;  // done_: of particle_, in its order
};

}  // namespace swage
