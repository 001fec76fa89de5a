// SPDX-License-Identifier: GPL-3.0-or-later
// What gives way under a body's surface where it is pressed: Young's modulus of the material just
// beneath; in motion its bulk modulus where that is more (Poisson's ratio above 1/3), for what hits
// matter that keeps its volume presses it before it flows aside. NOTE: with Young's modulus alone a
// rubber ball's contact gave eight times as much as the ball, and what fell on it sank half a cell
// in.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

double pressed_modulus(const Material& material, Solver solver);  // [Pa]

// Of each point [Pa]; empty where the body is of one material.
std::vector<double> surface_moduli(const Aggregate& matter, const SurfacePoints& points,
                                   Solver solver);

// The layer of cells beneath such points.
class SurfaceLayer {
  public:
    SurfaceLayer() = default;
    SurfaceLayer(const Aggregate& matter, const SurfacePoints& points, Solver solver)
        : spacing_(matter.lattice.spacing),
          pressed_(pressed_modulus(matter.material, solver)),
          modulus_(surface_moduli(matter, points, solver)) {}

    double modulus(std::size_t point) const {  // [Pa]
        return modulus_.empty() ? pressed_ : modulus_[point];
    }
    // So many times as stiff as the layer under what the point stands for [N/m].
    double stiffness(const SurfacePoints& points, std::size_t point, double times) const {
        return times * modulus(point) * points.area(point) / spacing_;
    }

    template <typename Io>
    void visit(Io& io) {
        io(spacing_, pressed_, modulus_);
    }

  private:
    double spacing_ = 1, pressed_ = 0;
    std::vector<double> modulus_;
};

// The mean over the body's surface [Pa].
double surface_modulus(const Aggregate& matter, Solver solver);

}  // namespace swage
