// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/parted.h"
#include "sim/laid_open.h"
#include "sim/load_set.h"
#include "sim/surface_forces.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("pressure all round a body neither pushes nor turns it, however it is bent") {
    const auto ball = make_shape([](const Vec3& x) { return x.norm() - 0.31; },
                                 Vec3::Constant(-0.4), Vec3i(8, 8, 8), 0.1);
    for (Aggregate matter : {make_block(5, 3, 4, 0.1, kSoft), ball}) {
        deform(matter, crooked);
        Apparatus apparatus;
        apparatus.load.push_back(pressure_on(matter, 1e5));
        const LoadSet loads(apparatus, {});
        const Drive now = drive_of(apparatus, 1, 1);
        const double size = loads.size(matter, now);
        const LoadSum sum = loads.sums(matter, now).at(0);
        CHECK(sum.force.norm() < 1e-14 * size);
        CHECK(sum.torque.norm() < 1e-14 * size);
        Vec3Array force;
        force.resize(matter.particle_count());
        loads.add_forces(matter, now, force);
        Vec3 push = Vec3::Zero(), turn = Vec3::Zero();
        for (std::size_t p = 0; p < force.size(); ++p) {
            push += force.at(p);
            turn += matter.particle_position.at(p).cross(force.at(p));
        }
        // Weights that are floats sum to one as exactly as whoever made them saw to.
        const double exact = matter.surface.size() == ball.surface.size() ? 1e-8 : 1e-13;
        CHECK(push.norm() < exact * size);
        CHECK(turn.norm() < exact * size);
        // What had to be taken off for that is little.
        apparatus.load[0].closed = false;
        CHECK(LoadSet(apparatus, {}).sums(matter, now).at(0).force.norm() < 0.02 * size);
    }
}

TEST_CASE("pressure does not grow as the gap of a crack or a cut opens") {
    for (const bool closed : {false, true}) {
        Aggregate m = make_block(2, 3, 2, 0.1, kSoft);
        Apparatus apparatus;
        apparatus.load = {pressure_on(m, 100)};
        apparatus.load[0].closed = closed;
        LoadSet loads(apparatus, {});
        const Drive now = drive_of(apparatus, 0, 1);
        const auto force = [&] {
            Vec3Array f;
            f.x = f.y = f.z = std::vector<double>(m.particle_count(), 0.0);
            loads.add_forces(m, now, f);
            return f;
        };
        const double whole = loads.size(m, now);
        break_layer(m, 1);
        loads.connections_changed(m);
        CHECK(loads.size(m, now) == Approx(whole));
        const Vec3Array before = force();
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            if (m.particle_reference.at(p).y() > 0) m.particle_position.y[p] += 0.5;
        }
        const Vec3Array after = force();
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            CHECK((after.at(p) - before.at(p)).norm() < 1e-12);
        }
    }
}

TEST_CASE("pressure all round drives no piece and turns none, whatever has parted") {
    const auto ball = make_shape([](const Vec3& x) { return x.norm() - 0.31; },
                                 Vec3::Constant(-0.4), Vec3i(8, 8, 8), 0.1);
    for (Aggregate matter : {make_block(6, 4, 4, 0.1, kSoft), ball}) {
        Apparatus apparatus;
        apparatus.load.push_back(pressure_on(matter, 1e5));
        LoadSet loads(apparatus, {});
        const Drive now = drive_of(apparatus, 1, 1);
        const double size = loads.size(matter, now);
        sever_plane(matter, Vec3(0.013, 0, 0), Vec3(1, 0.4, 0.2).normalized());
        const Pieces pieces = find_pieces(matter);
        REQUIRE(pieces.count == 2);
        deform(matter, crooked);
        loads.connections_changed(matter);
        Vec3Array force;
        force.resize(matter.particle_count());
        loads.add_forces(matter, now, force);
        for (int piece = 0; piece < pieces.count; ++piece) {
            Vec3 push = Vec3::Zero(), turn = Vec3::Zero();
            for (std::size_t p = 0; p < force.size(); ++p) {
                if (pieces.particle_piece[p] != piece) continue;
                push += force.at(p);
                turn += matter.particle_position.at(p).cross(force.at(p));
            }
            CHECK(push.norm() < 1e-8 * size);
            CHECK(turn.norm() < 1e-8 * size);
        }
        // What had to be taken off for that is little: with the faces each piece is closed.
        std::vector<Vec3> sum(std::size_t(pieces.count), Vec3::Zero());
        double area = 0;
        for (std::size_t p = 0; p < matter.surface.size(); ++p) {
            if (is_parted(matter, p)) continue;
            const Vec3 own = surface_area_vector(matter, int(p));
            sum[pieces.particle_piece[matter.surface.row(p)[0]]] += own;
            area += own.norm();
        }
        for (const OpenFace& face : laid_open(matter)) {
            sum[pieces.particle_piece[face.corner[0]]] += face.outward(matter.particle_position);
        }
        // (Of the ball the fixture's own areas are too rough.)
        if (matter.surface.size() == ball.surface.size()) continue;
        for (const Vec3& one : sum) CHECK(one.norm() < 0.01 * area);
    }
}

