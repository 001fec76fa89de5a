// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/loose_springs.h"

#include <algorithm>
#include <cmath>

#include "laws/cell_rest.h"
#include "laws/spring_damper.h"
#include "sim/cell_volume.h"
#include "sim/connection_shares.h"
#include "sim/rest_lengths.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

// A broken edge that is pressed stands for the diagonals around it too: with 0.4 E a / (E a) of a
// plane's stiffness in its edges, a closed crack presses back as sound matter does.
constexpr double kClosedStiffness = 2.5;

// Halvings of a share that is looked for.
constexpr int kShareRounds = 40;

// The slot of the other diagonal in the face of each; -1: an edge.
constexpr std::array<int, kCellConnectionCount> kPartner = [] {
    std::array<int, kCellConnectionCount> partner{};
    partner.fill(-1);
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        for (int other = 0; other < kCellConnectionCount; ++other) {
            const auto &a = kCellConnection[slot], &b = kCellConnection[other];
            if (a.direction < kEdgeCount || b.direction < kEdgeCount || slot == other) continue;
            // Both run through the middle of their face.
            bool same = true;
            for (int axis = 0; axis < 3; ++axis) {
                same = same && 2 * (a.corner >> axis & 1) + kForward[a.direction][axis] ==
                                   2 * (b.corner >> axis & 1) + kForward[b.direction][axis];
            }
            if (same) partner[slot] = other;
        }
    }
    return partner;
}();

}  // namespace

LooseSprings::LooseSprings(const Aggregate& matter)
    : laws_(matter),
      beside_sweep_(matter.material.mechanics == Mechanics::springs),
      stiffness_(lattice_stiffness(matter)) {
    for (int d = 0; d < kForwardCount; ++d) reference_[d] = reference_length(matter.lattice, d);
}

void LooseSprings::connections_changed(const Aggregate& matter, const std::vector<float>* carried) {
    spring_.clear();
    if (beside_sweep_ && !laws_.break_any()) return;
    const auto is_sound = [&](const CellRun& run, int n) {
        if (carried) return (*carried)[run.first + n] > 0;
        return cell_is_sound(matter, run.first + n, run.row_at(n));
    };
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (!is_sound(run, n)) add_springs(matter, run, n);
        }
    }
    find_strains(matter, nullptr);
    commit_strains();
}

// A cell that is not sound gives its share of what its connections have left, as stiff as the
// materials in it; beside what breaks of it, what holds on has springs of its own.
void LooseSprings::add_springs(const Aggregate& matter, const CellRun& run, int n) {
    const CellId cell = run.first + n;
    const MixedCell* two = matter.mixed_at(cell);
    // Mechanics of springs have theirs in the sweep.
    const SlotLengths rest = beside_sweep_ ? SlotLengths{} : rest_lengths(matter, cell, two);
    const CellSet* const set = matter.set_of(cell);
    std::array<int, kCellConnectionCount> number;
    number.fill(-1);
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& c = kCellConnection[slot];
        const ParticleId lower = run.row[c.corner >> 1] + n + (c.corner & 1);
        const ConnectionArrays& all = matter.connection[c.direction];
        const double damage = all.damage.empty() ? 0.0 : double(all.damage[lower]);
        const bool holds = all.weight[lower] > 0;
        // Nothing presses on what a blade has severed.
        if (!holds && (damage < 1 || c.direction >= kEdgeCount)) continue;
        const int high = upper_corner(c);
        const ParticleId upper = run.row[high >> 1] + n + (high & 1);
        const auto add = [&](const Fracture& law, const MaterialMask& counts) {
            const double share = stiffness_in(matter, cell, two, c.direction, counts);
            if (!(share > 0)) return;
            const bool breaks = law.onset > 0;
            const int own = static_cast<int>(spring_.size());
            spring_.push_back(
                {.lower = lower,
                 .upper = upper,
                 .direction = static_cast<char>(c.direction),
                 .slot = static_cast<char>(slot),
                 .kind = !holds   ? Kind::closing
                         : breaks ? Kind::softening
                                  : Kind::elastic,
                 .cell = cell,
                 .stiffness = stiffness_ * (cell_share(c.direction) * share) *
                              (holds ? 1 : kClosedStiffness),
                 .rest_length = rest[slot] * (1 + (set ? double(set->strain[slot]) : 0)),
                 .worst = breaks ? worst_strain(law, damage) : 0.0,
                 .law = law,
                 .partner = own});
            if (breaks) number[slot] = own;
        };
        add(laws_.of_connection(c.direction, lower), laws_.breaking());
        if (!laws_.holding().empty()) add({}, laws_.holding());
    }
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const int other = kPartner[slot];
        if (number[slot] < 0 || other < 0 || number[other] < 0) continue;
        spring_[number[slot]].partner = number[other];
    }
}

