// SPDX-License-Identifier: GPL-3.0-or-later
// Many pieces without a whole cell: what is far from each other has nothing to do with each other,
// and meets where it comes near.
#include "base/bytes.h"
#include "sim/advance.h"
#include "sim/thin_piece.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.1;

// Diced into so many strips a side, each two particles wide and one thick.
Aggregate diced(int strips) {
    Aggregate block = make_block(2 * strips - 1, 3, strips - 1, kCell, kSpringy);
    for (int n = 0; n + 1 < strips; ++n) {
        const double x = 2 * (n + 1) - strips, z = n + 1 - 0.5 * strips;
        sever_plane(block, Vec3(x * kCell, 0, 0), Vec3::UnitX());
        sever_plane(block, Vec3(0, 0, z * kCell), Vec3::UnitZ());
    }
    REQUIRE(thin_pieces(block).size() == std::size_t(strips * strips));
    return block;
}

SimSettings among_themselves(Solver solver) {
    SimSettings settings = motion_settings(solver);
    settings.self_contact = true;
    return settings;
}

}  // namespace

TEST_CASE("what is kept of contacts grows with the number of pieces, not with its square") {
    const auto kept = [](int strips) {
        Aggregate block = diced(strips);
        const Apparatus nothing;
        Simulation simulation(block, nothing, among_themselves(Solver::explicit_steps));
        simulation.advance(still(0), still(1e-4));
        ByteWriter out;
        simulation.save(out);
        return double(out.bytes().size());
    };
    // Of 5 a side 72 pairs are next to each other, of 10 a side 342.
    CHECK(kept(10) < 5.5 * kept(5));
}

TEST_CASE("strips that were far from each other meet, and a run that goes on does the same") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    Aggregate block = diced(3);
    const std::vector<std::vector<ParticleId>> strips = thin_pieces(block);
    // All are far apart, but for the first and the last, which go at each other.
    for (std::size_t n = 0; n < strips.size(); ++n) {
        for (ParticleId p : strips[n]) {
            const bool is_first = n == 0, is_last = n + 1 == strips.size();
            const Vec3 at = block.particle_position.at(p);
            const Vec3 middle = block.particle_reference.at(std::size_t(strips[n][0]));
            const Vec3 from = at - middle;
            if (is_first) block.particle_position.set(p, from);
            if (is_last) block.particle_position.set(p, from + Vec3(0.02, 0, 0.35));
            if (is_last) block.particle_velocity.set(p, Vec3(0, 0, -4));
            if (!is_first && !is_last) {
                block.particle_position.set(p, at + Vec3(0, 0, 3.0 * double(n)));
            }
        }
    }
    const Aggregate as_begun = block;
    const Apparatus nothing;
    Simulation simulation(block, nothing, among_themselves(solver));
    const auto speed = [&](std::size_t strip) {
        double sum = 0;
        for (ParticleId p : strips[strip]) sum += block.particle_velocity.at(p).z();
        return sum / double(strips[strip].size());
    };
    constexpr double kFrame = 1.0 / 128;
    const int frames = 24;
    std::vector<std::string> kept;
    std::vector<Aggregate> matter;
    for (int f = 0; f < frames; ++f) {
        ByteWriter out;
        simulation.save(out);
        kept.push_back(out.bytes());
        matter.push_back(block);
        simulation.advance(still(f * kFrame), still((f + 1) * kFrame));
    }
    CHECK(speed(0) < -1);  // struck
    CHECK(speed(strips.size() - 1) > -3);
    // From before they are near, while they are, and after.
    for (int from = 0; from < frames; from += 4) {
        CAPTURE(from);
        Aggregate again = as_begun;
        Simulation other(again, nothing, among_themselves(solver));
        again = matter[std::size_t(from)];
        ByteReader in(kept[std::size_t(from)]);
        other.load(in);
        for (int f = from; f < frames; ++f) {
            other.advance(still(f * kFrame), still((f + 1) * kFrame));
        }
        CHECK(state_hash(again) == state_hash(block));
    }
}
