// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of several materials that are molded anew.
#include <cmath>

#include "geometry/mesh_write.h"
#include "matter/material_volumes.h"
#include "pipeline/work_piece.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::box_mesh;

namespace {

const Vec3 kSize(0.4, 0.1, 0.1);

InputMesh bar() {
    InputMesh input;
    input.mesh = box_mesh(-0.5 * kSize, 0.5 * kSize);
    return input;
}

InsetSpec box_inset(const Vec3& from, const Vec3& to, double density = 3000) {
    InsetSpec inset;
    inset.from = from, inset.to = to;
    inset.material.density = density;
    return inset;
}

BodySpec body_of(std::vector<InsetSpec> insets, int across) {
    BodySpec body;
    body.material.density = 1000;
    body.inset = std::move(insets);
    body.mold.across = across;
    return body;
}

// Along all of it, and of no whole cells.
InsetSpec core() { return box_inset({0, 0.27, 0.31}, {1, 0.71, 0.64}); }
InsetSpec layer() { return box_inset({0, 0.43, 0}, {1, 1, 1}); }
InsetSpec lump() { return box_inset({0.3, 0.22, 0.17}, {0.66, 0.73, 0.87}); }

WorkPiece make(const BodySpec& body, SkinKind kind = SkinKind::mount) {
    return make_work_piece(bar(), body, {kind}, true);
}

double volume_of(const InsetSpec& inset) { return (inset.to - inset.from).prod() * kSize.prod(); }

const double kRadius = kSize.x() / (kPi / 2);

// Round a quarter of a ring.
void bend_round(WorkPiece& piece) {
    test::deform(piece.matter, [](const Vec3& x) {
        const double turn = x.x() / kRadius, radius = kRadius + x.y();
        return Vec3(radius * std::sin(turn), radius * std::cos(turn), x.z());
    });
    follow_matter(piece);
}

// Of what lies between two heights, once it is bent.
double bent_volume(const InsetSpec& inset) {
    const double middle = (0.5 * (inset.from.y() + inset.to.y()) - 0.5) * kSize.y();
    return volume_of(inset) * (1 + middle / kRadius);
}

void check_masses(const Aggregate& before, const Aggregate& after) {
    const std::vector<double> had = material_masses(before), has = material_masses(after);
    REQUIRE(has.size() == had.size());
    for (std::size_t m = 0; m < had.size(); ++m) CHECK(has[m] == Approx(had[m]).epsilon(1e-6));
    CHECK(after.mass() == Approx(before.mass()).epsilon(1e-9));
}

}  // namespace

TEST_CASE("what is molded anew unloaded has as much of each material, however often") {
    for (const InsetSpec& inset : {core(), layer(), lump()}) {
        const BodySpec body = body_of({inset}, 4);
        WorkPiece piece = make(body);
        const Aggregate first = piece.matter;
        for (int n = 0; n < 3; ++n) {
            piece = mold_anew(piece, body, {}, true);
            const double has = material_volumes(piece.matter)[1];
            CHECK(has == Approx(volume_of(inset)).epsilon(1e-6));
            CHECK(has == Approx(material_volumes(first)[1]).epsilon(1e-6));
            check_masses(first, piece.matter);
            CHECK(piece.matter.mixed_cell.size() == first.mixed_cell.size());
        }
    }
}

TEST_CASE("of what was bent each material has the room that it was bent to", "[stress]") {
    const int finer = GENERATE(0, 1);
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    for (const InsetSpec& inset : {core(), layer(), lump()}) {
        for (int across : {4, 8}) {
            const BodySpec body = body_of({inset}, across);
            InputMesh input = bar();
            if (finer != 0) input.mesh = divide_edges(input.mesh, 0.4 * kSize.y() / across);
            WorkPiece piece = make_work_piece(input, body, {kind}, true);
            bend_round(piece);
            const WorkPiece anew = mold_anew(piece, body, {kind});
            const double has = material_volumes(anew.matter)[1];
            CHECK(has == Approx(bent_volume(inset)).epsilon(across == 4 ? 0.008 : 0.0015));
            check_masses(piece.matter, anew.matter);
            // Its surface is not that of the skin, and leaves nothing between them.
            const double more =
                double(anew.matter.mixed_cell.size()) / double(piece.matter.mixed_cell.size());
            CHECK(more < 1.6);
            CHECK(anew.inset.empty());
        }
    }
}

