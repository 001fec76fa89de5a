// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files that are hardly scenes: empty, damaged, no text, no files.
#include <sys/stat.h>

#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("a scene that says nothing has nothing to do") {
    CHECK(mistakes_in("").find("s.toml: nothing to do: the scene is empty") == 0);
    CHECK(mistakes_in("# only words\n\n").find("s.toml: nothing to do") == 0);
    CHECK(mistakes_in("\xEF\xBB\xBF").find("s.toml: nothing to do") == 0);
    CHECK(mistakes_in(with(&Parts::stage, "").text()).find("no [[stage]]") != std::string::npos);
}

TEST_CASE("files that are no text are refused at the byte") {
    CHECK(mistakes_in(std::string("[mesh]\nfi\0le", 12)) ==
          "s.toml:2:3: byte 9 is 0; this is not a text file\n");
    CHECK(mistakes_in("[mesh]\n# L\xE4nge\n") ==
          "s.toml:2:4: byte 10 (0xE4) is not UTF-8; save the file in that encoding\n");
    CHECK(mistakes_in("# \xED\xA0\x80").find("byte 2 (0xED)") != std::string::npos);  // surrogate
    CHECK(mistakes_in("# \xC0\x80").find("byte 2 (0xC0)") != std::string::npos);      // overlong
    CHECK(mistakes_in("# \xF0\x9F\x98").find("byte 2 (0xF0)") != std::string::npos);  // cut off
    CHECK(mistakes_in("\xFF\xFE[\0").find("s.toml:1:1: byte 0 (0xFF)") == 0);         // UTF-16
}

TEST_CASE("control characters that a scene names are shown, and cut no sentence off") {
    const std::string text = mistakes_in(
        with(&Parts::mesh, "[mesh]\nfile = \"\\u001b[31mX\"\nlength = \"3 cm\\u0000\"\n").text());
    INFO(text);
    CHECK(text.find("the mesh \"\\x1b[31mX\" does not exist") != std::string::npos);
    CHECK(text.find("unknown unit \"cm\\x00\"") != std::string::npos);
    CHECK(text.find("? Expected a length (m, cm, ") != std::string::npos);
    CHECK(mistakes_in(Parts().text() + "\"\\u009b2J\" = 1\n").find("key \"\\x9b2J\"") !=
          std::string::npos);
}

TEST_CASE("scene files that cannot be files are refused without blocking") {
    const SceneFolder scratch;
    const auto mistakes = [&](const std::filesystem::path& file) {
        return told(read_scene(file, {}, shipped()).mistakes, scratch.path());
    };
    CHECK(mistakes(scratch.path() / "no.toml") == "no.toml: the file does not exist\n");
    CHECK(mistakes(scratch.path()).find("the file is a folder, not a file") != std::string::npos);
    CHECK(mistakes("/dev/zero") == "/dev/zero: the file is not a regular file\n");
    REQUIRE(::mkfifo((scratch.path() / "pipe.toml").c_str(), 0600) == 0);
    CHECK(mistakes(scratch.path() / "pipe.toml") == "pipe.toml: the file is not a regular file\n");
    scratch.write("large.toml", "");
    std::filesystem::resize_file(scratch.path() / "large.toml", std::uint64_t{1} << 30);
    CHECK(mistakes(scratch.path() / "large.toml") ==
          "large.toml: the file is larger than 64 MiB\n");
}

