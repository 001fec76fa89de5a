// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cracking.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/principal_axes.h"
#include "laws/strain_bound.h"
#include "sim/cell_batch.h"
#include "sim/cell_volume.h"
#include "sim/crack_path.h"
#include "sim/flowed_stretch.h"
#include "sim/mixed_cells.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 64;
// Cells whose strain is within this share of the largest go together: symmetric places do, and a
// fast crack needs fewer rounds.
constexpr double kTogether = 0.98;
constexpr double kSpared = 1.5;  // times onset
constexpr std::size_t kTracksAtOnce = 64;

// Largest principal strain where the cell's material is, less what has flowed.
double material_strain(const Aggregate& matter, const CellRun& run, int n, double least) {
    const Mat3 f = material_gradient(matter, run, n);
    Mat3 c = f.transpose() * f;
    if (matter.cell_history.empty()) {
        // No eigenvalue is farther from 1 than the whole of C - I is from 0.
        if ((c - Mat3::Identity()).norm() < 2 * least) return 0;
    } else {
        const Mat3 a = flowed_stretch(matter, run.first + n);
        c = a * c * a;
    }
    const double largest = principal_values(c)[2];
    return std::sqrt(largest) - 1;
}

// The same of a cell of two materials, of the one that is nearer to its onset, over this.
double mixed_share(const Aggregate& matter, const FractureLaws& laws,
                   const std::vector<MaterialLaw>& material, const MixedCell& two) {
    const std::array<double, 2> strain = largest_strains(matter, material, two);
    double most = 0;
    for (int p = 0; p < 2; ++p) {
        const double onset = laws.onset_of(two.material[p]);
        if (onset > 0) most = std::max(most, strain[p] / onset);
    }
    return most;
}

struct Beyond {
    const CellRun* run;
    int n;
    double share;  // of its onset that it is strained by
};

struct Candidate {
    StrainedCell at;
    double share;  // less for being off the track
};

// Of cells in line with each other the most strained is left, in the order of the cells.
std::vector<CellId> not_in_line(std::vector<Candidate> cells) {
    std::stable_sort(cells.begin(), cells.end(),
                     [](const Candidate& a, const Candidate& b) { return a.share > b.share; });
    std::vector<StrainedCell> taken;
    for (const Candidate& c : cells) {
        const bool spared = std::any_of(taken.begin(), taken.end(), [&](const StrainedCell& t) {
            return are_in_line(c.at, t);
        });
        if (!spared) taken.push_back(c.at);
    }
    std::vector<CellId> cell;
    for (const StrainedCell& t : taken) cell.push_back(t.cell);
    std::sort(cell.begin(), cell.end());
    return cell;
}

// Of the cells of a run.
SWAGE_VECTOR_CLONES
void strain_measures(const Aggregate& matter, const CellRun& run, std::vector<double>& measure) {
    const double a = matter.lattice.spacing, gram = 1 / (16 * a * a);
    const CornerRows rows = corner_rows(matter.particle_position, run);
    measure.resize(static_cast<std::size_t>(run.count + kFewLanes));
    for (int begin = 0; begin < run.count; begin += kFewLanes) {
        const int count = std::min(kFewLanes, run.count - begin);
        const FewLanes m = strain_measure(gather<FewLanes>(rows, begin, count), gram, kAnywhere);
        store(m, measure.data() + begin);
    }
}

double largest_connection_strain(const Aggregate& matter, const std::array<ParticleId, 4>& row) {
    const Vec3Array& x = matter.particle_position;
    double largest = 0;
    for (const CellConnection& c : kCellConnection) {
        const ParticleId lower = corner_particle(row, c.corner);
        const int high = upper_corner(c);
        const ParticleId upper = corner_particle(row, high);
        const double rest = reference_length(matter.lattice, c.direction) *
                            (1 + matter.connection[c.direction].plastic_of(lower));
        largest = std::max(largest, (x.at(upper) - x.at(lower)).squaredNorm() / (rest * rest));
    }
    return std::sqrt(largest) - 1;
}

