// SPDX-License-Identifier: GPL-3.0-or-later
// Keys that can do nothing in their scene are told, at their place; the same keys where they act
// are not.
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

Parts scene(const std::string& material, const std::string& stage, const std::string& rest = "") {
    Parts parts;
    parts.material = "[material]\nname = \"" + material;
    parts.stage = "[[stage]]\nmachine = \"" + stage;
    parts.rest = rest;
    return parts;
}

const std::string kDrop = "floor\"\ngravity = 9.81\n";
const std::string kOther = "[[body]]\nfile = \"bar.obj\"\nat = [0, 1, 0]\n";

}  // namespace

TEST_CASE("a material's key that nothing in the scene asks is told") {
    check_all({
        {"no contact",
         scene("rubber\"\nfriction = 0.3\n", "twist\"\n"),
         {"5:12: warning: friction has no effect: nothing can touch"}},
        {"no tool that goes by it",
         scene("rubber\"\nfriction = 0.3\n", "bend\"\nfriction = 0.2\n"),
         {"5:12: warning: friction has no effect: every tool has its own friction"}},
        {"at rest",
         scene("rubber\"\nrestitution = 0.3\nstickiness = 3\ndamping_ratio = 0.1\n"
               "static_friction = 0.9\n",
               "bend\"\n"),
         {"5:15: warning: restitution has no effect unless a stage is in motion",
          "6:14: warning: stickiness has no effect unless a stage is in motion",
          "7:17: warning: damping_ratio has no effect unless a stage is in motion",
          "8:19: warning: static_friction has no effect unless a stage is in motion"}},
        {"implicit",
         scene("rubber\"\nrestitution = 0.3\n", "bend\"\nsolver = \"implicit\"\n"),
         {"5:15: warning: restitution has no effect unless a stage is in motion"}},
        {"in motion, and nothing to meet",
         scene("rubber\"\nrestitution = 0.3\ndamping_ratio = 0.1\n",
               "twist\"\nsolver = \"explicit\"\n"),
         {"5:15: warning: restitution has no effect: nothing can touch"}},
        {"of an inset",
         scene("rubber\"\n", "bend\"\n",
               "[[inset]]\nname = \"lead\"\nto = [1, 1, 0.5]\n"
               "damping_ratio = 0.1\n"),
         {"12:17: warning: damping_ratio has no effect"}},
        {"of a body",
         scene("rubber\"\n", kDrop,
               kOther + "[body.material]\nname = \"rubber\"\n"
                        "hardening = 3\n"),
         {"15:13: warning: hardening has no effect without yield_stress"}},
    });
    for (const Parts& right : {
             scene("rubber\"\nrestitution = 0.3\nstickiness = 3\nstatic_friction = 0.9\n", kDrop),
             scene("rubber\"\nrestitution = 0.3\n",
                   "twist\"\nsolver = \"explicit\"\n"
                   "self_contact = true\n"),
             scene("rubber\"\nfriction = 0.3\n", "twist\"\nself_contact = true\n"),
             scene("rubber\"\nfriction = 0.3\n", "bend\"\n"),
             scene("rubber\"\nfriction = 0.3\n", "wring\"\n"),
             scene("rubber\"\nfriction = 0.3\n", "bend\"\nfriction = 0.2\nself_contact = true\n"),
             scene("rubber\"\nfriction = 0.3\n",
                   "bend\"\nfriction = 0.2\n[[stage]]\nmachine = \"bend\"\n"),
             scene("rubber\"\ndamping_ratio = 0\n", "bend\"\n"),
             scene("rubber\"\ndamping_ratio = 0.1\n",
                   "bend\"\n[[stage]]\nmachine = \"twist\"\nsolver = \"explicit\"\n"),
         }) {
        INFO(right.text());
        CHECK(mistakes_in(right.text()).empty());
    }
}

