// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/key_reference.h"

#include <algorithm>
#include <map>

#include "base/expression.h"
#include "base/text.h"
#include "base/units.h"
#include "scene/expressions.h"
#include "scene/key_help.h"
#include "scene/read_inset.h"
#include "scene/read_machine.h"
#include "scene/read_scene.h"

namespace swage {

namespace {

// Sections that are shown by another name; by an empty one: not shown.
const std::map<std::string, std::string> kShown = {
    {"the scene", ""},
    {"the machine file", "top of the file"},
    {"[parameter.any]", "[parameter.NAME]"},
    {"a key of [render.camera]", "[[render.camera.keys]]"},
    {"[grip.motion]", ""},
    {"[blade.motion]", ""},
    {"[[load]]", ""},
};

// A section whose keys are told by those of another.
const std::map<std::string, std::string> kLike = {
    {"[[body]]", "[mesh]"},
    {"[[inset]]", "[material]"},
    {"[[render.camera.keys]]", "[render.camera]"},
};

const KeyHelp* help_of(std::span<const KeyHelp> all, std::string_view section,
                       std::string_view key) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const KeyHelp& one) {
        return one.section == section && one.key == key;
    });
    return at == all.end() ? nullptr : &*at;
}

KeyReference told(const KeyForm& form, const KeyHelp* help) {
    KeyReference key{form.key, form.takes, form.usual, ""};
    if (help == nullptr) return key;
    key.help = help->help;
    if (!help->takes.empty()) key.takes = help->takes;
    if (!help->usual.empty()) key.usual = help->usual;
    if (key.usual == "-") key.usual.clear();
    return key;
}

std::vector<SectionReference> reference(const Reading& reading, std::span<const KeyHelp> all) {
    std::vector<SectionReference> result;
    for (const auto& [section, forms] : reading.forms) {
        std::string shown = section;
        if (const auto other = kShown.find(section); other != kShown.end()) shown = other->second;
        if (shown.empty()) continue;
        auto at = std::find_if(result.begin(), result.end(),
                               [&](const SectionReference& one) { return one.section == shown; });
        if (at == result.end()) at = result.insert(result.end(), {shown, {}});
        const auto like = kLike.find(shown);
        const std::vector<std::string> refused =
            shown == "[[inset]]" ? keys_of_whole_bodies() : std::vector<std::string>{};
        for (const KeyForm& form : forms) {
            if (std::find(refused.begin(), refused.end(), form.key) != refused.end()) continue;
            const KeyHelp* help = help_of(all, shown, form.key);
            if (help == nullptr && like != kLike.end()) {
                help = help_of(all, like->second, form.key);
                // A key of [[body]] may be one of [mold] too.
                if (help == nullptr) help = help_of(all, "[mold]", form.key);
            }
            at->key.push_back(told(form, help));
        }
    }
    return result;
}

Document document_of(const std::string& text) {
    Document document;
    document.source = std::make_shared<const Source>(Source{"every key", text});
    document.root = parse_value(text, {document.source, 1, 1});
    return document;
}

}  // namespace

std::vector<SectionReference> scene_key_reference() {
    MistakeList mistakes;
    Reading reading(mistakes);
    reading.describes = true;
    SceneSpec scene;
    read_scene_document(
        document_of(
            "{ inset = [{}], body = [{}], probe = [{}], stage = [{ load = [{}], limit = [{}] }], "
            "render = { camera = { keys = [{}] }, light = {} } }"),
        {}, reading, scene);
    return reference(reading, scene_key_help());
}

std::vector<SectionReference> machine_key_reference() {
    MistakeList mistakes;
    Reading reading(mistakes);
    reading.describes = true;
    MachineSpec machine;
    read_machine_document(
        document_of("{ parameter = { any = {} }, tool = [{ shape = \"cylinder\" }, "
                    "{ shape = \"box\" }, { shape = \"mesh\" }], grip = [{}], blade = [{}], "
                    "load = [{}], check = [{}] }"),
        {}, reading, machine);
    return reference(reading, machine_key_help());
}

SectionReference expression_reference() {
    SectionReference all{"expressions", {}};
    const auto add = [&](const std::string& writing, const std::string& meaning) {
        all.key.push_back({writing, "", "", meaning});
    };
    add("2.5, 3 mm, 60 deg, pi", "numbers, with or without a unit");
    add("+ - * / ^ ( )", "as usual");
    add("< <= > >= == != && ||", "1 if true, else 0");
    add("a ? b : c", "b if a is true, else c");
    for (const auto& [name, meaning] : work_piece_names_told()) add(name, meaning);
    add("NAME", "a parameter of the machine");
    add("TOOL_x, TOOL_y, TOOL_z",
        "after a [[tool]]: its middle; of one with repeat only in its own motion");
    add("t", "in motions and strengths: time, 0 to 1 over the stage");
    add("stop",
        "as t, except for blades: the t at which a limit ([[stage.limit]]) was reached, 1 until "
        "then; motion written with min(t, stop) ends there");
    add("number", "in a part with repeat, and in its motion: which one it is, from 1");
    add("along", "in an edge that is a single point: how far along it is, 0 to 1");
    add("duration", "as t: duration of the stage, so that t*duration is the time within it");
    for (const FormulaFunction& f : formula_functions()) add(f.call, f.help);
    return all;
}

SectionReference unit_reference() {
    SectionReference all{"units", {}};
    all.key.push_back(
        {"a number alone", "", "", "is in SI units: metres, radians, seconds, pascals"});
    all.key.push_back(
        {"spelling", "", "", "m2 may be written m^2 or m\u00b2, and N m as N\u00b7m or N-m"});
    for (const std::string& name : quantity_names()) {
        const std::vector<std::string> units = unit_names(*quantity_named(name));
        if (!units.empty()) all.key.push_back({name, "", "", joined(units, ", ")});
    }
    return all;
}

}  // namespace swage