TEST_CASE("what reaches far out of a body bends with it and is molded anew") {
    const Scratch scratch;
    InsetSpec far = layer();
    far.file = scratch.path() / "far.obj";
    write_obj(far.file, box_mesh({-3, -0.007, -5}, {2, 4, 3}));  // as layer() has it
    for (int across : {4, 8}) {
        const BodySpec body = body_of({far}, across);
        WorkPiece piece = make(body);
        bend_round(piece);
        const WorkPiece anew = mold_anew(piece, body, {});
        const double has = material_volumes(anew.matter)[1];

        CHECK(has == Approx(bent_volume(layer())).epsilon(across == 4 ? 0.008 : 0.0015));
        CHECK(anew.finding.empty());
    }
}

TEST_CASE("of insets that overlap the last counts in what is molded anew too") {
    const BodySpec body = body_of({lump(), box_inset({0.5, 0.1, 0.4}, {0.8, 0.6, 0.6}, 7000)}, 6);
    WorkPiece piece = make(body);
    const Aggregate first = piece.matter;
    for (int n = 0; n < 2; ++n) {
        piece = mold_anew(piece, body, {}, true);
        const std::vector<double> had = material_volumes(first),
                                  has = material_volumes(piece.matter);
        REQUIRE(has.size() == 3);
        for (int m = 0; m < 3; ++m) CHECK(has[m] == Approx(had[m]).epsilon(1e-6));
        check_masses(first, piece.matter);
        CHECK(piece.matter.material_at(2).density == Approx(7000).epsilon(1e-5));
    }
}

namespace {

// Cut along a plane, what lies on its positive side moved by that much.
void part(WorkPiece& piece, const Vec3& point, const Vec3& normal, const Vec3& apart) {
    const Vec3 across = normal.unitOrthogonal(), up = normal.cross(across);
    const auto corner = [&](double u, double v) -> Vec3 { return point + u * across + v * up; };
    cut_skins(piece, {{corner(-1, -1), corner(1, -1), corner(1, 1)},
                      {corner(-1, -1), corner(1, 1), corner(-1, 1)}});
    test::sever_plane(piece.matter, point, normal);
    for (std::size_t p = 0; p < piece.matter.particle_count(); ++p) {
        if (normal.dot(piece.matter.particle_reference.at(p) - point) > 0) {
            piece.matter.particle_position.add(p, apart);
        }
    }
    show_matter(piece, true);
}

}  // namespace

TEST_CASE("what was cut through its insets is molded anew with them, closed where they were cut",
          "[stress]") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY();
    for (const InsetSpec& inset : {core(), layer(), lump()}) {
        for (const Vec3& normal : {x, y, Vec3(Vec3(2, 1, 0.4).normalized())}) {
            INFO(normal.transpose());
            const BodySpec body = body_of({inset}, 6);
            WorkPiece piece = make(body, kind);
            part(piece, {0.011, 0.003, 0}, normal, 0.13 * normal);
            REQUIRE(find_pieces(piece.matter).count == 2);
            for (const CarriedInset& one : piece.inset) CHECK(test::is_closed(one.mesh));
            const WorkPiece anew = mold_anew(piece, body, {kind}, true);
            CHECK(find_pieces(anew.matter).count == 2);
            const double has = material_volumes(anew.matter)[1];

            CHECK(has == Approx(volume_of(inset)).epsilon(0.01));
            check_masses(piece.matter, anew.matter);
        }
    }
}

TEST_CASE("what broke through its insets is molded anew with them") {
    const BodySpec body = body_of({core()}, 6);
    WorkPiece piece = make(body);
    Aggregate& m = piece.matter;
    for (ConnectionArrays& all : m.connection) all.damage.resize(m.particle_count());
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if ((m.particle_reference.at(lower).x() < 0.03) ==
                (m.particle_reference.at(upper).x() < 0.03))
                continue;
            m.connection[span.direction].weight.set(lower, 0);
            m.connection[span.direction].damage[lower] = 1;
        }
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        if (m.particle_reference.at(p).x() > 0.03) m.particle_position.add(p, {0.2, 0, 0});
    }
    show_matter(piece, true);
    const WorkPiece anew = mold_anew(piece, body, {});
    const double has = material_volumes(anew.matter)[1];

    CHECK(has == Approx(volume_of(core())).epsilon(0.02));
    check_masses(piece.matter, anew.matter);
}

