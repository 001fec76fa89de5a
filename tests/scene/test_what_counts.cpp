// SPDX-License-Identifier: GPL-3.0-or-later
// Where one thing that a scene says meets another: which of them counts, and what is refused.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "scene/find.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

// What was read, and what was told of it.
struct Read {
    std::optional<SceneSpec> scene;
    std::string told;
};

Read read(const Parts& parts, const std::string& machine = "") {
    const SceneFolder scratch;
    if (!machine.empty()) scratch.write("m.toml", machine);
    SceneReading reading = read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    return {std::move(reading.scene), test::told(reading.mistakes, scratch.path())};
}

bool has(const std::string& text, const std::string& words) {
    if (text.find(words) != std::string::npos) return true;
    UNSCOPED_INFO("'" << text << "' lacks '" << words << "'");
    return false;
}

// A machine that pushes at the right end.
const std::string kPush =
    "[parameter.share]\nquantity = \"number\"\ndefault = 0.5\nlow = \"3*0.1\"\nhigh = 1\n"
    "[[load]]\nname = \"push\"\non = \"right\"\nforce = [\"-share*(2 N)\", 0, 0]\n";

Parts pushed(const std::string& lines) {
    return with(&Parts::stage, "[[stage]]\nmachine = \"./m.toml\"\n" + lines);
}

Parts stages(const std::string& lines) { return with(&Parts::stage, lines); }

}  // namespace

TEST_CASE("a body has the work-piece's cells, but nothing of its material beside its own") {
    Parts parts = with(&Parts::material,
                       "[material]\nname = \"cast_iron\"\nfriction = 0.9\nrestitution = 0.1\n"
                       "look = {color = [0.2, 0.4, 0.6], roughness = 0.5}\n");
    parts.mold = "[mold]\nacross = 4\n";
    parts.stage = "[[stage]]\nmachine = \"floor\"\ngravity = 9.81\n";
    parts.rest =
        "[[body]]\nfile = \"bar.obj\"\nat = [3, 0, 0]\n"
        "[[body]]\nfile = \"bar.obj\"\nat = [0, 3, 0]\n"
        "[body.material]\nyoung_modulus = \"1 GPa\"\ndensity = 900\n"
        "[[body]]\nfile = \"bar.obj\"\nat = [0, 0, 3]\n"
        "[body.material]\nname = \"rubber\"\nlook = {color = [1, 1, 1]}\n";
    const Read all = read(parts);
    INFO(all.told);
    REQUIRE(all.scene);
    const std::vector<BodySpec>& body = all.scene->body;
    REQUIRE(body.size() == 4);
    for (const BodySpec& one : body) CHECK(one.mold.across == 4);
    CHECK(body[1].material.name == "cast_iron");
    CHECK(body[1].material.friction == 0.9);
    CHECK(body[1].look);
    CHECK(body[1].gives_look);
    const Material plain;
    CHECK(body[2].material.name == plain.name);
    CHECK(body[2].material.friction == plain.friction);
    CHECK(body[2].material.restitution == plain.restitution);
    CHECK_FALSE(body[2].material.breaks());
    CHECK_FALSE(body[2].material.yields());
    CHECK_FALSE(body[2].look);
    CHECK_FALSE(body[2].gives_look);
    CHECK(body[3].look);
    CHECK(body[3].gives_look);
}

TEST_CASE("a field is held once, the drawn one too, and its colours' range is in its own unit") {
    Parts parts;
    parts.rest =
        "[render]\ncolor = \"stress\"\ncolor_range = [\"0 Pa\", \"2 MPa\"]\n"
        "[output]\nfields = [\"pressure\", \"pressure\"]\n";
    const Read stress = read(parts);
    INFO(stress.told);
    REQUIRE(stress.scene);
    CHECK(stress.scene->output.fields ==
          std::vector<SkinField>{*skin_field_named("pressure"), *skin_field_named("stress")});
    CHECK(stress.scene->render.color_range.value() == std::array<double, 2>{0, 2e6});
    parts.material = "[material]\nname = \"lead\"\n";
    parts.rest = "[render]\ncolor = \"plastic_strain\"\ncolor_range = [0, \"20 %\"]\n";
    const Read strain = read(parts);
    INFO(strain.told);
    REQUIRE(strain.scene);
    CHECK(strain.scene->render.color_range.value() == std::array<double, 2>{0, 0.2});
    parts.rest = "[render]\ncolor = \"plastic_strain\"\ncolor_range = [0, \"2 MPa\"]\n";
    CHECK_FALSE(read(parts).scene);
}

