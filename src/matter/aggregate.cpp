// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/aggregate.h"

#include "base/hash.h"
#include "geometry/disjoint_sets.h"
#include "matter/cell_gradient.h"
#include "matter/connections.h"

namespace swage {

std::size_t Aggregate::connection_count() const {
    std::size_t count = 0;
    for (const ConnectionArrays& direction : connection) {
        for (std::size_t p = 0; p < direction.weight.size(); ++p) count += direction.weight[p] > 0;
    }
    return count;
}

double Aggregate::volume() const {
    double cells = 0;
    for (float fill : cell_fill) cells += fill;
    return cells * lattice.spacing * lattice.spacing * lattice.spacing;
}

bool Aggregate::breaks() const {
    return material.breaks() || std::any_of(inset.begin(), inset.end(),
                                            [](const Material& m) { return m.breaks(); });
}

bool Aggregate::yields() const {
    return material.yields() || std::any_of(inset.begin(), inset.end(),
                                            [](const Material& m) { return m.yields(); });
}

bool Aggregate::has_flowed() const {
    return !cell_history.empty() ||
           std::any_of(mixed_cell.begin(), mixed_cell.end(),
                       [](const MixedCell& cell) { return cell.hardening() > 0; });
}

float Aggregate::hardening_of(CellId cell) const {
    const MixedCell* mixed = mixed_at(cell);
    return std::max(mixed ? mixed->hardening() : 0, cell_history.hardening_of(cell));
}

double Aggregate::mean_modulus() const {
    if (inset.empty()) return material.young_modulus;
    double sum = 0, cells = 0;
    for (std::size_t c = 0; c < cell_fill.size(); ++c) {
        cells += cell_fill[c];
        if (const MixedCell* mixed = mixed_at(static_cast<CellId>(c))) {
            for (int m : {0, 1}) {
                sum += mixed->fill[m] * material_at(mixed->material[m]).young_modulus;
            }
        } else {
            sum += cell_fill[c] * material_of(static_cast<CellId>(c)).young_modulus;
        }
    }
    return sum / cells;
}

const MixedCell* Aggregate::mixed_at(CellId cell) const {
    const auto at = std::lower_bound(mixed_cell.begin(), mixed_cell.end(), cell,
                                     [](const MixedCell& m, CellId c) { return m.cell < c; });
    return at != mixed_cell.end() && at->cell == cell ? &*at : nullptr;
}

namespace {
std::ptrdiff_t place_of(const std::vector<CellSet>& all, CellId cell) {
    return std::lower_bound(all.begin(), all.end(), cell,
                            [](const CellSet& s, CellId c) { return s.cell < c; }) -
           all.begin();
}
}  // namespace

Aggregate::Aggregate() = default;
Aggregate::~Aggregate() = default;
Aggregate::Aggregate(const Aggregate&) = default;
Aggregate::Aggregate(Aggregate&&) noexcept = default;
Aggregate& Aggregate::operator=(const Aggregate&) = default;
Aggregate& Aggregate::operator=(Aggregate&&) noexcept = default;

const CellSet* Aggregate::set_of(CellId cell) const {
    const auto at = static_cast<std::size_t>(place_of(cell_set, cell));
    return at < cell_set.size() && cell_set[at].cell == cell ? &cell_set[at] : nullptr;
}

void Aggregate::lay_down(const CellSet& set) {
    const std::ptrdiff_t at = place_of(cell_set, set.cell);
    if (set_of(set.cell) != nullptr) {
        cell_set[static_cast<std::size_t>(at)] = set;
    } else {
        cell_set.insert(cell_set.begin() + at, set);
    }
}

double Aggregate::mass() const {
    double sum = 0;
    for (double m : particle_mass) sum += m;
    return sum;
}

Vec3 Aggregate::centre() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < particle_count(); ++p) {
        sum += particle_mass[p] * particle_position.at(p);
    }
    return sum / mass();
}

Vec3 Aggregate::mean_velocity() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < particle_count(); ++p) {
        sum += particle_mass[p] * particle_velocity.at(p);
    }
    return sum / mass();
}

Mat3 Aggregate::surface_gradient(std::size_t point) const {
    return cell_gradient(*this, surface.corner(point), surface.place(point));
}