TEST_CASE("a tool's friction may go by the place of another tool") {
    const auto told_with = [](const std::string& friction) {
        const SceneFolder scratch;
        scratch.write("machines/pair.toml",
                      "[[tool]]\nname = \"one\"\nshape = \"sphere\"\nradius = 0.1\n"
                      "at = [0, 1, 0]\nfriction = 0.3\n"
                      "[[tool]]\nname = \"two\"\nshape = \"sphere\"\nradius = 0.1\n"
                      "at = [0, 1, 0]\nfriction = \"" +
                          friction + "\"\n");
        const Parts parts = scene("rubber\"\nfriction = 0.3\n", "pair\"\n");
        return told(read_scene(scratch.write("s.toml", parts.text()), {}, shipped()).mistakes,
                    scratch.path());
    };
    CHECK(told_with("0.2 + 0*one_x").find("5:12: warning: friction has no effect") !=
          std::string::npos);
    CHECK(told_with("material_friction + 0*one_x").empty());
}

TEST_CASE("a duration acts on any part of a machine's motion that goes by it") {
    const auto told_with = [](const std::string& motion) {
        const SceneFolder scratch;
        scratch.write("machines/turner.toml",
                      "[[grip]]\nname = \"hold\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
                      "to = [\"-0.4*length\", \"height\", \"width\"]\n[grip.motion]\n" +
                          motion + "\n");
        const Parts parts = scene("rubber\"\n", "turner\"\nduration = \"2 s\"\n");
        return told(read_scene(scratch.write("s.toml", parts.text()), {}, shipped()).mistakes,
                    scratch.path());
    };
    CHECK(told_with("turn = \"t\"").find("duration has no effect") != std::string::npos);
    for (const char* motion :
         {"turn = \"t*duration/(1 s)\"", "move = [0, \"t*duration*(1 m/s)\", 0]",
          "turn = \"t\"\npivot = [\"t*duration*(1 m/s)\", 0, 0]"}) {
        INFO(motion);
        CHECK(told_with(motion).find("duration has no effect") == std::string::npos);
    }
}

TEST_CASE("a stage's key that its machine or solver does not ask is told") {
    check_all({
        {"no grip",
         scene("rubber\"\n", "bend\"\ngrip_stiffness = 3\n"),
         {"9:18: warning: grip_stiffness has no effect: machine bend has no grip"}},
        {"no tool",
         scene("rubber\"\n", "twist\"\ncontact_stiffness = 3\n"),
         {"9:21: warning: contact_stiffness has no effect: nothing can touch, as machine twist has "
          "no tool"}},
        {"nothing holds down what would sleep",
         scene("rubber\"\n", "twist\"\nsolver = \"explicit\"\nsleep = false\n"),
         {"10:9: warning: sleep has no effect without gravity"}},
    });
    for (const Parts& right : {
             scene("rubber\"\n", "twist\"\ngrip_stiffness = 3\n"),
             scene("rubber\"\n", "bend\"\ncontact_stiffness = 3\n"),
             scene("rubber\"\n", "twist\"\ncontact_stiffness = 3\nself_contact = true\n"),
             scene("rubber\"\n", kDrop + "sleep = false\n"),
             scene("rubber\"\n", kDrop + "solver = \"energy-stepped\"\nstep_safety = 0.1\n"),
         }) {
        INFO(right.text());
        CHECK(mistakes_in(right.text()).empty());
    }
}