TEST_CASE("what takes yielding or breaking away takes with it all that belongs to it") {
    const auto material_of = [](const std::string& lines) {
        const Read all = read(with(&Parts::material, "[material]\n" + lines));
        INFO(all.told);
        REQUIRE(all.scene);
        return all.scene->work_piece().material;
    };
    for (const char* infinite : {"inf", "\"inf\"", "\"+inf MPa\""}) {
        const Material iron =
            material_of(std::string("name = \"cast_iron\"\nstrength = ") + infinite + "\n");
        CHECK_FALSE(iron.breaks());
        CHECK(std::isinf(iron.toughness));
        CHECK(iron.yields());
    }
    CHECK_FALSE(material_of("name = \"lead\"\nyield_stress = inf\n").yields());
    CHECK_FALSE(read(material("yield_stress = -inf")).scene);
    CHECK(material_of("name = \"rubber\"\nback_stress = \"1 kPa\"\nback_strain = 0.1\n")
              .back_stress == 0);
    CHECK(has(read(material("young_modulus = \"2000 GPa\"")).told, "is a unit missing or wrong?"));
    CHECK(has(read(material("young_modulus = 2")).told, "is a unit missing or wrong?"));
    // Of the flow stress back stress leaves a twentieth, at the least.
    const auto steel = [](const char* back) {
        return read(with(&Parts::material,
                         std::string("[material]\nyoung_modulus = \"200 GPa\"\ndensity = 7800\n"
                                     "yield_stress = \"100 MPa\"\nback_strain = 0.01\n"
                                     "back_stress = \"") +
                             back + " MPa\"\n"));
    };
    CHECK(steel("94").scene);
    CHECK(has(steel("99").told, "of the flow stress"));
}

TEST_CASE("a solver goes by all materials of a body, and by what stages have cut") {
    const std::string inset = "[[inset]]\nname = \"rubber\"\nfrom = [0, 0, 0]\nto = [1, 0.5, 1]\n";
    Parts parts = with(&Parts::material, "[material]\nname = \"cast_iron\"\n" + inset);
    parts.stage = "[[stage]]\nmachine = \"bend\"\nsolver = \"implicit\"\n";
    CHECK(has(read(parts).told, "does not follow cracks"));
    parts = with(&Parts::material, "[material]\nname = \"rubber\"\ndamping_ratio = 0\n" + inset);
    parts.stage = "[[stage]]\nmachine = \"bend\"\nsolver = \"euler\"\n";
    CHECK(has(read(parts).told, "give [material] a damping_ratio"));
    parts = with(&Parts::material, "[material]\nname = \"lead\"\n" + inset +
                                       "back_stress = \"1 kPa\"\nback_strain = 0.1\n"
                                       "yield_stress = \"9 kPa\"\n");
    CHECK(has(read(parts).told, "cells of two materials have no back stress"));

    const std::string cut = "[[stage]]\nmachine = \"cut\"\nsolver = \"explicit\"\n",
                      implicit = "[[stage]]\nmachine = \"bend\"\nsolver = \"implicit\"\n",
                      anew = "[[stage]]\nmachine = \"bend\"\nremold = true\n";
    CHECK(has(read(stages(cut + implicit)).told, "cannot move cut matter"));
    CHECK_FALSE(has(read(stages(cut + anew + implicit)).told, "cannot move cut matter"));
    CHECK_FALSE(has(read(stages(cut + implicit + "remold = true\n")).told, "cut matter"));
    CHECK(has(read(stages(anew + cut + implicit)).told, "cannot move cut matter"));

    const Read touching = read(stages(implicit + "self_contact = true\n"));
    INFO(touching.told);
    REQUIRE(touching.scene);
    CHECK_FALSE(touching.scene->stage[0].sim.self_contact);
    const std::string soft = "contact_stiffness = 0.1\n";
    CHECK(has(read(stage(soft)).told, "contact_stiffness = 0.1 is out of range"));
    CHECK(read(stage("solver = \"explicit\"\n" + soft)).scene);
}

TEST_CASE("pictures have y upward where stages do not agree on what is, in either order") {
    const auto up_of = [](const std::string& first, const std::string& second) {
        const std::string floor = "[[stage]]\nmachine = \"floor\"\ngravity = 9.81\nup = \"";
        const Read all = read(stages(floor + first + "\"\n" + floor + second + "\"\n"));
        REQUIRE(all.scene);
        return std::pair(all.scene->render.up, has(all.told, "unless that is meant"));
    };
    CHECK(up_of("z", "z") == std::pair(Up::z, false));
    CHECK(up_of("z", "x") == std::pair(Up::y, true));
    CHECK(up_of("y", "z") == std::pair(Up::y, true));
    CHECK(up_of("z", "-z") == std::pair(Up::y, true));
}

TEST_CASE("a parameter at the end of its range is in it, however that rounds") {
    CHECK(read(pushed("share = 0.3\n"), kPush).scene);  // 3 * 0.1 is more
    CHECK(read(pushed("share = 1\n"), kPush).scene);
    CHECK(has(read(pushed("share = 0.2999\n"), kPush).told, "share = 0.2999 is out of range"));
    CHECK_FALSE(read(pushed("share = 1.0001\n"), kPush).scene);
}