TEST_CASE("an inset that a folded path has cut is not molded anew, and one beside it is") {
    const Vec3 a(0, -1, -1), b(0, 0, -1), c(0.2, -1, -1), up(0, 0, 2);
    const std::vector<std::array<Vec3, 3>> bent = {
        {a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}};
    const auto anew_of = [&](const InsetSpec& inset) {
        const BodySpec body = body_of({inset}, 4);
        WorkPiece piece = make(body);
        cut_skins(piece, bent);
        mold_anew(piece, body, {});
    };
    CHECK_THROWS_WITH(
        anew_of(core()),
        "cannot mold anew: a blade's path turns back over itself within inset 1, which cannot be "
        "cut along it");
    CHECK_NOTHROW(anew_of(box_inset({0.8, 0.2, 0.2}, {1, 0.8, 0.8})));
}

TEST_CASE("an inset that a bent path has cut keeps its volume in what is molded anew") {
    const BodySpec body = body_of({core()}, 6);
    WorkPiece piece = make(body);
    Aggregate& m = piece.matter;
    const auto edge = [](double y) { return 0.0137 + 0.3 * std::abs(y); };
    const Vec3 a(edge(-1), -1, -1), b(edge(0), 0, -1), c(edge(1), 1, -1), up(0, 0, 2);
    const CutResult cut = cut_skins(
        piece, {{a, b, b + up}, {a, b + up, a + up}, {b, c, c + up}, {b, c + up, b + up}});
    CHECK(!cut.has_folded);
    CHECK(cut.open_parts == 0);
    const auto is_beyond = [&](ParticleId p) {
        const Vec3 at = m.particle_reference.at(p) - m.lattice.spacing * Vec3(1.3e-6, 1.7e-6, 9e-7);
        return at.x() > edge(at.y());
    };
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            if (is_beyond(span.lower + n) == is_beyond(span.upper + n)) continue;
            m.connection[span.direction].weight.set(span.lower + n, 0);
        }
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        if (is_beyond(static_cast<ParticleId>(p))) m.particle_position.add(p, {0.4, 0, 0});
    }
    show_matter(piece, true);
    CHECK(test::is_closed(piece.skin));
    const WorkPiece anew = mold_anew(piece, body, {});
    CHECK(material_volumes(anew.matter)[1] == Approx(volume_of(core())).epsilon(1e-3));
    check_masses(piece.matter, anew.matter);
}

TEST_CASE("each material's flow, by its mass, stays as much in what was bent and is molded anew") {
    const auto flow = [](Aggregate& m, const auto& see) {
        const double cell = m.lattice.cell_volume();
        for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
            const auto id = static_cast<CellId>(c);
            if (m.mixed_at(id) != nullptr) continue;
            see(m.material_number(id), cell * m.cell_fill[c], m.cell_history.hardening()[c]);
        }
        for (MixedCell& mixed : m.mixed_cell) {
            const double whole =
                cell * m.cell_fill[mixed.cell] / (double(mixed.fill[0]) + mixed.fill[1]);
            for (int k : {0, 1}) {
                see(mixed.material[k], whole * mixed.fill[k], mixed.flowed[k].back());
            }
        }
    };
    const auto sums = [&](Aggregate& m) {
        std::vector<double> sum(2, 0.0);
        flow(m, [&](std::size_t material, double volume, float& hardening) {
            sum[material] += m.material_at(material).density * volume * hardening;
        });
        return sum;
    };
    const BodySpec body = body_of({lump()}, 6);
    WorkPiece piece = make(body);
    piece.matter.cell_history.assign(piece.matter.cell_fill.size());
    int number = 0;
    flow(piece.matter, [&](std::size_t material, double, float& hardening) {
        if (++number % 11 == 0) hardening = material == 0 ? 0.3f : 1.7f;
    });
    bend_round(piece);
    const std::vector<double> had = sums(piece.matter);
    for (int n = 0; n < 2; ++n) {
        piece = mold_anew(piece, body, {}, true);
        const std::vector<double> has = sums(piece.matter);
        for (int m : {0, 1}) CHECK(has[m] == Approx(had[m]).epsilon(1e-6));
    }
}