// Each of the cell's springs is at rest when it is longer by the factor longer_by(n).
template <typename Factor>
void LooseSprings::lay_down(Aggregate& matter, CellId cell, const Factor& longer_by) {
    CellSet set{cell, {}};
    if (const CellSet* had = matter.set_of(cell)) set = *had;
    for (std::size_t n = 0; n < spring_.size(); ++n) {
        // Not twice where what breaks and what holds on have one each.
        if (n > 0 && spring_[n].slot == spring_[n - 1].slot) continue;
        float& kept = set.strain[spring_[n].slot];
        kept = static_cast<float>((1 + double(kept)) * longer_by(n) - 1);
    }
    matter.lay_down(set);
}

void LooseSprings::take_over(Aggregate& matter, const std::vector<TurnedCell>& turned) {
    const double a = matter.lattice.spacing;
    // Less than this is rounding [J].
    const double onset = laws_.least_onset();
    const double least = 1e-9 * stiffness_ * a * a * onset * onset;
    for (const TurnedCell& cell : turned) {
        spring_.clear();
        add_springs(matter, *cell.run, cell.n);
        find_strains(matter, nullptr);
        const std::vector<Stretch> now = now_;
        const Mat3 gradient = material_gradient(matter, *cell.run, cell.n);
        const Symmetric<double> metric =
            flowed_metric(committed_history(matter, cell.id()).stretch);
        const bool mixed = matter.mixed_at(cell.id()) != nullptr;
        std::vector<double> mean(now.size());  // strain that the material's is along each
        for (std::size_t n = 0; n < now.size(); ++n) {
            const auto& way = kForward[spring_[n].direction];
            const Vec3 along(way[0], way[1], way[2]);
            const Triple<double> t = {along.x(), along.y(), along.z()};
            // Two materials have one length along it, whatever each has flowed.
            const double rest = mixed ? now[n].length / a : std::sqrt(dot(t, metric * t));
            mean[n] = (gradient * along).norm() / rest - 1;
        }
        const auto strain = [&](std::size_t n, double bent, double all) {
            return all * (mean[n] + bent * (now[n].strain - mean[n]));
        };
        const auto excess = [&](double bent, double all) {
            for (std::size_t n = 0; n < now.size(); ++n) {
                now_[n].strain = strain(n, bent, all);
                now_[n].length = now[n].distance / (1 + now_[n].strain);
            }
            find_softening();
            commit_strains();
            return elastic_energy() + trial_loss() - cell.energy;
        };
        if (excess(1, 1) <= least) continue;
        double bent = 0, all = 1;
        const bool bends = excess(0, 1) <= 0;
        double& share = bends ? bent : all;
        double low = 0, high = 1;
        for (int round = 0; round < kShareRounds; ++round) {
            share = 0.5 * (low + high);
            (excess(bent, all) <= 0 ? low : high) = share;
        }
        share = low;
        lay_down(matter, cell.id(),
                 [&](std::size_t n) { return (1 + now[n].strain) / (1 + strain(n, bent, all)); });
    }
}