TEST_CASE("a load of a stage that does nothing is told beside one of its machine that acts") {
    const std::string none = "[[stage.load]]\nforce = [0, 0, 0]\n",
                      one = "[[stage.load]]\nforce = [0, 1, 0]\n";
    CHECK(has(read(pushed(none), kPush).told, "does nothing: its force is 0"));
    CHECK(read(pushed(one), kPush).told.empty());
    const std::string idle = "[[load]]\nname = \"push\"\non = \"right\"\nforce = [0, 0, 0]\n";
    CHECK_FALSE(has(read(pushed(one), idle).told, "does nothing"));
}

TEST_CASE("a load without a name is refused where its machine has one of the name it would get") {
    const std::string named = "[[load]]\nname = \"load_1\"\non = \"right\"\npressure = 3\n";
    CHECK(has(read(pushed("[[stage.load]]\nforce = [0, 1, 0]\n"), named).told,
              "two parts are called \"load_1\"; give this load a name"));
}

TEST_CASE("a probe lies in its body's box") {
    const auto told_at = [](const std::string& at) {
        Parts parts;
        parts.rest = "[[probe]]\nname = \"tip\"\nat = " + at + "\n";
        return read(parts).told;
    };
    CHECK(told_at("[1, 0, 0.5]").empty());
    for (const char* beside : {"[1.01, 0, 0.5]", "[0, -0.01, 0]"}) {
        CHECK(has(told_at(beside), "each must be a fraction of the body's box, 0 to 1"));
    }
}

TEST_CASE("a probe tells the fields that it asks for, and of those that say nothing one is told") {
    Parts parts;
    parts.rest =
        "[[probe]]\nname = \"tip\"\nat = [1, 0, 0.5]\n"
        "fields = [\"stress\", \"yield_use\", \"stress\"]\n";
    const Read all = read(parts);
    REQUIRE(all.scene);
    CHECK(all.scene->work_piece().probe.front().fields ==
          std::vector{SkinField::stress, SkinField::yield_use});
    CHECK(has(all.told, "fields: yield_use shows nothing"));
    parts.rest = "[[probe]]\nname = \"tip\"\nat = [1, 0, 0.5]\nfields = [\"strain\"]\n";
    CHECK(has(read(parts).told, "fields: \"strain\" is not one of"));
}

TEST_CASE("the files of materials are among those that a scene is made of") {
    const Read all = read(Parts());
    REQUIRE(all.scene);
    const std::vector<std::filesystem::path>& inputs = all.scene->inputs;
    CHECK(std::any_of(inputs.begin(), inputs.end(),
                      [](const auto& file) { return file.filename() == "materials.toml"; }));
}

TEST_CASE("a key given twice is told with the line of its own section") {
    Parts parts;
    parts.mesh = "[[inset]]\nname = \"lead\"\nto = [1, 1, 0.5]\n" + parts.mesh;
    parts.material += "name = \"lead\"\n";
    CHECK(has(read(parts).told, "\"name\" is given twice, first on line 7"));
}

TEST_CASE("a folder of assets that is not there is refused where it is named") {
    const char* const before = std::getenv("SWAGE_ASSETS");
    const std::string was = before != nullptr ? before : "";
    ::setenv("SWAGE_ASSETS", "/no/such/folder", 1);
    CHECK_THROWS_AS(find_assets(std::nullopt), Error);
    before != nullptr ? ::setenv("SWAGE_ASSETS", was.c_str(), 1) : ::unsetenv("SWAGE_ASSETS");
    CHECK_THROWS_AS(find_assets("/no/such/folder"), Error);
}

TEST_CASE("whether tools are drawn matters to grips and blades too") {
    const auto told_with = [](const char* machine, const std::string& file = "") {
        Parts parts = stages("[[stage]]\nmachine = \"" + std::string(machine) + "\"\n");
        parts.rest = "[render]\ntools = false\n";
        return read(parts, file).told;
    };
    for (const char* machine : {"twist", "bend", "cut"}) CHECK(told_with(machine).empty());
    CHECK(has(told_with("./m.toml", kPush), "tools has no effect"));
}

TEST_CASE("the axes along which a grip holds are each named once") {
    const auto told_with = [](const std::string& along) {
        return read(pushed(""), kPush +
                                    "[[grip]]\nname = \"hold\"\nfrom = [\"-length\", "
                                    "\"-height\", \"-width\"]\nto = [0, \"height\", "
                                    "\"width\"]\nalong = \"" +
                                    along + "\"\n")
            .told;
    };
    CHECK(told_with("zx").empty());
    for (const char* wrong : {"", "xx", "xyx", "w", "x y"}) {
        CHECK(has(told_with(wrong), "along must name axes of the work frame, each once"));
    }
}
