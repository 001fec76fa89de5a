// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/checkpoint.h"

#include <fstream>

#include "geometry/make_shape.h"
#include "pipeline/work_piece_bytes.h"
#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

void put_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}
std::string piece_bytes(const WorkPiece& piece) {
    ByteWriter out(true);
    out(piece);
    return out.bytes();
}

// With a value in everything that a piece may come to hold.
WorkPiece piece_that_went_through_all(SkinKind skin) {
    InputMesh input;
    input.mesh = make_shape("bar", {{"length", 0.4}, {"height", 0.1}, {"width", 0.2}}).mesh;
    input.mesh.material.resize(1);
    input.mesh.material[0].embedded_texture = std::make_shared<const std::string>("PNG and so on");
    BodySpec body;
    body.mold.across = 3;
    body.start.spin = {1, 2, 3};
    InsetSpec inset;
    inset.from = {0.2, 0.3, 0.3}, inset.to = {0.45, 0.8, 0.8};
    inset.material.name = "core";
    inset.material.flow_along({{0, 1e5}, {0.1, 2e5}});
    body.inset.push_back(inset);
    WorkPiece piece = make_work_piece(input, body, {skin}, true);
    piece.inset.at(0).is_torn = true;
    REQUIRE(piece.inset.at(0).look.name == "cut_core");
    Aggregate& m = piece.matter;
    REQUIRE(m.mixed_cell.size() > 2);
    const std::size_t particles = m.particle_count(), cells = m.cell_fill.size();
    m.mixed_cell[1].flowed[1][3] = 0.25f;
    m.mixed_cell[1].jump = {0.1, 0.2, 0.3};
    m.cell_history.assign(cells);
    m.cell_history.row[4][2] = 0.5f;
    m.cell_back.assign(cells);
    m.cell_back.row[7][2] = 0.25f;
    m.material.back_stress = 3e4, m.material.back_strain = 0.02;
    for (std::size_t s = 0; s < m.cell_plastic.size(); ++s)
        m.cell_plastic[s].assign(cells, 0.1f * s);
    for (ConnectionArrays& all : m.connection) {
        all.plastic.assign(particles, 0.01f);
        all.damage.assign(particles, 0.5f);
    }
    // Broken by load, all across.
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if ((m.particle_reference.at(lower).x() < 0.06) ==
                (m.particle_reference.at(upper).x() < 0.06))
                continue;
            m.connection[span.direction].weight.set(lower, 0);
            m.connection[span.direction].damage[lower] = 1;
        }
    }
    m.surface.set_side(3, 0x0f);
    m.cell_cracked.assign(cells, 0);
    m.cell_cracked[5] = 1;
    CellSet set{7, {}};
    set.strain[3] = 0.125f;
    m.lay_down(set);
    m.branch_memory.push_back({damping_branches(0.1, 10, 1e4), std::vector<float>(particles, 2)});
    for (std::size_t p = 0; p < particles; ++p) {
        m.particle_position.x[p] += 0.3 * m.particle_position.x[p];
    }
    show_matter(piece, true);
    piece.is_torn = true;
    piece.is_parted = true;
    piece.finding = {"a hole is lost"};
    if (skin == SkinKind::mount) {
        REQUIRE(piece.whole_skin);
        piece.mount.hold[3] = {1e-5, 0, 2e-5};
    }
    return piece;
}

// The run has finished two stages.
const StageKeys kKeys = {"begun", "one", "key", "more"};

Reached reached_with(std::vector<WorkPiece> bodies) {
    Reached reached;
    reached.stages = 2;
    reached.bodies = std::move(bodies);
    reached.contacts = std::string("all\0that touches", 16);
    reached.matter.push_back({{"cells", 5}, {"mass", 0.1}});
    reached.stage.push_back({{"name", "1-bend"}, {"ways", {1e-300, 0.1, -0.0}}});
    reached.start_warning = {"coarse"};
    reached.warning = {"odd \xff text", ""};
    reached.steps = 12345678901;
    reached.seconds = {{"mold", 0.5}};
    reached.motion = {1234, 5678};
    reached.foreseen = "more";
    reached.skin.assign(reached.bodies.size(), 3);
    return reached;
}

}  // namespace