TEST_CASE("pressure all round what is cut off presses the cut, whichever end it is of") {
    constexpr double kPressure = 1e3, kCut = 0.26;  // beside the cavity, in the cells that hold it
    for (const int axis : {0, 1, 2}) {
        Vec3 half = Vec3::Constant(0.31);
        half[axis] = 0.61;
        const auto distance = [&](const Vec3& x) {
            return std::max((x.cwiseAbs() - half).maxCoeff(), 0.23 - x.norm());
        };
        Vec3i count = Vec3i::Constant(8);
        count[axis] = 14;
        const Aggregate hollow = make_shape(distance, -0.05 * count.cast<double>(), count, 0.1);
        for (const double end : {-1, 1}) {
            CAPTURE(axis, end);
            Aggregate matter = hollow;
            Apparatus apparatus;
            Load& load = apparatus.load.emplace_back(pressure_on(matter, kPressure));
            std::erase_if(load.point, [&](int p) {
                return matter.surface_reference(std::size_t(p)).norm() < 0.27;
            });
            const Vec3 normal = end * Vec3::Unit(axis);
            sever_plane(matter, kCut * normal, normal);
            REQUIRE(find_pieces(matter).count == 2);
            LoadSet loads(apparatus, {});
            loads.connections_changed(matter);
            Vec3Array force;
            force.resize(matter.particle_count());
            loads.add_forces(matter, drive_of(apparatus, 1, 1), force);
            double away = 0;  // from the rest
            for (std::size_t p = 0; p < force.size(); ++p) {
                const double far = normal.dot(matter.particle_reference.at(p));
                if (far > kCut) away += std::max(normal.dot(force.at(p)), 0.0);
            }
            CHECK(away == Approx(kPressure * 0.62 * 0.62).epsilon(0.1));
        }
    }
}

TEST_CASE("a body that is cut under pressure all round stays as it is pressed") {
    const auto pressed = [](bool is_cut) {
        Aggregate matter = make_block(6, 4, 4, 0.1, kSoft);
        if (is_cut) sever_plane(matter, Vec3(0.013, 0, 0), Vec3::UnitX());
        Apparatus apparatus;
        apparatus.load.push_back(pressure_on(matter, 2e3));
        SimSettings settings;
        settings.solver = Solver::explicit_steps;
        const FrameReport report = put_on(matter, apparatus, settings, 4);
        return std::pair(matter, report);
    };
    const auto [whole, whole_report] = pressed(false);
    const auto [cut, report] = pressed(true);
    CHECK(report.pieces == 2);
    // The cells beside the cut hold the pressure that goes through the whole one.
    for (std::size_t p = 0; p < cut.particle_count(); ++p) {
        const double x = cut.particle_reference.at(p).x();
        if (std::abs(x) < 0.15) continue;
        const Vec3 a = cut.particle_position.at(p), b = whole.particle_position.at(p);
        CHECK((a - b).norm() < 0.02 * 0.1);
    }
    CHECK(std::abs(report.remainder) < 0.02 * report.load.at(0).work);
}

TEST_CASE("pressure follows the surface as the body turns") {
    Aggregate matter = make_block(3, 3, 3, 0.1, kSoft);
    Apparatus apparatus;
    apparatus.load.push_back(pressure_on(matter, 1e5));
    apparatus.load[0].point = points_where(matter, [](const Vec3& x) { return x.z() > 0.149; });
    apparatus.load[0].closed = false;
    const LoadSet loads(apparatus, {});
    const Eigen::AngleAxisd turn(2, Vec3(1, 2, 3).normalized());
    deform(matter, [&](const Vec3& x) { return Vec3(turn * Vec3(2 * x.x(), x.y(), x.z())); });
    const LoadSum sum = loads.sums(matter, drive_of(apparatus, 1, 0.5)).at(0);
    CHECK((sum.force - turn * Vec3(0, 0, -0.5 * 1e5 * 0.18)).norm() < 1e-6);
}

TEST_CASE("a body under pressure shrinks by p / K, and the pressure's work is p dV") {
    constexpr double kPressure = 2e3;
    Aggregate matter = make_block(4, 4, 4, 0.1, kSoft);
    Apparatus apparatus;
    apparatus.load.push_back(pressure_on(matter, kPressure));
    SimSettings settings;
    settings.tolerance = 1e-4;
    const FrameReport report = put_on(matter, apparatus, settings, 8);
    const double bulk = kSoft.young_modulus / (3 * (1 - 2 * kSoft.poisson_ratio));
    const double volume = 0.064, shrunk = volume * kPressure / bulk;
    CHECK(report.load_work == Approx(0.5 * kPressure * shrunk).epsilon(5e-3));
    CHECK(report.elastic == Approx(report.load_work).epsilon(5e-3));
    CHECK(std::abs(report.remainder) < 5e-3 * report.load_work);
}
