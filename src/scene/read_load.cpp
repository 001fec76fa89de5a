// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_load.h"

#include <algorithm>

#include "base/ascii.h"
#include "sim/books.h"

namespace swage {

bool is_part_name(const std::string& text) {
    return !text.empty() && begins_name(text[0]) && text.size() <= 64 &&
           std::all_of(text.begin(), text.end(), goes_on_name);
}

// "load work [J]" and the like are columns of the curves already, whatever parts there are.
bool is_reserved(const std::string& name) {
    return std::any_of(kBookEntries.begin(), kBookEntries.end(),
                       [&](const BookEntry& entry) { return entry.column == name + " work [J]"; });
}

std::string usual_load_name(std::size_t number) { return fmt::format("load_{}", number); }

std::string read_part_name(TableReader& table, std::set<std::string>& names) {
    std::string name;
    if (!table.text("name", name)) {
        table.missing("name", "letters, digits and _");
    } else if (!is_part_name(name)) {
        table.mistake(
            "name",
            fmt::format("\"{}\" must be letters, digits and _, beginning with a letter", name));
    } else if (is_reserved(name)) {
        table.mistake("name", fmt::format("\"{}\" is reserved; choose another name", name));
    } else if (!names.insert(name).second) {
        table.mistake("name", fmt::format("two parts are called \"{}\"", name));
    }
    return name;
}

void read_load_keys(TableReader& table, ExpressionReader& expression, LoadSpec& load) {
    Expression3 force = {"0", "0", "0"};
    const bool has_force = expression.read(table, "force", Quantity::force, force);
    const bool has_pressure = expression.read(table, "pressure", Quantity::stress, load.pressure);
    if (has_force) load.force = force;
    if (has_force && has_pressure) {
        table.mistake("pressure", "a load is a force or a pressure: give one of them");
    } else if (!has_force && !has_pressure) {
        table.missing("force",
                      "three forces, such as [0, \"-50 N\", 0]; or pressure, such as \"2 kPa\"");
    }
    table.choice<Side>("on",
                       {{"all", Side::all},
                        {"left", Side::left},
                        {"right", Side::right},
                        {"bottom", Side::bottom},
                        {"top", Side::top},
                        {"back", Side::back},
                        {"front", Side::front},
                        {"inside", Side::inside}},
                       load.on);
    std::array<Expression3, 2> box;
    const bool has_from = expression.read(table, "from", Quantity::length, box[0]);
    const bool has_to = expression.read(table, "to", Quantity::length, box[1]);
    if (has_from != has_to) {
        table.mistake(has_from ? "from" : "to",
                      "from and to are opposite corners of a box: give both");
    }
    if (has_from && has_to) load.box = box;
    ExpressionReader timed = expression.timed();
    timed.read(table, "strength", Quantity::number, load.strength);
    expression.take_used(timed);
}

}  // namespace swage