TEST_CASE("what was kept of work-pieces comes back as it was, and goes on as they do") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "checkpoint.bin";
    Reached reached = reached_with({});
    for (SkinKind skin : {SkinKind::mount, SkinKind::frame4, SkinKind::boundary}) {
        reached.bodies.push_back(piece_that_went_through_all(skin));
    }
    reached.skin = {4, 0, 7};
    write_checkpoint(file, kKeys, reached);
    std::string why;
    std::optional<Reached> read = read_checkpoint(file, kKeys, why);
    INFO(why);
    REQUIRE(read);
    CHECK(read->stages == 2);
    CHECK(read->contacts == reached.contacts);
    CHECK(json_text(read->matter) == json_text(reached.matter));
    CHECK(json_text(read->stage) == json_text(reached.stage));
    CHECK(read->warning == reached.warning);
    CHECK(read->start_warning == reached.start_warning);
    CHECK(read->steps == reached.steps);
    CHECK(read->seconds == reached.seconds);
    CHECK(read->motion.size == 1234);
    CHECK(read->motion.hash == 5678);
    CHECK(read->skin == reached.skin);
    CHECK(read->foreseen == "more");
    REQUIRE(read->bodies.size() == 3);
    CHECK(state_hash(read->bodies) == state_hash(reached.bodies));
    for (std::size_t b = 0; b < 3; ++b) {
        WorkPiece &before = reached.bodies[b], &after = read->bodies[b];
        CHECK(piece_bytes(after) == piece_bytes(before));
        // What bytes would not tell if it were left out of them.
        CHECK(after.name == before.name);
        CHECK(after.finding == before.finding);
        CHECK(after.matter.surface.side(3) == 0x0f);
        CHECK(after.is_torn);
        CHECK(after.is_parted);
        CHECK(after.position == before.position);
        CHECK(after.followed.y == before.followed.y);
        CHECK(after.whole_skin.has_value() == before.whole_skin.has_value());
        CHECK(after.whole_position == before.whole_position);
        CHECK(after.whole_mount.reference == before.whole_mount.reference);
        CHECK(after.whole_mount.vertex == before.whole_mount.vertex);
        REQUIRE(after.inset.size() == 1);
        CHECK(after.inset[0].is_torn);
        CHECK(after.inset[0].mesh.position == before.inset[0].mesh.position);
        CHECK(after.inset[0].mesh.triangle == before.inset[0].mesh.triangle);
        CHECK(after.inset[0].position == before.inset[0].position);
        CHECK(after.inset[0].mount.reference == before.inset[0].mount.reference);
        CHECK(after.inset[0].mount.vertex == before.inset[0].mount.vertex);
        CHECK(after.mount.kind == before.mount.kind);
        CHECK(after.mount.hold == before.mount.hold);
        CHECK(after.mount.side == before.mount.side);
        CHECK(after.matter.surface == before.matter.surface);
        CHECK(after.matter.cell_fill == before.matter.cell_fill);
        CHECK(after.matter.cell_centroid.all() == before.matter.cell_centroid.all());
        CHECK(after.matter.cell_material == before.matter.cell_material);
        CHECK(after.matter.inset.at(0).yield_stress == 1e5);
        CHECK(after.matter.inset.at(0).flow_curve.at(1).strain == 0.1);
        CHECK(after.matter.inset.at(0).flow_curve.at(1).stress == 2e5);
        CHECK(after.matter.cell_back.row[7] == before.matter.cell_back.row[7]);
        CHECK(after.matter.material.back_stress == 3e4);
        CHECK(after.matter.material.back_strain == 0.02);
        CHECK(after.matter.lattice.cell_row_begin == before.matter.lattice.cell_row_begin);
        CHECK(after.matter.branch_memory.at(0).branches.time ==
              before.matter.branch_memory.at(0).branches.time);
        CHECK(after.matter.mixed_cell[1].normal == before.matter.mixed_cell[1].normal);
        CHECK(after.matter.mixed_cell[1].jump == before.matter.mixed_cell[1].jump);
        CHECK(after.mount.vertex == before.mount.vertex);
        CHECK(after.mount.particle == before.mount.particle);
        CHECK(after.mount.stencil.axis == before.mount.stencil.axis);
        CHECK((after.look != nullptr) == (before.look != nullptr));
        for (WorkPiece* piece : {&before, &after}) {
            for (std::size_t p = 0; p < piece->matter.particle_count(); p += 3) {
                piece->matter.particle_position.y[p] += 0.01;
            }
            show_matter(*piece, true);
        }
        CHECK(piece_bytes(after) == piece_bytes(before));
    }
}