TEST_CASE("long lines and deep nesting are read or refused, never fatal") {
    CHECK(mistakes_in(Parts().text() + "# " + std::string(1'000'000, 'x') + "\n") == "");
    CHECK(mistakes_in(std::string("a = ").append(100'000, '[')).find("nested") !=
          std::string::npos);
    const std::string wide = mistakes_in(Parts().text() + [] {
        std::string text = "[output]\n";
        for (int n = 0; n < 20000; ++n) text += fmt::format("key_{} = 1\n", n);
        return text;
    }());
    CHECK(std::count(wide.begin(), wide.end(), '\n') == 201);
    CHECK(wide.find("s.toml: and 19800 more\n") != std::string::npos);
}

TEST_CASE("a key of thousands of parts is refused where it stands") {
    std::string deep = "a";
    for (int n = 0; n < 40'000; ++n) deep += n % 2 == 0 ? ".a" : " . \"a.b\"";
    const std::string refused = "a key of more than 16 parts\n";
    CHECK(mistakes_in("x = \"\"\"\na.a\"\"\" # a.a\n  " + deep + " = 1") ==
          "s.toml:3:3: " + refused);
    CHECK(mistakes_in("['\u00e4'.b]\n[[" + deep + "]]\n") == "s.toml:2:3: " + refused);
    CHECK(mistakes_in("x = {y = \"\"\"\"\"\"\"\", " + deep + " = 2}\n") ==
          "s.toml:1:20: " + refused);
    CHECK(mistakes_in("x = {\u00e4 = 1, " + deep + " = 2}\n") == "s.toml:1:13: " + refused);
    CHECK(mistakes_in(Parts().text() + "\n[stage.parameters]\n" + deep + " = 2\n").find(refused) !=
          std::string::npos);
    // As deep as may be, through all that may be nested.
    const std::string most = "a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = ";
    std::string nested = "1";
    for (int n = 0; n < 250; ++n) nested = "{" + most + nested + "}";
    CHECK(mistakes_in("x = " + nested + "\n").find("unknown") != std::string::npos);
    const SceneFolder scratch;
    const auto scene = scratch.write("s.toml", Parts().text());
    for (const std::string& text :
         {"material.density={" + deep + "=1}", "material." + deep + "=1"}) {
        CHECK(!read_scene(scene, {text}, shipped()).mistakes.empty());
    }
    // Text and numbers are no keys.
    CHECK(mistakes_in(Parts().text() + "# " + deep + "\n") == "");
}

TEST_CASE("no damage to a scene's bytes does more than earn a mistake") {
    const SceneFolder scratch;
    Parts parts;
    parts.rest += "camera = {keys = [{at = 0.5, eye = [0, 1, 2], target = [0, 0, 0]}]}\n";
    const std::string whole = parts.text();
    const std::string letters = "[]{}=.,\"'\n#0129-eaxn \\\xC3\x01";
    std::uint64_t state = 1;  // Knuth's linear congruential numbers
    const auto random = [&](std::size_t below) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::size_t>(state >> 33) % below;
    };
    int right = 0;
    for (int n = 0; n < 1000; ++n) {
        std::string text = whole;
        for (std::size_t times = 1 + random(4); times > 0; --times) {
            const std::size_t at = random(text.size());
            const char letter = letters[random(letters.size())];
            switch (random(4)) {
                case 0:
                    text[at] = letter;
                    break;
                case 1:
                    text.insert(at, 1, letter);
                    break;
                case 2:
                    text.erase(at, 1 + random(8));
                    break;
                default:
                    text.insert(at, text.substr(random(text.size()), random(40)));
            }
        }
        INFO(text);
        const SceneReading reading = read_scene(scratch.write("s.toml", text), {}, shipped());
        REQUIRE(reading.scene.has_value() == (exit_code(reading.mistakes) == ExitCode::done));
        for (const Mistake& mistake : reading.mistakes) {
            REQUIRE_FALSE(mistake.text.empty());
            REQUIRE((mistake.line == 0) == (mistake.column == 0));
            REQUIRE(mistake.line <= 1 + std::count(text.begin(), text.end(), '\n'));
        }
        right += reading.scene.has_value();
    }
    CHECK(right > 0);
    CHECK(right < 500);
}

TEST_CASE("overrides are checked like the file, and named as they were given") {
    const std::string scene = Parts().text();
    const auto told_of = [&](const std::string& text) { return mistakes_in(scene, {text}); };
    CHECK(told_of("material.yeild=3") ==
          "--set material.yeild=3: unknown key \"yeild\" in "
          "[material], did you mean \"yield_stress\"?\n");
    CHECK(told_of("stage.1.angle=45 dog")
              .find("--set stage.1.angle=45 dog: angle: unknown unit "
                    "\"dog\"") == 0);
    CHECK(told_of("stage.3.angle=1").find("there is no stage \"3\"") != std::string::npos);
    CHECK(told_of("stage.bned.angle=1").find("did you mean \"bend\"?") != std::string::npos);
    CHECK(told_of("stage.angle=1").find("which stage? Write stage.1.angle, or stage.*.angle") !=
          std::string::npos);
    CHECK(told_of("frames").find("write an override as KEY=VALUE, such as stage.1.angle=45 deg") !=
          std::string::npos);
    CHECK(told_of("frames=3").find("SECTION.KEY") != std::string::npos);
    CHECK(told_of("mold..across=3").find("SECTION.KEY") != std::string::npos);
    CHECK(told_of("mold.across.x=3").find("\"across\" is a whole number and has no keys") !=
          std::string::npos);
    CHECK(told_of("mould.across=3").find("unknown section [mould], did you mean [mold]?") !=
          std::string::npos);
    CHECK(told_of("material.density=1\nx = 2").find("density") != std::string::npos);
}

TEST_CASE("an override of one of several that are not there says so") {
    const auto told_of = [&](const std::string& set) { return mistakes_in(Parts().text(), {set}); };
    CHECK(told_of("stage.1.load.1.pressure=1 MPa") ==
          "--set stage.1.load.1.pressure=1 MPa: there is no load to override\n");
    CHECK(told_of("probe.*.at=[0,0,0]").find("there is no probe") != std::string::npos);
    CHECK(told_of("stage.1=3").find("Write stage.1.KEY") != std::string::npos);
}

TEST_CASE("blanks around the parts of an override's key are not of it") {
    CHECK(mistakes_in(Parts().text(), {" mold . across = 3", "stage.1.angle =45 deg"}) == "");
}

TEST_CASE("all mistakes of all files come in one reading, in the order of the files") {
    const SceneFolder scratch;
    scratch.write("machines/odd.toml", "[[grip]]\nnme = \"a\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n");
    const auto file = scratch.write("s.toml",
                                    "[mesh]\nfile = \"no.obj\"\nlenght = 1\n[material]\nname = "
                                    "\"ruber\"\n[mold]\nacross = 0\nspacing =\n[[stage]]\nmachine "
                                    "= \"odd\"\nanything = 3\nframes = \"x\"\n[[stage]]\nmachine = "
                                    "\"odd\"\n");
    const std::string text = told(read_scene(file, {}, shipped()).mistakes, scratch.path());
    INFO(text);
    std::size_t at = 0;
    for (const char* place :
         {"s.toml:2:8:", "s.toml:3:1:", "s.toml:5:8:", "s.toml:7:10:", "s.toml:8:10:",
          "s.toml:12:11:", "machines/odd.toml:1:1: [[grip]] needs",
          "machines/odd.toml:2:1: unknown key \"nme\" in [[grip]], did you mean "
          "\"name\"?"}) {
        INFO(place);
        const std::size_t found = text.find(place, at);
        REQUIRE(found != std::string::npos);
        at = found;
    }
    CHECK(std::count(text.begin(), text.end(), '\n') == 8);  // the machine's only once
}
