// SPDX-License-Identifier: GPL-3.0-or-later
// Whole quasi-static solutions: a bar sagging under its weight, twisted, and bent in frames by its
// ends; and the product of the tangent that they are found with. usage: bench_equilibrium [name
// ...]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "sim/cell_tangent.h"
#include "sim/lattice_forces.h"
#include "verify/stand.h"

using namespace swage;

namespace {

double seconds_of(const auto& act) {
    const auto start = std::chrono::steady_clock::now();
    act();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool wanted(int argc, char** argv, const std::string& name) {
    for (int n = 1; n < argc; ++n) {
        if (argv[n] == name) return true;
    }
    return argc == 1;
}

// The bar 1 x 0.1 x 0.1 m, E 1 MPa, 1000 kg/m3, in sides and moduli.
void own_weight(int across, double g, double tip) {
    double got = 0;
    const double seconds = seconds_of([&] {
        Stand stand(unit_bar(10, across, unit_material()), 1e-6, {0, 0, -g * 1e-4});
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.move(stand.drive);
        got = mean_move(stand.matter, end_face(stand.matter, Vec3::UnitX())).z() / 10;
    });
    fmt::print("own weight, g {:4}, {} cells across: tip {:+.2f} %, {:.3f} s\n", g, across,
               100 * (got / tip - 1), seconds);
}

void twist(int across, int degrees_a_move) {
    double torque = 0;
    const double seconds = seconds_of([&] {
        Stand stand(unit_bar(10, across, unit_material()), 1e-3);
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.grip(end_face(stand.matter, Vec3::UnitX()));
        FrameReport report;
        for (int degrees = degrees_a_move; degrees <= 90; degrees += degrees_a_move) {
            Drive to = stand.drive;
            to.world_from_grip[1].rotation =
                Quat(Eigen::AngleAxisd(degrees * kPi / 180, Vec3::UnitX()));
            report = stand.move(to);
        }
        torque = report.load[1].torque.x() * 1e3;
    });
    fmt::print("twist by 90 degrees in moves of {}, {} cells across: torque {:+.2f} %, {:.3f} s\n",
               degrees_a_move, across, 100 * (torque / 8.865 - 1), seconds);
}

// Both ends turned and drawn together as a circular arc asks for.
void bend(int across, bool plastic) {
    Material material = unit_material();
    if (plastic) material.yield_stress = 0.01, material.hardening = 0.02;
    constexpr double kLength = 10;
    std::size_t particles = 0;
    int iterations = 0;
    const double seconds = seconds_of([&] {
        Stand stand(unit_bar(kLength, across, material), 1e-2);
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.grip(end_face(stand.matter, Vec3::UnitX()));
        particles = stand.matter.particle_count();
        for (int frame = 1; frame <= 100; ++frame) {
            const double t = 0.5 * kPi * frame / 100;  // between the ends
            const double chord = 2 * kLength / t * std::sin(t / 2);
            Drive to = stand.drive;
            for (int end = 0; end < 2; ++end) {
                const double side = end ? 1 : -1;
                to.world_from_grip[end] = {Quat(Eigen::AngleAxisd(side * t / 2, Vec3::UnitY())),
                                           Vec3(side * chord / 2, 0, 0)};
            }
            iterations += stand.move(to).iterations;
        }
    });
    fmt::print("bend by 90 degrees in 100 frames, {}, {} particles: {} iterations, {:.2f} s\n",
               plastic ? "plastic" : "elastic", particles, iterations, seconds);
}

// Nanoseconds a cell of the tangent's product, one thread.
void product(int across, bool plastic) {
    Material material = unit_material();
    if (plastic) material.yield_stress = 0.005, material.hardening = 0.02;
    Aggregate bar = unit_bar(10, across, material);
    for (std::size_t p = 0; p < bar.particle_count(); ++p) {
        const Vec3 x = bar.particle_reference.at(p);
        bar.particle_position.add(p, 0.02 * Vec3(std::sin(x.y()), std::sin(x.x()), x.z()));
    }
    LatticeForces forces(bar);
    forces.commit(bar);
    CellTangent tangent(bar, bar.cell_fill);
    const Vec3Array way = bar.particle_reference.all();
    Vec3Array result;
    std::vector<double> time;
    for (int n = 0; n < 15; ++n) {
        time.push_back(seconds_of([&] { tangent.product(bar, {}, way, result); }));
    }
    std::sort(time.begin(), time.end());
    fmt::print("tangent's product, {}, {} cells: {:.1f} ns a cell\n",
               plastic ? "plastic" : "elastic", bar.cell_fill.size(),
               time[time.size() / 2] * 1e9 / static_cast<double>(bar.cell_fill.size()));
}

}  // namespace

int main(int argc, char** argv) {
    if (wanted(argc, argv, "product")) {
        set_thread_count(1);
        for (int across : {8, 22}) {
            for (bool plastic : {false, true}) product(across, plastic);
        }
    }
    if (wanted(argc, argv, "weight")) {
        set_thread_count(1);
        for (const auto& [g, tip] : {std::pair{1.0, -0.1481}, {9.81, -0.7501}}) {
            for (int across : {4, 6, 8, 12}) own_weight(across, g, tip);
        }
    }
    if (wanted(argc, argv, "twist")) {
        set_thread_count(1);
        for (int degrees : {15, 30, 45}) twist(8, degrees);
    }
    if (wanted(argc, argv, "bend")) {
        set_thread_count(0);
        for (int across : {4, 8, 12}) {
            for (bool plastic : {false, true}) bend(across, plastic);
        }
    }
}
