// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/matter_stress.h"

#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "laws/laminate.h"
#include "sim/cell_volume.h"
#include "sim/connection_shares.h"
#include "sim/cracking.h"
#include "sim/fracture_laws.h"
#include "sim/lattice_sweep.h"
#include "sim/material_laws.h"
#include "sim/mixed_cells.h"
#include "sim/rest_lengths.h"
#include "sim/strength_use.h"

namespace swage {

namespace {

constexpr std::size_t kCellsPerChunk = 256;
constexpr double kLeastVolume = 1e-3;  // of a cell, below which its stress means nothing

std::array<double, 6> components(const Mat3& s) {
    return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
}

// P and F to Cauchy's stress along axes that turn with the matter.
std::array<double, 6> turned_back(const Mat3& p, const Mat3& f) {
    const double volume = f.determinant();
    if (!(volume > kLeastVolume)) return {};
    const Mat3 turn = nearest_rotation(f);
    const Mat3 stress = turn.transpose() * (p * f.transpose()) * turn / volume;
    return components(0.5 * (stress + stress.transpose()));
}

// What springs bear beside the way they flow is no matter of their law. Where the back stress has
// another sense than flow has had so far matter bears more than its curve says, by what that has
// not seen of it.
double yields_at(const MaterialLaw& law, Mechanics mechanics, double plastic_strain) {
    if (!can_flow(law.kind) || mechanics == Mechanics::springs) {
        return std::numeric_limits<double>::infinity();
    }
    return mean_flow_stress(law.moduli, plastic_strain, 0) +
           law.moduli.back_stress * portable::exp(-law.moduli.back_rate * plastic_strain);
}

class Sampler {
  public:
    Sampler(const Aggregate& matter, Bears what)
        : matter_(matter),
          of_flow_(what == Bears::of_flow),
          law_(material_laws(matter)),
          fracture_(matter),
          stiffness_(lattice_stiffness(matter)) {
        for (std::size_t m = 0; m < matter.material_count(); ++m) {
            breaks_at_.push_back(breaks_at(matter.material_at(m), matter.lattice.spacing));
        }
    }

    void add(CellId cell, std::vector<StressSample>& to) const {
        const std::array<ParticleId, 8> corner = matter_.lattice.cell_corners(cell);
        const MixedCell* const two = matter_.mixed_at(cell);
        const bool springs = matter_.material.mechanics == Mechanics::springs;
        const bool sound = cell_is_sound(matter_, cell, matter_.lattice.cell_row(cell));
        if (springs || !sound) {
            add_springs(cell, corner, two, sound, to);
        } else if (two != nullptr) {
            const std::array<PartStress, 2> part = part_stresses(matter_, law_, *two);
            for (int p = 0; p < 2; ++p) {
                StressSample one = sample(cell, two->material[p], two->flowed[p].back());
                one.place += two->centroid[p].cast<double>();
                one.volume = two->fill[p];
                one.stress = turned_back(part[p].stress, part[p].gradient);
                to.push_back(one);
            }
        } else {
            to.push_back(of_one_material(cell, corner));
        }
    }

  private:
    StressSample sample(CellId cell, std::size_t material, double plastic_strain) const {
        StressSample one;
        one.cell = cell;
        one.material = static_cast<std::uint8_t>(material);
        one.place = matter_.lattice.cell_site(cell).cast<double>() + Vec3::Constant(0.5);
        one.plastic_strain = plastic_strain;
        one.yields_at = yields_at(law_[material], matter_.material.mechanics, plastic_strain);
        one.breaks_at = breaks_at_[material];
        return one;
    }

    CornerSums<double> sums_of(const std::array<ParticleId, 8>& corner) const {
        const Vec3Array& x = matter_.particle_position;
        double at[3][8];
        for (int c = 0; c < 8; ++c) {
            at[0][c] = x.x[corner[c]], at[1][c] = x.y[corner[c]], at[2][c] = x.z[corner[c]];
        }
        return sum_corners(at);
    }

    StressSample of_one_material(CellId cell, const std::array<ParticleId, 8>& corner) const {
        const std::size_t material = matter_.material_number(cell);
        StressSample one = sample(cell, material, matter_.cell_history.hardening_of(cell));
        one.place += matter_.cell_centroid[cell].cast<double>();
        one.volume = matter_.cell_fill[cell];
        const CornerSums<double> sums = sums_of(corner);
        // What has a back stress is within its surface, which is not looked at.
        const bool shifts = law_[material].kind == CellKind::kinematic;
        const Phase<double> phase{&law_[material].moduli,
                                  shifts ? CellKind::elastic : law_[material].kind, one.volume,
                                  material_place(matter_, cell), committed_history(matter_, cell)};
        const Columns<double> f = centroid_gradient(sums, phase.at, matter_.lattice.spacing);
        PhaseState<double> state;
        state.modes = pulled_back(f * taken_back(phase.history), sums);
        find_stress(phase, f, state);
        one.stress = turned_back(matrix_of(state.stress), matrix_of(f));
        if (of_flow_ && shifts) shift_back(cell, law_[material].moduli, one);
        return one;
    }