void LooseSprings::lay_down_pressed(Aggregate& matter) const {
    if (beside_sweep_) return;  // all that share a connection are as long at rest
    for (std::size_t n = 0; n < spring_.size(); ++n) {
        const Spring& s = spring_[n];
        const ConnectionArrays& all = matter.connection[static_cast<std::size_t>(s.direction)];
        const double strain = now_[n].strain;
        const bool breaks = s.kind != Kind::closing && s.direction < kEdgeCount &&
                            !(all.weight[s.lower] > 0) && !all.damage.empty() &&
                            all.damage[s.lower] >= 1;
        if (!breaks || !(strain < 0)) continue;
        // Not twice where what breaks and what holds on have one each.
        if (n > 0 && spring_[n - 1].cell == s.cell && spring_[n - 1].slot == s.slot) continue;
        CellSet set{s.cell, {}};
        if (const CellSet* had = matter.set_of(s.cell)) set = *had;
        float& kept = set.strain[s.slot];
        const double longer_by = 1 + strain - strain / std::sqrt(kClosedStiffness);
        kept = static_cast<float>((1 + double(kept)) * longer_by - 1);
        matter.lay_down(set);
    }
}

void LooseSprings::lay_to_rest(Aggregate& matter, const std::vector<TurnedCell>& turned) {
    for (const TurnedCell& cell : turned) {
        spring_.clear();
        add_springs(matter, *cell.run, cell.n);
        find_strains(matter, nullptr);
        lay_down(matter, cell.id(), [&](std::size_t n) { return 1 + now_[n].strain; });
    }
}

std::vector<char> LooseSprings::softening_ends(const Aggregate& matter) const {
    std::vector<char> ends;
    for (const Spring& s : spring_) {
        if (s.kind != Kind::softening) continue;
        ends.resize(matter.particle_count(), 0);
        ends[s.lower] = 1;
    }
    return ends;
}

std::vector<char> LooseSprings::ends(const Aggregate& matter) const {
    std::vector<char> ends(matter.particle_count(), 0);
    for (const Spring& s : spring_) ends[s.lower] = ends[s.upper] = 1;
    return ends;
}

void LooseSprings::find_strains(const Aggregate& matter, const RestStrains* rest) {
    const Vec3Array& x = matter.particle_position;
    now_.resize(spring_.size());
    const auto find = [&](std::size_t n) {
        const Spring& s = spring_[n];
        Stretch& now = now_[n];
        now.reach = x.at(s.upper) - x.at(s.lower);
        now.distance = now.reach.norm();
        now.length = s.rest_length;
        if (beside_sweep_) {
            const std::size_t d = static_cast<std::size_t>(s.direction);
            const double strain =
                rest ? double((*rest)[d][s.lower]) : matter.connection[d].plastic_of(s.lower);
            now.length = reference_[d] * (1 + strain);
        }
        now.strain = now.distance / now.length - 1;
    };
    for_each_chunk(spring_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) find(n);
    });
    find_softening();
}

void LooseSprings::find_softening() {
    for_each_chunk(spring_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const auto partner = static_cast<std::size_t>(spring_[n].partner);
            now_[n].softens_by =
                partner == n ? now_[n].strain : face_strain(now_[n].strain, now_[partner].strain);
        }
    });
}

void LooseSprings::commit_strains() {
    for_each_chunk(spring_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            spring_[n].strain = now_[n].strain;
            spring_[n].softens_by = now_[n].softens_by;
        }
    });
}

// What softening on from the committed history takes. A diagonal softens by the strain of its face
// and loses by its own: both go evenly from what they were, the losses' share between.
double LooseSprings::loss_of(std::size_t n) const {
    const Spring& s = spring_[n];
    if (s.kind != Kind::softening) return 0;
    const double by = now_[n].softens_by, strain = now_[n].strain;
    if (!(by > s.worst)) return 0;
    const auto own_share = [&](double worst) -> double {
        if (worst <= s.softens_by) return s.strain / s.softens_by;
        const double way = (worst - s.softens_by) / (by - s.softens_by);
        return (s.strain + way * (strain - s.strain)) / worst;
    };
    const double first = own_share(s.worst), last = own_share(std::min(by, s.law.broken));
    return s.stiffness * now_[n].length * now_[n].length *
           ((first * first + first * last + last * last) / 3) *
           (fracture_loss(s.law, by) - fracture_loss(s.law, s.worst));
}

