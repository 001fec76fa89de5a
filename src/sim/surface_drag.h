// SPDX-License-Identifier: GPL-3.0-or-later
// What a medium around the work-piece does to its true surface, in motion but for implicit steps.
// Points of one cell follow one another: what the cell's corners do is read, and what they get is
// given, once for all of them.
#pragma once

#include <vector>

#include "laws/ambient_drag.h"
#include "laws/directional_drag.h"
#include "matter/aggregate.h"
#include "sim/laid_open.h"
#include "sim/settings.h"
#include "sim/vec4.h"

namespace swage {

class SurfaceDrag {
  public:
    // A drag that would stop a point's lightest carrier within a few steps of this length [s] is
    // bounded by what a step can follow.
    SurfaceDrag(const Aggregate& matter, const SimSettings& settings, double step);

    bool acts() const { return ambient_.density * ambient_.coefficient > 0 || facing_.drag > 0; }

    // A blade or a crack has changed which cells are whole: the medium flows past these only, and
    // past what was laid open.
    void connections_changed(const Aggregate& matter);
    // For steps of this length [s], and the masses that the particles have now.
    void find_limits(const Aggregate& matter, double step);

    struct Drag {
        double power = 0;      // that the forces take [W]
        bool bounded = false;  // somewhere
    };
    Drag add_forces(const Aggregate& matter, Vec3Array& force);
    // What these take at the present speeds [W].
    double power(const Aggregate& matter) const;
    const Vec3Array& given() const { return given_; }  // by them, to each particle [N]
    void put_back(const Vec3Array& given) { given_ = given; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(face_, given_);
        for (Cell& cell : cell_) io(cell.parted);
    }

  private:
    struct alignas(32) Patch {
        Vec4 place;  // in the cell; most force over speed [N s/m]
        Vec4 area;   // outward at molding, over the spacing squared
        std::array<double, 8> weight;
    };
    struct Cell {
        std::array<ParticleId, 8> corner;
        std::size_t first, end;  // patches
        bool parted = false;
    };
    struct Face {
        using IsPlain = Face;
        OpenFace open;
        double most;  // force over speed [N s/m]
    };
    struct Kernel;
    // `outward`: area vector [m2]; `most`: force over speed [N s/m].
    Vec3 force_on(const Vec3& outward, const Vec3& velocity, double most, bool& bounded) const;
    void add_open_forces(const Aggregate& matter, Vec3Array& force, Drag& sum);

    AmbientDrag ambient_;
    DirectionalDrag facing_;
    std::vector<Patch> patch_;
    std::vector<Cell> cell_;
    std::vector<std::array<Vec4, 8>> push_;  // of each cell's corners [N]
    std::vector<Drag> chunk_;
    double step_;  // [s]
    std::vector<Face> face_;
    Vec3Array given_;
};

}  // namespace swage