    // Of the axes of its history, which turn with the matter too.
    void shift_back(CellId cell, const CellModuli& law, StressSample& one) const {
        const BackStrain<double> back = committed_back(matter_, cell);
        const Symmetric<double>& b = back.strain;
        const std::array<double, 6> shift = {b.xx, b.yy, b.zz, b.xy, b.yz, b.zx};
        for (std::size_t i = 0; i < 6; ++i) one.stress[i] -= 2 * law.shear * shift[i];
        one.yields_at = yield_radius(law, one.plastic_strain);
    }

    // Of springs, what works of it.
    void scale_to_flow(CellId cell, StressSample& one) const {
        if (!of_flow_ || !matter_.yields()) return;
        one.yields_at = spring_flow_stress(matter_.material, one.plastic_strain);
        const auto& [xx, yy, zz, xy, yz, zx] = one.stress;
        const double mises = std::sqrt(
            0.5 * ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) +
            3 * (xy * xy + yz * yz + zx * zx));
        if (!(mises > 0)) return;
        const double works = spring_stress(matter_, cell, matter_.lattice.cell_row(cell));
        for (double& s : one.stress) s *= works / mises;
    }

    // A group of corners each: what a blade or a crack has parted bears nothing together.
    void add_springs(CellId cell, const std::array<ParticleId, 8>& corner, const MixedCell* two,
                     bool sound, std::vector<StressSample>& to) const {
        const bool springs = matter_.material.mechanics == Mechanics::springs;
        const CornerGroups groups = corner_groups(matter_, corner);
        const SlotLengths rest = springs ? SlotLengths{} : rest_lengths(matter_, cell, two);
        const CellSet* const set = matter_.set_of(cell);
        CornerMask seen = 0;
        for (const CornerMask group : groups) {
            if (group & seen) continue;
            seen |= group;
            StressSample one =
                sample(cell, matter_.material_number(cell), matter_.hardening_of(cell));
            one.corners = group;
            one.sound = sound;
            one.volume = matter_.cell_fill[cell] * __builtin_popcount(group) / 8.0;
            Mat3 virial = Mat3::Zero();
            for (int slot = 0; slot < kCellConnectionCount; ++slot) {
                const CellConnection& c = kCellConnection[slot];
                if (!(group >> c.corner & 1)) continue;
                double length = rest[slot] * (1 + (set ? double(set->strain[slot]) : 0));
                if (springs) {
                    length = reference_length(matter_.lattice, c.direction) *
                             (1 + matter_.connection[c.direction].plastic_of(corner[c.corner]));
                }
                virial += pull(cell, two, c, corner, length);
            }
            virial /= matter_.lattice.cell_volume() * one.volume;
            if (!sound) {
                one.stress = components(virial);
            } else if (const Mat3 f = gradient_of(corner); f.determinant() > kLeastVolume) {
                const Mat3 turn = nearest_rotation(f);
                one.stress = components(turn.transpose() * virial * turn / f.determinant());
                if (springs) scale_to_flow(cell, one);
            }
            to.push_back(one);
        }
    }

    // T d n n^T of the cell's share of one connection [J].
    Mat3 pull(CellId cell, const MixedCell* two, const CellConnection& c,
              const std::array<ParticleId, 8>& corner, double length) const {
        const ConnectionArrays& all = matter_.connection[c.direction];
        const ParticleId lower = corner[c.corner];
        if (!(all.weight[lower] > 0)) return Mat3::Zero();
        const Vec3 way = matter_.particle_position.at(corner[upper_corner(c)]) -
                         matter_.particle_position.at(lower);
        const double distance = way.norm();
        if (!(distance > 0)) return Mat3::Zero();
        // A pressed edge has all of its stiffness.
        const bool whole = distance < length && c.direction < kEdgeCount;
        const double lost = all.damage.empty() || whole ? 0 : all.damage[lower];
        double held =
            (1 - lost) * stiffness_in(matter_, cell, two, c.direction, fracture_.breaking());
        if (!fracture_.holding().empty()) {
            held += stiffness_in(matter_, cell, two, c.direction, fracture_.holding());
        }
        const double tension = stiffness_ * cell_share(c.direction) * held * (distance - length);
        return tension / distance * (way * way.transpose());
    }

    Mat3 gradient_of(const std::array<ParticleId, 8>& corner) const {
        return matrix_of(
            centroid_gradient(sums_of(corner), Triple<double>{0, 0, 0}, matter_.lattice.spacing));
    }

    const Aggregate& matter_;
    const bool of_flow_;
    const std::vector<MaterialLaw> law_;
    std::vector<double> breaks_at_;  // by material
    const FractureLaws fracture_;
    const double stiffness_;
};

}  // namespace

std::vector<StressSample> stress_samples(const Aggregate& matter, const std::vector<CellId>& cells,
                                         Bears what) {
    const Sampler sampler(matter, what);
    return parallel_collect<StressSample>(
        cells.size(), kCellsPerChunk,
        [&](std::size_t begin, std::size_t end, std::vector<StressSample>& found) {
            for (std::size_t n = begin; n < end; ++n) sampler.add(cells[n], found);
        });
}

}  // namespace swage
