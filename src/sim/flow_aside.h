// SPDX-License-Identifier: GPL-3.0-or-later
// How a body that flows goes aside, as a column does that is pressed beyond yield. Where all of a
// cell flows on, what varies within it of the strain along the flow meets the tangent modulus
// alone; the cell's law (laws/cell.h), which has one factor for mean and modes, holds the modes by
// their elastic stiffness. With m = dev E / |dev E|, what varies so along x, y, z is
//
//     P_x = m_yy xy_y + m_zz zx_z + m_yz (xy_z + zx_y)
//     P_y = m_xx xy_x + m_zz yz_z + m_zx (xy_z + yz_x)
//     P_z = m_xx zx_x + m_yy yz_y + m_xy (zx_y + yz_x)
//
// Modes p that flow along it, the gradients of P times l_x, l_y and l_z, take
// 3 mu / (3 mu + H) (g . q - g . p / 2) off a motion's energy, g = K p; most at the l that solve a
// system of three. A column whose load is beyond what its tangent modulus bears goes aside as fast
// as no part of it turns back (F. R. Shanley, "Inelastic column theory", J. Aeronaut. Sci. 14,
// 1947): that way it is led, its modes flowing along, until it goes by itself.
#pragma once

#include <vector>

#include "laws/cell.h"
#include "matter/aggregate.h"

namespace swage {

class FlowAside {
  public:
    // Of a body at rest that has not committed what it flows, and a motion of it.
    FlowAside(const Aggregate& matter, const Vec3Array& motion);

    // What the motion finds too stiff: twice that energy, of a tangent on trial [J].
    double borne() const;
    // How much of the motion strains what flows by as much as it flows, in the mean.
    double as_far_as_flow() const;
    // Modes of what had flowed before go along with so much of the motion.
    void commit(Aggregate& matter, double by) const;

  private:
    struct Cell {
        CellId id;
        double flows, strains;  // plastic strain, by the motion; times the fill
        double borne;           // [J]
        CellModes<double> modes;
    };
    std::vector<Cell> cell_;  // that flow
};

}  // namespace swage