TEST_CASE("looks of what cannot come about are told") {
    const std::string bend = "bend\"\n";
    check_all({
        {"nothing breaks",
         scene("rubber\"\n", bend, "[skin]\nroughness = 0.2\n"),
         {"10:13: warning: roughness has no effect: no material breaks"}},
        {"a cut alone",
         scene("rubber\"\n", "cut\"\n", "[skin]\nroughness = 0\n"),
         {"10:13: warning: roughness has no effect: no material breaks"}},
        {"an inside that nothing lays open",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\ncut_color = [1, 0, 0]\n"),
         {"3:13: warning: cut_color has no effect: no machine cuts, and no material breaks"}},
        {"an inside that has no such colour",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\ncut_color = [1, 0, 2]\n"),
         {"3:13: cut_color = [1, 0, 2]: red, green and blue must each be 0 to 1"}},
        {"an inset that nothing cuts",
         with(&Parts::rest,
              "[[inset]]\nname = \"lead\"\nfrom = [0, 0, 0]\nto = [1, 1, 0.5]\n"
              "color = [0, 1, 0]\nlook = {roughness = 1}\n"),
         {"warning: color has no effect: no machine cuts",
          "warning: look has no effect: no machine cuts"}},
        {"nothing yields",
         scene("rubber\"\n", bend,
               "[render]\ncolor = \"plastic_strain\"\n[output]\n"
               "fields = [\"stress\", \"plastic_strain\"]\n"),
         {"10:9: warning: color has no effect: no material yields",
          "12:21: warning: fields: plastic_strain shows nothing: no material yields"}},
        {"nothing that could be used",
         scene("rubber\"\n", bend,
               "[render]\ncolor = \"strength_use\"\n[output]\n"
               "fields = [\"yield_use\", \"strength_use\"]\n"),
         {"10:9: warning: color has no effect: no material breaks",
          "12:11: warning: fields: yield_use shows nothing: no material yields",
          "12:24: warning: fields: strength_use shows nothing: no material breaks"}},
        {"a legend of nothing",
         scene("rubber\"\n", bend, "[render]\nlegend = false\n"),
         {"10:10: warning: legend has no effect without color"}},
        {"nothing to hide",
         scene("rubber\"\n", bend, "[render]\ntools = false\nhide = [\"left\"]\n"),
         {"11:8: warning: hide has no effect with tools = false"}},
        {"no tools",
         scene("rubber\"\n", "floor\"\ngravity = 9.81\n", "[render]\ntools = false\n"),
         {}},
    });
    for (const Parts& right : {
             scene("ice\"\n", bend, "[skin]\nroughness = 0.2\n"),
             scene("copper\"\n", bend, "[render]\ncolor = \"plastic_strain\"\nlegend = false\n"),
             scene("copper\"\n", bend, "[output]\nfields = [\"plastic_strain\", \"yield_use\"]\n"),
             scene("ice\"\n", bend, "[output]\nfields = [\"strength_use\"]\n"),
             scene("rubber\"\n", bend, "[render]\ncolor = \"stress\"\nlegend = false\n"),
             scene("rubber\"\n", bend, "[render]\nhide = [\"left\"]\n"),
             scene("rubber\"\n", bend,
                   "[render]\nlegend = false\n[output]\n"
                   "fields = [\"stress\"]\n"),
         }) {
        INFO(right.text());
        CHECK(mistakes_in(right.text()).empty());
    }
}