TEST_CASE("images are kept once, and are one again") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "checkpoint.bin";
    Reached reached = reached_with({piece_that_went_through_all(SkinKind::boundary)});
    const std::string image(100'000, 'i');
    const auto shared = std::make_shared<const std::string>(image);
    TriMesh like = reached.bodies[0].look->mesh();
    like.material[0].embedded_texture = shared;
    reached.bodies[0].look = std::make_shared<const NewLook>(like);
    reached.bodies[0].skin.material[0].embedded_texture = shared;
    write_checkpoint(file, kKeys, reached);
    const std::string bytes = bytes_of(file);
    const std::size_t first = bytes.find(image);
    CHECK(first != std::string::npos);
    CHECK(bytes.find(image, first + 1) == std::string::npos);
    std::string why;
    const std::optional<Reached> read = read_checkpoint(file, kKeys, why);
    REQUIRE(read);
    const WorkPiece& piece = read->bodies[0];
    CHECK(*piece.skin.material[0].embedded_texture == image);
    CHECK(piece.skin.material[0].embedded_texture ==
          piece.look->mesh().material[0].embedded_texture);
}

TEST_CASE("a checkpoint that is damaged, cut short or foreign is told from a whole one",
          "[stress]") {
    const Scratch scratch;
    const fs::path file = scratch.path() / "checkpoint.bin";
    std::string why;
    CHECK_FALSE(read_checkpoint(file, kKeys, why));
    CHECK(why.empty());
    write_checkpoint(file, kKeys, reached_with({piece_that_went_through_all(SkinKind::mount)}));
    const std::string whole = bytes_of(file);
    REQUIRE(read_checkpoint(file, kKeys, why));
    CHECK_FALSE(read_checkpoint(file, {"", "", "other"}, why));
    CHECK(why == "belongs to another run or another build of swage");
    const auto refused = [&](const std::string& bytes) {
        put_bytes(file, bytes);
        return !read_checkpoint(file, kKeys, why) && why == "is damaged";
    };
    const std::size_t far = whole.size() / 150;
    for (std::size_t at = 0; at < whole.size(); at += at < 300 ? 1 : far) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x41);
        CHECK(refused(bytes));
        CHECK(refused(whole.substr(0, at)));
    }
    CHECK(refused(whole + "more"));
    CHECK(refused(std::string(1 << 20, 'x')));
    // Hashes that are right of what makes no sense: sizes beyond the file's, and an end too early.
    for (const std::size_t size : {std::size_t(8), std::size_t(40), std::size_t(4000)}) {
        for (const char fill : {'\0', '\x7f', '\xff'}) {
            ByteWriter out;
            out(2, std::string("key"), std::uint64_t(0));
            out.raw(std::string(size, fill).data(), size);
            ByteWriter hash;
            hash(hash_of(out.bytes()));
            CHECK(refused(whole.substr(0, 8) + out.bytes() + hash.bytes()));
        }
    }
    fs::remove(file);
    fs::create_directory(file);
    CHECK_FALSE(read_checkpoint(file, kKeys, why));
    CHECK(why == "is a folder, not a file");
}
