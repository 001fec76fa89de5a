// SPDX-License-Identifier: GPL-3.0-or-later
// Where a body's bytes are, a cell of a block: its arrays, and what the process holds (resident)
// with the matter alone and after explicit steps of it. usage: bench_bytes [cells]
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "sim/block_steps.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

double resident() {
    malloc_trim(0);
    long pages = 0, held = 0;
    std::FILE* file = std::fopen("/proc/self/statm", "r");
    if (file == nullptr || std::fscanf(file, "%ld %ld", &pages, &held) != 2) held = 0;
    if (file != nullptr) std::fclose(file);
    return static_cast<double>(held) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

template <typename... T>
double bytes_of(const std::vector<T>&... v) {
    return (0.0 + ... + static_cast<double>(v.capacity() * sizeof(T)));
}
double bytes_of(const Vec3Array& a) { return bytes_of(a.x, a.y, a.z); }

void body(const char* name, double wanted, const Material& material) {
    const double empty = resident();
    const int across = static_cast<int>(std::round(std::cbrt(wanted / 2.4)));
    Aggregate m = test::make_block(static_cast<int>(2.4 * across), across, across, 0.01, material);
    const double cells = static_cast<double>(m.cell_fill.size());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p) / 0.01;
        m.particle_position.add(p, 1e-4 * Vec3(std::sin(x.y()), std::cos(x.x()), std::sin(x.z())));
    }
    const double matter = resident();
    const Apparatus nothing;
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    BlockSolver solver({&m}, nothing, settings);
    Drive from, to;
    to.time = 2.5 * explicit_step(m, settings);
    solver.advance(from, to);
    const double stepped = resident();
    double weight = 0, plastic = 0, history = 0;
    for (const ConnectionArrays& c : m.connection) {
        weight += static_cast<double>(c.weight.bytes()), plastic += bytes_of(c.plastic);
        history += bytes_of(c.damage);
    }
    for (const auto& v : m.cell_history.row) history += bytes_of(v);
    for (const auto& v : m.cell_back.row) history += bytes_of(v);
    for (const auto& v : m.cell_plastic) history += bytes_of(v);
    fmt::print(
        "{:<9}{:>8.0f}{:>10.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>10.1f}{:>9.1f}{:>10.1f}"
        "{:>10.1f}\n",
        name, cells,
        (bytes_of(m.particle_position) + bytes_of(m.particle_velocity) +
         bytes_of(m.particle_mass)) /
            cells,
        weight / cells, plastic / cells,
        (bytes_of(m.cell_fill) + static_cast<double>(m.cell_centroid.bytes())) / cells,
        history / cells, static_cast<double>(m.surface.bytes()) / cells, (matter - empty) / cells,
        (stepped - empty) / cells);
}

}  // namespace

int main(int argc, char** argv) {
    const double cells = argc > 1 ? std::atof(argv[1]) : 1e6;
    fmt::print(
        "bytes a cell        x, v, m  weight  plastic  fill, c   history  surface  "
        "resident   stepped\n");
    const Material elastic{.young_modulus = 1e6, .poisson_ratio = 0.3, .damping_ratio = 0};
    Material flowing = elastic, springs = elastic, shifting;
    flowing.yield_stress = 1e3, flowing.hardening = 1e4;
    springs.mechanics = Mechanics::springs;
    body("elastic", cells, elastic);
    body("flowing", cells, flowing);
    shifting = flowing, shifting.back_stress = 500, shifting.back_strain = 0.01;
    body("shifting", cells, shifting);
    body("springs", cells, springs);
    springs.damping_ratio = 0.02;
    body("damped", cells, springs);
}