// Sound cells beyond onset, in the order of the cells.
std::vector<Beyond> all_beyond(const Aggregate& matter, const FractureLaws& laws,
                               const std::vector<const CellRun*>* only,
                               const std::vector<float>* carried) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const std::size_t count = only ? only->size() : runs.size();
    const bool springs = matter.material.mechanics == Mechanics::springs;
    const double far = strain_measure_at(laws.watched_onset());
    const std::vector<MaterialLaw> material =
        matter.mixed_cell.empty() ? std::vector<MaterialLaw>() : material_laws(matter);
    const auto find = [&](std::size_t begin, std::size_t end, std::vector<Beyond>& beyond) {
        std::vector<double> measure;
        for (std::size_t r = begin; r < end; ++r) {
            const CellRun& run = only ? *(*only)[r] : runs[r];
            if (!springs) strain_measures(matter, run, measure);
            for (int n = 0; n < run.count; ++n) {
                const CellId cell = run.first + n;
                // Where a cell has flowed its connections do not tell its elastic strain.
                const bool far_off = !springs && measure[n] < far;
                if (far_off && !(matter.hardening_of(cell) > 0)) continue;
                if (carried && (*carried)[cell] <= 0) continue;
                const double onset = laws.of_cell(matter, cell).onset;
                if (!(onset > 0)) continue;
                const std::array<ParticleId, 4> row = run.row_at(n);
                if (!carried && !cell_is_sound(matter, cell, row)) continue;
                if (const MixedCell* two = matter.mixed_at(cell)) {
                    const double share = mixed_share(matter, laws, material, *two);
                    if (share >= 1) beyond.push_back({&run, n, share});
                    continue;
                }
                const double strain = breaking_strain(matter, run, n, onset);
                if (strain >= onset) beyond.push_back({&run, n, strain / onset});
            }
        }
    };
    return parallel_collect<Beyond>(count, kRunsPerChunk, find);
}

}  // namespace

double breaking_strain(const Aggregate& matter, const CellRun& run, int n, double least) {
    const CellId cell = run.first + n;
    const bool springs = matter.material.mechanics == Mechanics::springs;
    const bool flowed = !springs && matter.cell_history.hardening_of(cell) > 0;
    const double strain = springs ? 0 : material_strain(matter, run, n, least);
    if (flowed || matter.cell_centroid[cell].norm() >= kOffCentre) return strain;
    return std::max(strain, largest_connection_strain(matter, run.row_at(n)));
}

void find_strain_measures(const Aggregate& matter, const CellRun& run,
                          std::vector<double>& measure) {
    strain_measures(matter, run, measure);
}

double breaks_at(const Material& material, double spacing) {
    if (!material.breaks()) return material.strength;
    return strength_at(material.young_modulus, material.strength, material.toughness, spacing);
}

std::vector<const CellRun*> cells_beside(
    const Aggregate& matter, const std::vector<std::vector<const SpringRun*>>& particles) {
    const Lattice& lattice = matter.lattice;
    std::vector<const CellRun*> runs;
    for (const auto& slab : particles) {
        for (const SpringRun* run : slab) {
            for (int k = std::max(0, run->k - 1); k <= run->k && k < lattice.cell_count.z(); ++k) {
                for (int j = std::max(0, run->j - 1); j <= run->j && j < lattice.cell_count.y();
                     ++j) {
                    for (const CellRun& one : lattice.cell_runs(j, k)) runs.push_back(&one);
                }
            }
        }
    }
    std::sort(runs.begin(), runs.end());
    runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    return runs;
}

std::vector<CellId> cells_beyond_strength(const Aggregate& matter, const FractureLaws& laws,
                                          const std::vector<const CellRun*>* only,
                                          const std::vector<float>* carried) {
    std::vector<Beyond> beyond = all_beyond(matter, laws, only, carried);
    std::stable_sort(beyond.begin(), beyond.end(),
                     [](const Beyond& a, const Beyond& b) { return a.share > b.share; });
    // Being off the track only makes it less: those strained less than the largest by then are out.
    double largest = 1;
    std::vector<Candidate> all;
    for (std::size_t begin = 0; begin < beyond.size(); begin += kTracksAtOnce) {
        if (beyond[begin].share < kTogether * largest) break;
        const std::size_t count = std::min(kTracksAtOnce, beyond.size() - begin);
        std::vector<Candidate> some(count);
        parallel_for(count, [&](std::size_t n) {
            const Beyond& b = beyond[begin + n];
            const StrainedCell at = strained_cell(matter, *b.run, b.n);
            const bool spared = b.share < kSpared && is_beside_crack(matter, at);
            some[n] = {at, spared ? 0 : b.share / off_track_factor(matter, laws, at)};
        });
        for (const Candidate& c : some) largest = std::max(largest, c.share);
        all.insert(all.end(), some.begin(), some.end());
    }
    std::erase_if(all,
                  [&](const Candidate& c) { return c.share < 1 || c.share < kTogether * largest; });
    return not_in_line(std::move(all));
}

}  // namespace swage
