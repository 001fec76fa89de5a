// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crushed_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "laws/spring_moduli.h"
#include "laws/volume_guard.h"
#include "sim/cell_volume.h"
#include "sim/flowed_stretch.h"
#include "sim/material_laws.h"

namespace swage {

namespace {

// |cof F|^2, 3 at rest: with more its volume makes a cell much stiffer than it was there.
constexpr double kSqueezed = 4.5;

Columns<double> columns(const Mat3& m) {
    return {{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}};
}

std::vector<MaterialLaw> guard_laws(const Aggregate& matter, Flow flow) {
    std::vector<MaterialLaw> laws = material_laws(matter, flow);
    for (std::size_t n = 0; n < laws.size(); ++n) {
        const Material& m = matter.material_at(n);
        if (m.mechanics != Mechanics::springs) continue;
        CellModuli& law = laws[n].moduli;
        law = cell_moduli(m.young_modulus, kPoissonOfSprings, law.spacing, law.yield_stress,
                          law.hardening);
    }
    return laws;
}

// Those of `found` that their guard acts on.
std::vector<SmallCell> crushed_of(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                                  std::vector<SmallCell> found) {
    std::erase_if(found, [&](const SmallCell& cell) {
        return !(cell.volume < guarded_volume(laws[matter.material_number(cell.id())]));
    });
    return found;
}

// One crushed cell.
struct Crushed {
    double volume;  // of its material [m3]
    GuardedCell guard;
    // The state that the cell's own law sees; `fades`: it gives way to the guard.
    bool fades;
    const CellModuli* law;
    double fill;
    Triple<double> at;
    CornerSums<double> sums;
    CellHistory<double> history{};
    Columns<double> gradient;  // F_e
    CellStrain<double> strain;
    bool shifts;  // has a back stress
    BackStrain<double> back{};
    BackFlowed<double> flowed{};

    Crushed(const Aggregate& matter, const std::vector<MaterialLaw>& laws, const SmallCell& cell) {
        const CellId id = cell.id();
        const MaterialLaw& own = laws[matter.material_number(id)];
        const double a = matter.lattice.spacing;
        law = &own.moduli;
        fades = matter.material.mechanics == Mechanics::cells && !knows_inside(own.kind) &&
                matter.mixed_at(id) == nullptr;
        shifts = own.kind == CellKind::kinematic;
        fill = matter.cell_fill[id];
        volume = fill * a * a * a;
        at = material_place(matter, id);
        sums = corner_sums(matter, *cell.run, cell.n);
        if (fades) history = committed_history(matter, id);
        gradient = centroid_gradient(sums, at, a) * taken_back(history);
        guard = guard_cell({matter.material_of(id).young_modulus, law->shear, law->bulk, fades,
                            guarded_volume(own)},
                           matrix_of(gradient));
        if (!fades) return;
        strain = cell_strain(gradient);
        const CellModes<double> modes = pulled_back(gradient, sums);
        if (shifts) {
            back = committed_back(matter, id);
            flowed = flow_with_back(*law, history, back, strain.log, modes, fill);
        } else {
            const CellFlowed<double> r = flow_cell(*law, history, strain.log, modes, fill);
            static_cast<CellReturn<double>&>(flowed) = r;
            flowed.distortion = r.distortion, flowed.modes = r.modes;
            flowed.mode_stress = r.mode_stress, flowed.kept_modes = r.kept_modes;
            flowed.alone = r.alone;
        }
    }

    // Of the cell's own law: what it holds, and besides what the flow on trial takes.
    double stored() const { return strain_energy(*law, strain); }
    double spent() const {
        return stored() - (shifts ? saved_by_flow(*law, history.alpha, back, fill, flowed)
                                  : saved_by_flow(*law, history.alpha, flowed) +
                                        saved_by_flow(*law, flowed.alone));
    }

    double energy() const {
        return volume * (guard.energy - (fades ? guard.share * stored() : 0.0));
    }