namespace {
template <typename T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}
std::size_t bytes_of(const Vec3Array& a) { return bytes_of(a.x) + bytes_of(a.y) + bytes_of(a.z); }
}  // namespace

std::size_t Aggregate::bytes() const {
    std::size_t sum = bytes_of(lattice.particle_run) + bytes_of(lattice.span) +
                      bytes_of(lattice.cell_run) + bytes_of(lattice.cell_row_begin) +
                      bytes_of(particle_position) + bytes_of(particle_velocity) +
                      bytes_of(particle_mass) + bytes_of(cell_fill) + cell_centroid.bytes() +
                      bytes_of(cell_cracked) + bytes_of(cell_set) + bytes_of(inset) +
                      bytes_of(cell_material) + bytes_of(mixed_cell) + bytes_of(cut) +
                      surface.bytes();
    for (const std::vector<float>& slot : cell_plastic) sum += bytes_of(slot);
    for (const std::vector<float>& row : cell_history.row) sum += bytes_of(row);
    for (const std::vector<float>& row : cell_back.row) sum += bytes_of(row);
    for (const ConnectionArrays& direction : connection) {
        sum += direction.weight.bytes() + bytes_of(direction.plastic) + bytes_of(direction.damage);
    }
    for (const BranchMemory& memory : branch_memory) sum += bytes_of(memory.strain);
    return sum;
}

bool cell_is_whole(const Aggregate& matter, const std::array<ParticleId, 4>& row) {
    for (const CellConnection& c : kCellConnection) {
        if (matter.connection[c.direction].weight[corner_particle(row, c.corner)] <= 0) {
            return false;
        }
    }
    return true;
}

bool cell_is_sound(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row) {
    const bool cracked = !matter.cell_cracked.empty() && matter.cell_cracked[cell] != 0;
    return !cracked && cell_is_whole(matter, row);
}

Pieces find_pieces(const Aggregate& matter) {
    DisjointSets sets(matter.particle_count());
    for_each_connection(matter.lattice, matter.connection,
                        [&](ParticleId a, ParticleId b, float) { sets.unite(a, b); });
    Pieces pieces;
    pieces.count = sets.number_sets(pieces.particle_piece);
    return pieces;
}

std::uint64_t state_hash(const Aggregate& matter) {
    Hasher hasher;
    const auto add = [&](const Vec3Array& a) {
        hasher.add(std::span<const double>(a.x));
        hasher.add(std::span<const double>(a.y));
        hasher.add(std::span<const double>(a.z));
    };
    add(matter.particle_reference.all());
    add(matter.particle_position);
    add(matter.particle_velocity);
    hasher.add(std::span<const double>(matter.particle_mass));
    const std::vector<float> none(matter.connection[0].plastic.empty() ? matter.particle_count()
                                                                       : 0);
    for (const ConnectionArrays& direction : matter.connection) {
        hasher.add(std::span<const float>(direction.weight.all()));
        // Empty stands for zeros.
        hasher.add(std::span<const float>(direction.plastic.empty() ? none : direction.plastic));
        hasher.add(std::span<const float>(direction.damage));
    }
    for (const std::vector<float>& slot : matter.cell_plastic) {
        hasher.add(std::span<const float>(slot));
    }
    for (const std::vector<float>& row : matter.cell_history.row) {
        hasher.add(std::span<const float>(row));
    }
    if (!matter.cell_back.empty()) {
        for (const std::vector<float>& row : matter.cell_back.row) {
            hasher.add(std::span<const float>(row));
        }
    }
    for (const MixedCell& cell : matter.mixed_cell) {
        for (const auto& part : cell.flowed) hasher.add(std::span<const float>(part));
        hasher.add(std::span<const double>(cell.jump.data(), 3));
    }
    hasher.add(std::span<const char>(matter.cell_cracked));
    for (const CellSet& set : matter.cell_set) {
        hasher.add(std::span<const CellId>(&set.cell, 1));
        hasher.add(std::span<const float>(set.strain));
    }
    for (const BranchMemory& memory : matter.branch_memory) {
        hasher.add(std::span<const float>(memory.strain));
    }
    return hasher.value();
}

}  // namespace swage