void LooseSprings::add_forces(const Aggregate& matter, Flow flow, const RestStrains* rest,
                              Vec3Array& force) {
    find_strains(matter, rest);
    const auto pull_of = [&](std::size_t n) -> Vec3 {
        const Spring& s = spring_[n];
        const Stretch& now = now_[n];
        if (is_open(n)) return Vec3::Zero();
        double tension =
            spring_tension(SpringDamper{s.stiffness, 0, now.length}, now.distance, 0.0);
        if (s.kind == Kind::softening) {
            const double sound = tension;
            if (tension > 0 || s.direction >= kEdgeCount) {
                tension *= kept_share(s.law, flow == Flow::trial ? now_worst(n) : s.worst);
            }
            if (beside_sweep_) tension -= sound;
        }
        return tension / (now.distance + 1e-300) * now.reach;
    };
    pull_.resize(spring_.size());
    for_each_chunk(spring_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) pull_[n] = pull_of(n);
    });
    for (std::size_t n = 0; n < spring_.size(); ++n) {
        force.add(spring_[n].lower, pull_[n]);
        force.add(spring_[n].upper, -pull_[n]);
    }
}

Broken LooseSprings::commit(Aggregate& matter) {
    Broken result;
    if (!laws_.break_any()) return result;
    for (std::size_t n = 0; n < spring_.size(); ++n) {
        Spring& s = spring_[n];
        const double worst = now_worst(n);
        if (s.kind != Kind::softening || !(worst > s.worst)) continue;
        ConnectionArrays& all = matter.connection[static_cast<std::size_t>(s.direction)];
        if (all.damage.empty()) {
            for (auto& c : matter.connection) c.damage.assign(c.weight.size(), 0.0f);
        }
        const float damage = static_cast<float>(1 - kept_share(s.law, worst));
        result.lost += loss_of(n);
        all.damage[s.lower] = std::max(all.damage[s.lower], damage);
        if (damage >= 1 && all.weight[s.lower] > 0 && laws_.breaks_wholly(s.direction, s.lower)) {
            all.weight.set(s.lower, 0);
            ++result.count;
        }
    }
    // What one cell's part of a connection has lost, all have: the others give up what they held.
    for (std::size_t n = 0; n < spring_.size(); ++n) {
        Spring& s = spring_[n];
        const auto& damage = matter.connection[static_cast<std::size_t>(s.direction)].damage;
        if (damage.empty() || s.law.onset <= 0) continue;
        const double worst = worst_strain(s.law, damage[s.lower]);
        if (!(worst > s.worst)) continue;
        const double stored = stored_in(n);
        s.worst = worst;
        result.lost += stored - stored_in(n);
    }
    commit_strains();
    return result;
}

double LooseSprings::stored_in(std::size_t n) const {
    const Spring& s = spring_[n];
    const Stretch& now = now_[n];
    if (is_open(n)) return 0;
    double share = 1;
    if (s.kind == Kind::softening) {
        if (now.strain > 0 || s.direction >= kEdgeCount) share = kept_share(s.law, now_worst(n));
        if (beside_sweep_) share -= 1;
    }
    return share * spring_energy(SpringDamper{s.stiffness, 0, now.length}, now.distance);
}

double LooseSprings::sum_of(double (LooseSprings::*part)(std::size_t) const) const {
    double sum = 0;
    for (std::size_t n = 0; n < spring_.size(); ++n) sum += (this->*part)(n);
    return sum;
}

void LooseSprings::add_stiffness_bound(std::vector<double>& bound) const {
    for (const Spring& s : spring_) {
        if (beside_sweep_ && s.kind == Kind::softening) continue;  // the sweep's
        bound[s.lower] += 2 * s.stiffness;
        bound[s.upper] += 2 * s.stiffness;
    }
}

}  // namespace swage