    // On the sums of the corners. The modes do not fade: they only stop flowing.
    CornerSums<double> forces() const {
        Mat3 stress = guard.stress;
        CellModes<double> modes{};
        if (fades) {
            Symmetric<double> own = cell_stress(*law, strain, flowed.kept);
            if (shifts) {
                own = own + material_stress(strain, (2 * law->shear * flowed.lent) * back.strain);
            }
            stress -= guard.share * matrix_of(gradient * own) + spent() * guard.share_slope;
            const double part = guard.share * mode_fill(fill);
            modes = (part * (1 - flowed.kept_modes)) * flowed.mode_stress;
            if (shifts) modes = modes - (part * flowed.lent) * flowed.back_stress;
        }
        const Symmetric<double> a = taken_back(history);
        return sum_forces(sums, gradient, a, columns(volume * stress) * a, modes, at, law->spacing);
    }
};

int resist(const Aggregate& matter, Flow flow, const std::vector<SmallCell>& small,
           Vec3Array& force) {
    if (small.empty()) return 0;
    const std::vector<MaterialLaw> laws = guard_laws(matter, flow);
    int mirrored = 0;
    for (const SmallCell& cell : crushed_of(matter, laws, small)) {
        mirrored += cell.volume < 0;
        double own[3][8];
        spread_corners(Crushed(matter, laws, cell).forces(), own);
        for (int c = 0; c < 8; ++c) {
            force.add(cell.run->corner(cell.n, c), {own[0][c], own[1][c], own[2][c]});
        }
    }
    return mirrored;
}

}  // namespace

int add_guard_forces(const Aggregate& matter, Flow flow, Vec3Array& force) {
    return resist(matter, flow, cells_below(matter, kGuardedVolume), force);
}

int add_guard_forces(const Aggregate& matter, Flow flow,
                     const std::vector<std::vector<const CellRun*>>& crushed, Vec3Array& force) {
    std::vector<SmallCell> found;
    for (const std::vector<const CellRun*>& part : crushed) {
        for (const CellRun* run : part) add_cells_below(matter, *run, kGuardedVolume, found);
    }
    return resist(matter, flow, found, force);
}

double guard_energy_of(const Aggregate& matter) {
    const std::vector<SmallCell> small = cells_below(matter, kGuardedVolume);
    if (small.empty()) return 0;
    const std::vector<MaterialLaw> laws = guard_laws(matter, Flow::none);
    double sum = 0;
    for (const SmallCell& cell : crushed_of(matter, laws, small))
        sum += Crushed(matter, laws, cell).energy();
    return sum;
}

// NOTE: what the guard's law gives back to matter that was turned inside out is ten times what
// would tear it apart, so it is taken on the way.
double calm_crushed(Aggregate& matter, double keep) {
    double taken = 0;
    const std::vector<MaterialLaw> laws = guard_laws(matter, Flow::none);
    for (const SmallCell& cell : crushed_of(matter, laws, cells_below(matter, kGuardedVolume))) {
        std::array<std::size_t, 8> p;
        double mass = 0;
        Vec3 center = Vec3::Zero(), drift = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
            p[c] = static_cast<std::size_t>(cell.run->corner(cell.n, c));
            const double m = matter.particle_mass[p[c]];
            mass += m;
            center += m * matter.particle_position.at(p[c]);
            drift += m * matter.particle_velocity.at(p[c]);
        }
        center /= mass;
        drift /= mass;
        Mat3 inertia = Mat3::Zero();
        Vec3 spin = Vec3::Zero();
        for (std::size_t q : p) {
            const Vec3 r = matter.particle_position.at(q) - center;
            inertia +=
                matter.particle_mass[q] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
            spin += matter.particle_mass[q] * r.cross(matter.particle_velocity.at(q));
        }
        const double trace = inertia.trace();
        if (!(trace > 0) || !std::isfinite(trace)) continue;
        inertia.diagonal().array() += 1e-12 * trace;
        const Vec3 turn = solve_symmetric(inertia, spin);
        for (std::size_t q : p) {
            const Vec3 rigid = drift + turn.cross(matter.particle_position.at(q) - center);
            const Vec3 v = matter.particle_velocity.at(q), calmed = rigid + keep * (v - rigid);
            taken += 0.5 * matter.particle_mass[q] * (v.squaredNorm() - calmed.squaredNorm());
            matter.particle_velocity.set(q, calmed);
        }
    }
    return taken;
}

void add_guard_stiffness(const Aggregate& matter, std::vector<double>& stiffness) {
    const std::vector<MaterialLaw> laws = guard_laws(matter, Flow::none);
    const double a = matter.lattice.spacing;
    const auto add = [&](const CellRun& run, int n, double own) {
        for (int c = 0; c < 8; ++c) stiffness[run.corner(n, c)] += own;
    };
    for (const SmallCell& cell : cells_below(matter, 0)) {
        const CellModuli& law = laws[matter.material_number(cell.id())].moduli;
        const double volume = matter.cell_fill[cell.id()] * a * a * a;
        add(*cell.run, cell.n,
            thinned(flowed_stretch(matter, cell.id())) * volume *
                guard_stiffness({0, law.shear, law.bulk, true}) / (2 * a * a));
    }
    if (matter.material.mechanics == Mechanics::springs) return;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId id = run.first + n;
            const Mat3 flowed = flowed_stretch(matter, id),
                       f = material_gradient(matter, run, n) * flowed;
            const Vec3 x = f.col(1).cross(f.col(2)), y = f.col(2).cross(f.col(0)),
                       z = f.col(0).cross(f.col(1));
            const double cofactor = x.squaredNorm() + y.squaredNorm() + z.squaredNorm();
            const MaterialLaw& law = laws[matter.material_number(id)];
            const bool foam = law.kind == CellKind::foam;
            if (!foam && cofactor < kSqueezed) continue;
            if (!cell_is_sound(matter, id, run.row_at(n))) continue;
            const double volume = f.col(0).dot(x), slope = guarded_strain(volume).slope;
            const double more = foam
                                    ? foam_stiffening(law.moduli, volume, f.squaredNorm(), cofactor)
                                    : law.moduli.bulk * (cofactor * slope * slope - 3);
            if (!(foam || volume > 0) || !(more > 0)) continue;
            add(run, n, 0.5 * matter.cell_fill[id] * a * more * thinned(flowed));
        }
    }
}

}  // namespace swage