TEST_CASE(
    "an angle of creases is told to be idle where the mesh's file says which edges are sharp") {
    const std::string text =
        scene("rubber\"\n", "bend\"\n", "[skin]\ncrease_angle = \"60 deg\"\n").text();
    const auto with_mesh = [&](const std::string& file) {
        std::string other = text;
        other.replace(other.find("bar.obj"), 7, file);
        return mistakes_in(other);
    };
    const std::string meshes = std::string(SWAGE_SOURCE_DIR) + "/assets/meshes/";
    CHECK(with_mesh(meshes + "bar.obj")
              .find("10:16: warning: crease_angle has no effect: the mesh file itself says which "
                    "edges are sharp") != std::string::npos);
    CHECK(mistakes_in(text).empty());  // no normals, and no solid
    const SceneFolder scratch;
    const std::filesystem::path plain =
        scratch.write("tetrahedron.obj",
                      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    CHECK(with_mesh(plain.string()).empty());
}

TEST_CASE("what a stage says in vain is told") {
    const std::string stage = "[[stage]]\nmachine = \"";
    const auto of = [&](const std::string& lines) {
        return with(&Parts::stage, stage + lines + "\n");
    };
    check_all({
        {"nothing to mold anew",
         of("bend\"\nremold = true"),
         {"9:10: warning: remold has no effect in the first stage, whose matter has just been"}},
        {"a time of equilibria",
         of("bend\"\nduration = \"1 s\""),
         {"9:12: warning: duration has no effect with solver = \"quasistatic\", except on the "
          "times"}},
        {"no force",
         of("hold\"\n[[stage.load]]\nforce = [0, \"0 N\", 0]"),
         {"9:1: warning: load_1 does nothing: its force is 0"}},
        {"no pressure",
         of("hold\"\n[[stage.load]]\nname = \"wind\"\npressure = 0\non = \"top\""),
         {"9:1: warning: load wind does nothing: its pressure is 0"}},
        {"no strength",
         of("hold\"\n[[stage.load]]\nforce = [0, \"9 N\", 0]\nstrength = 0"),
         {"9:1: warning: load_1 does nothing: its strength is 0"}},
        {"no strength at any time",
         of("hold\"\n[[stage.load]]\nforce = [0, \"9 N\", 0]\nstrength = \"max(0, t - 1)\""),
         {"9:1: warning: load_1 does nothing: its strength is 0 throughout"}},
        {"no gravity at any time",
         of("hold\"\ngravity = 9.81\ngravity_strength = \"0\""),
         {"10:20: warning: gravity does nothing: its strength is 0 throughout"}},
        {"none by the time that it takes",
         of("hold\"\nduration = \"1 s\"\nsolver = \"explicit\"\ngravity = 9.81\n"
            "gravity_strength = \"t*duration > 2\""),
         {"12:20: warning: gravity does nothing: its strength is 0 throughout"}},
    });
    for (const char* right : {
             "bend\"\n[[stage]]\nmachine = \"twist\"\nremold = true",
             "bend\"\nremold = false",
             "bend\"\nduration = \"1 s\"\nsolver = \"explicit\"",
             "hold\"\nduration = \"1 s\"\n[[stage.load]]\nforce = [0, \"9 N\", 0]\n"
             "strength = \"sin(2*pi*t*duration)\"",
             "twist\"\nangle = 0\nstretch = 0.1",
             "hold\"\ngravity = 9.81\ngravity_strength = \"t > 0.5 && t < 0.501\"",
             "press\"\ngravity = 9.81\ngravity_strength = \"depth*t\"",
             "cut\"\ntilt = 0\nrising = 0",
             "hold\"\n[[stage.load]]\nforce = [0, \"0 N\", \"1 N\"]",
         }) {
        INFO(right);
        CHECK(mistakes_in(of(right).text()).empty());
    }
}

TEST_CASE("stages in which down is elsewhere are told, unless nothing says what is down") {
    const auto two = [&](const std::string& first, const std::string& second) {
        return with(&Parts::stage, "[[stage]]\nmachine = \"" + first + "\n[[stage]]\nmachine = \"" +
                                       second + "\n");
    };
    const std::string floor = "floor\"\ngravity = 9.81";
    check_all({
        {"two floors",
         two(floor, floor + "\nup = \"z\""),
         {"13:6: warning: down is -z in stage 2-floor, but -y in stage 1-floor: unless that is"}},
        {"a machine that takes hold, with gravity",
         two(floor + "\nup = \"z\"", "hold\"\ngravity = 9.81"),
         {"13:11: warning: down is -y in stage 2-hold, but -z in stage 1-floor"}},
        {"a shelf without gravity",
         two(floor + "\nup = \"z\"",
             "shelf\"\n[[stage.load]]\nforce = "
             "[0, \"-9 N\", 0]"),
         {"12:11: warning: down is -y in stage 2-shelf, but -z"}},
        {"gravity by three numbers",
         two(floor, "hold\"\ngravity = [0, -3, 9]"),
         {"12:11: warning: down is [0, -0.316, 0.949] in stage 2-hold, but -y in stage 1-floor"}},
    });
    CHECK(mistakes_in(two(floor, "bend\"\nup = \"z\"").text()).empty());
    CHECK(mistakes_in(two(floor, "hold\"\ngravity = [0, -9, 3]").text()).empty());  // a slope
    CHECK(mistakes_in(two(floor + "\nup = \"z\"", floor + "\nup = \"z\"").text()).empty());
}

TEST_CASE("no shipped scene has a key without effect") {
    for (const auto& file : std::filesystem::directory_iterator(
             std::filesystem::path(SWAGE_SOURCE_DIR) / "assets/scenes")) {
        INFO(file.path());
        CHECK(read_scene(file.path(), {}, shipped()).mistakes.empty());
    }
}
