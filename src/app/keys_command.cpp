// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <sstream>

#include "app/command.h"
#include "app/word_wrap.h"
#include "base/error.h"
#include "base/suggest.h"
#include "scene/key_reference.h"

namespace swage {

namespace {

struct KeysArguments {
    std::string word;
    bool machine = false, json = false;
};

std::string bare(const std::string& section) {
    std::string name;
    for (char c : section) {
        if (c != '[' && c != ']') name += c;
    }
    return name;
}

// As --set has them: "stage.2.load.1" is of [[stage.load]].
std::string without_numbers(const std::string& section) {
    std::string name, word;
    for (std::istringstream words(section); std::getline(words, word, '.');) {
        if (word.find_first_not_of("0123456789*") == word.npos) continue;
        name += (name.empty() ? "" : ".") + word;
    }
    return name;
}

// Of a word that is none: the nearest of those that are. "render.colour" is near "render.color".
std::string hint_for(const std::vector<SectionReference>& all, const std::string& name) {
    const std::size_t dot = name.rfind('.');
    std::vector<std::string> known;
    for (const SectionReference& one : all) {
        known.push_back(bare(one.section));
        for (const KeyReference& key : one.key) {
            known.push_back(dot == name.npos ? key.key : bare(one.section) + "." + key.key);
        }
    }
    if (dot == name.npos) return did_you_mean(name, known);
    const std::string section = without_numbers(name.substr(0, dot));
    return did_you_mean((section.empty() ? "" : section + ".") + name.substr(dot + 1), known);
}

// The sections of that name and what lies in them, or else the keys of that name. `others`: where
// to look for what is not there, by --machine or without.
std::vector<SectionReference> chosen(const std::vector<SectionReference>& all,
                                     const std::string& word,
                                     const std::vector<SectionReference>& others, bool machine) {
    const std::string name = bare(word);
    std::vector<SectionReference> found;
    for (const SectionReference& one : all) {
        const std::string section = bare(one.section);
        if (section == name || section.starts_with(name + ".") || section.ends_with("." + name)) {
            found.push_back(one);
        }
    }
    if (!found.empty()) return found;
    // "render.color", "stage.1.frames": a key of that section.
    if (const std::size_t dot = name.rfind('.'); dot != name.npos) {
        const std::string wanted = without_numbers(name.substr(0, dot));
        for (const SectionReference& one : all) {
            const std::string section = bare(one.section);
            if (section != wanted && !section.ends_with("." + wanted)) continue;
            SectionReference part{one.section, {}};
            for (const KeyReference& key : one.key) {
                if (key.key == name.substr(dot + 1)) part.key.push_back(key);
            }
            if (!part.key.empty()) found.push_back(part);
        }
        if (!found.empty()) return found;
    }
    for (const SectionReference& one : all) {
        SectionReference part{one.section, {}};
        for (const KeyReference& key : one.key) {
            if (key.key == name) part.key.push_back(key);
        }
        if (!part.key.empty()) found.push_back(part);
    }
    if (!found.empty()) return found;
    for (const SectionReference& one : others) {
        const bool is_there =
            bare(one.section) == name ||
            std::ranges::any_of(one.key, [&](const KeyReference& key) { return key.key == name; });
        if (!is_there) continue;
        fail(ExitCode::command_line, "there is no section or key \"{}\" in {}", word,
             machine ? "machine files; swage keys lists those of scenes"
                     : "scenes; swage keys --machine lists those of machine files");
    }
    const std::string hint = hint_for(all, name);
    fail(ExitCode::command_line, "there is no section or key \"{}\"{}", word,
         without_numbers(name).starts_with("stage.")
             ? hint_and(hint, "the command swage machines NAME lists those of a machine")
             : hint);
}

std::string section_text(const SectionReference& section) {
    std::size_t width = 0;
    for (const KeyReference& key : section.key) width = std::max(width, key.key.size());
    std::string text = section.section + "\n";
    for (const KeyReference& key : section.key) {
        text += "  " + key.key + std::string(width - key.key.size() + 2, ' ');
        if (key.takes.empty()) {  // of expressions
            text += wrapped(key.help, width + 4, width + 4) + "\n";
            continue;
        }
        const std::string usual = key.usual.empty() ? "" : "; default " + key.usual;
        text += wrapped(key.takes + usual, width + 4, width + 4) + "\n";
        text += std::string(width + 4, ' ') + wrapped(key.help, width + 4, width + 4) + "\n";
    }
    return text;
}

int keys(const KeysArguments& given) {
    std::vector<SectionReference> all = scene_key_reference(), others = machine_key_reference();
    others.push_back(expression_reference());
    if (given.machine) std::swap(all, others);
    all.push_back(unit_reference());
    if (!given.word.empty()) all = chosen(all, given.word, others, given.machine);
    if (given.json) {
        Json list = Json::array();
        for (const SectionReference& section : all) {
            for (const KeyReference& key : section.key) {
                list.push_back({{"section", section.section},
                                {"key", key.key},
                                {"takes", key.takes},
                                {"default", key.usual},
                                {"help", key.help}});
            }
        }
        put_json(list);
        return 0;
    }
    std::string text;
    for (const SectionReference& section : all) {
        text += (text.empty() ? "" : "\n") + section_text(section);
    }
    put_out(text);
    return 0;
}

}  // namespace

void add_keys_command(CLI::App& app, Action& chosen) {
    static KeysArguments given;
    CLI::App* command = add_command(app, "keys", "List every key that a scene can have",
                                    "  swage keys\n"
                                    "  swage keys stage\n"
                                    "  swage keys young_modulus\n"
                                    "  swage keys render.color\n"
                                    "  swage keys --machine\n"
                                    "  swage keys --machine expressions\n",
                                    chosen, [] { return keys(given); });
    command->add_option("word", given.word, "a section, a key, or both as in render.color")
        ->type_name("WORD");
    command->add_flag("--machine", given.machine,
                      "list the keys of machine files instead, and what their expressions can use");
    command->add_flag("--json", given.json, "print JSON");
}

}  // namespace swage
