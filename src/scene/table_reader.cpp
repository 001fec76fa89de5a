// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/table_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/math.h"
#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

std::string example_of(Quantity quantity) {
    const std::vector<std::string> units = unit_names(quantity);
    if (quantity == Quantity::number || units.empty()) return "0.5";
    return "\"2 " + units.front() + "\"";
}

std::string with_unit(Quantity quantity) {
    const std::string unit = si_unit(quantity);
    return unit.empty() ? quantity_name(quantity) : quantity_name(quantity) + " [" + unit + "]";
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

// Names that people bring from elsewhere.
const std::map<std::string, std::string> kOtherNames = {
    {"E", "young_modulus"},
    {"nu", "poisson_ratio"},
    {"rho", "density"},
    {"youngs", "young_modulus"},
    {"stiffness", "young_modulus"},
    {"mu", "friction"},
    {"damping", "damping_ratio"},
    {"resolution", "across"},
    {"cells", "across"},
    {"fov", "field_of_view"},
    {"frame_rate", "fps"},
    {"start_frame", "first_frame"},
    {"path", "file"},
    {"type", "kind"},
    {"width", "size"},
    {"height", "size"},
    {"seconds", "duration"},
};

}  // namespace

std::string_view unit_in(std::string_view text) {
    const auto trim = [&] {
        text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    };
    trim();
    if (text.starts_with('+')) text.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    trim();
    return text;
}

void Reading::report_unknown() {
    for (const UnknownKey& one : unknown) {
        if (mistakes.is_full()) {
            mistakes.add(one.place, "unknown key");
            continue;
        }
        std::string text = fmt::format("unknown key \"{}\" in {}", one.key, one.section);
        std::vector<std::string> elsewhere;
        for (const auto& [section, keys] : known) {
            if (section != one.section && keys.contains(one.key)) elsewhere.push_back(section);
        }
        const auto other = kOtherNames.find(one.key);
        if (!elsewhere.empty()) {
            text += "; it belongs in " + joined(elsewhere, " or ");
        } else if (other != kOtherNames.end() && contains(one.known, other->second)) {
            text += fmt::format(", did you mean \"{}\"?", other->second);
        } else if (const std::string hint = did_you_mean(one.key, one.known); !hint.empty()) {
            text += hint;
        } else if (!one.known.empty()) {
            text += "; known: " + joined(one.known, ", ");
        }
        mistakes.add(one.place, text);
    }
    unknown.clear();
}

TableReader::TableReader(const Node& table, std::string section, Reading& reading)
    : node_(table), section_(std::move(section)), reading_(reading) {}

void TableReader::describe(const std::string& key, const std::string& takes,
                           const std::string& usual) {
    if (!reading_.describes) return;
    auto& forms = reading_.forms;
    auto section = std::find_if(forms.begin(), forms.end(),
                                [&](const auto& one) { return one.first == section_; });
    if (section == forms.end()) section = forms.insert(forms.end(), {section_, {}});
    std::vector<KeyForm>& keys = section->second;
    const auto at =
        std::find_if(keys.begin(), keys.end(), [&](const KeyForm& one) { return one.key == key; });
    if (at == keys.end()) {
        keys.push_back({key, takes, usual});
    } else if (at->takes.empty()) {
        *at = {key, takes, usual};
    }
}

const Node* TableReader::find(const std::string& key) {
    if (!contains(asked_, key)) asked_.push_back(key);
    describe(key, "");
    const Entry* entry = node_.find(key);
    return entry == nullptr ? nullptr : &entry->value;
}

void TableReader::mistake(const std::string& key, const std::string& text, ExitCode code) {
    const Entry* entry = node_.find(key);
    reading_.mistakes.add(entry == nullptr ? node_.place : entry->value.place, text, code);
}

void TableReader::warn(const std::string& key, const std::string& text) {
    const Entry* entry = node_.find(key);
    reading_.mistakes.warn(entry == nullptr ? node_.place : entry->value.place, text);
}

void TableReader::missing(const std::string& key, const std::string& what) {
    if (!reading_.is_complete) return;
    reading_.mistakes.add(node_.place, fmt::format("{} needs \"{}\": {}", section_, key, what));
}

void TableReader::warn_of_turns(const std::string& key, const Node& node, double angle) {
    if (!(std::abs(angle) > 2 * kPi)) return;
    reading_.mistakes.warn(node.place,
                           fmt::format("{0} = {1:g} without a unit is {1:g} rad, which is {2:.4g} "
                                       "turns; write degrees as \"{1:g} deg\"",
                                       key, angle, angle / (2 * kPi)));
}

bool TableReader::number(const std::string& key, const Node& node, Quantity quantity,
                         double& into) {
    if (node.kind == Node::Kind::whole || node.kind == Node::Kind::real) {
        if (!std::isfinite(node.number)) {
            reading_.mistakes.add(node.place, key + " is not a finite number");
            return false;
        }
        into = node.number;
        if (quantity == Quantity::angle) warn_of_turns(key, node, into);
        return true;
    }
    if (node.kind == Node::Kind::text) {
        try {
            into = parse_quantity(node.text, quantity);
            reading_.number[&node] = into;
            if (quantity == Quantity::angle && unit_in(node.text).empty())
                warn_of_turns(key, node, into);
            return true;
        } catch (const TextError& error) {
            reading_.mistakes.add(place_inside(node, error.at()), key + ": " + error.what());
            return false;
        }
    }
    reading_.mistakes.add(node.place,
                          fmt::format("{} is {}; expected {}, such as {}", key, kind_text(node),
                                      quantity_with_article(quantity), example_of(quantity)));
    return false;
}

// No range that a key has of its own needs to end where sense does.
bool TableReader::is_meant(const std::string& key, const Node& node, Quantity quantity,
                           double value, bool is_positive) {
    const std::string why = why_not_meant(value, quantity, is_positive);
    if (!why.empty()) reading_.mistakes.add(node.place, key + " = " + why);
    return why.empty();
}

void TableReader::describe_quantity(const std::string& key, Quantity quantity, const Range& range,
                                    double usual) {
    std::string takes = with_unit(quantity);
    if (std::isfinite(range.low) || std::isfinite(range.high)) takes += ", " + range.text(quantity);
    const bool tells = std::isfinite(usual) && range.holds(usual);
    describe(key, takes, tells ? quantity_text(usual, quantity) : "");
}

bool TableReader::quantity(const std::string& key, Quantity quantity, const Range& range,
                           double& into) {
    if (reading_.describes) describe_quantity(key, quantity, range, into);
    const Node* node = find(key);
    if (node != nullptr) value(key, *node, quantity, range, into);
    return node != nullptr;
}

bool TableReader::value(const std::string& key, const Node& node, Quantity quantity,
                        const Range& range, double& into) {
    double value = 0;
    if (!number(key, node, quantity, value)) return false;
    if (!range.holds(value)) {
        reading_.mistakes.add(node.place,
                              fmt::format("{} = {} is out of range: it must be {}", key,
                                          quantity_text(value, quantity), range.text(quantity)));
        return false;
    }
    if (!is_meant(key, node, quantity, value, range.low == 0 && range.low_open)) return false;
    into = value;
    return true;
}

bool TableReader::whole(const std::string& key, int low, int high, int& into) {
    describe(key, fmt::format("whole number, {} to {}", low, high), std::to_string(into));
    const Node* node = find(key);
    if (node == nullptr) return false;
    double value = 0;
    if (!number(key, *node, Quantity::number, value)) return true;
    if (value != std::floor(value)) {
        mistake(key,
                fmt::format("{} = {} must be a whole number, {} to {}", key, value, low, high));
    } else if (value < low || value > high) {
        mistake(key,
                fmt::format("{} = {} is out of range: it must be {} to {}", key, value, low, high));
    } else {
        into = static_cast<int>(value);
    }
    return true;
}

bool TableReader::truth(const std::string& key, bool& into) {
    describe(key, "true or false", into ? "true" : "false");
    const Node* node = find(key);
    if (node == nullptr) return false;
    if (node->kind == Node::Kind::truth) {
        into = node->truth;
    } else {
        mistake(key, fmt::format("{} must be true or false, without quotes", key));
    }
    return true;
}

bool TableReader::text(const std::string& key, std::string& into) {
    describe(key, "text", into.empty() ? "" : '"' + into + '"');
    const Node* node = find(key);
    if (node == nullptr) return false;
    if (node->kind == Node::Kind::text) {
        into = node->text;
    } else {
        mistake(key, fmt::format("{} is {}; expected text in quotes", key, kind_text(*node)));
    }
    return true;
}

bool TableReader::vector(const std::string& key, Quantity quantity, Vec3& into) {
    describe(key, "[x, y, z] of " + with_unit(quantity));
    const Node* node = find(key);
    if (node == nullptr) return false;
    if (node->kind != Node::Kind::array || node->item.size() != 3) {
        mistake(key, fmt::format("{} must be three numbers, such as [0, 0, 1]", key));
        return true;
    }
    Vec3 value;
    bool is_right = true;
    for (int axis = 0; axis < 3; ++axis) {
        const Node& item = node->item[static_cast<std::size_t>(axis)];
        is_right = number(key, item, quantity, value[axis]) &&
                   is_meant(key, item, quantity, value[axis]) && is_right;
    }
    if (is_right) into = value;
    return true;
}

bool TableReader::ends(const std::string& key, Quantity quantity, std::array<double, 2>& into) {
    describe(key, "[low, high]");
    const Node* node = find(key);
    if (node == nullptr) return false;
    if (node->kind != Node::Kind::array || node->item.size() != 2) {
        mistake(key, fmt::format("{} must be two values, the lower first", key));
        return true;
    }
    std::array<double, 2> value{};
    bool is_right = true;
    for (std::size_t end = 0; end < 2; ++end) {
        const Node& item = node->item[end];
        is_right = number(key, item, quantity, value[end]) &&
                   is_meant(key, item, quantity, value[end]) && is_right;
    }
    if (!is_right) return true;
    if (value[0] < value[1]) {
        into = value;
    } else {
        mistake(key, fmt::format("{}: the first must be less than the second", key));
    }
    return true;
}

int TableReader::chosen_name(const std::string& key, const std::vector<std::string>& names,
                             const std::string& usual) {
    describe(key, '"' + joined(names, "\" or \"") + '"', usual.empty() ? "" : '"' + usual + '"');
    const Node* node = find(key);
    if (node == nullptr) return -1;
    if (node->kind == Node::Kind::text) {
        const auto found = std::find(names.begin(), names.end(), node->text);
        if (found != names.end()) return static_cast<int>(found - names.begin());
        std::vector<std::string> quoted;
        for (const std::string& name : names) quoted.push_back("\"" + name + "\"");
        mistake(key, fmt::format("{} = \"{}\" is not one of {}{}", key, node->text,
                                 joined(quoted, ", "), did_you_mean(node->text, names)));
    } else {
        mistake(key, fmt::format("{} is {}; expected one of: {}", key, kind_text(*node),
                                 joined(names, ", ")));
    }
    return -1;
}

const Node& TableReader::table(const std::string& key) {
    static const Node empty;
    describe(key, "section");
    const Node* node = find(key);
    if (node == nullptr) return empty;
    if (node->kind == Node::Kind::table) return *node;
    mistake(key, fmt::format("{} is {}; expected a section", key, kind_text(*node)));
    return empty;
}

std::vector<const Node*> TableReader::tables(const std::string& key, const std::string& example) {
    describe(key, "sections " + example);
    std::vector<const Node*> found;
    const Node* node = find(key);
    if (node == nullptr) return found;
    if (node->kind != Node::Kind::array) {
        mistake(key, fmt::format("write {} in double brackets, as there can be several", example));
        return found;
    }
    for (const Node& item : node->item) {
        if (item.kind == Node::Kind::table) {
            found.push_back(&item);
        } else {
            reading_.mistakes.add(item.place, fmt::format("{} is {}; expected a section {}", key,
                                                          kind_text(item), example));
        }
    }
    return found;
}

bool TableReader::has_other_keys(const std::set<std::string>& than) const {
    return std::any_of(node_.entry.begin(), node_.entry.end(),
                       [&](const Entry& entry) { return !than.contains(entry.key); });
}

void TableReader::tell_known() {
    std::set<std::string>& known = reading_.known[section_];
    for (; told_ < asked_.size(); ++told_) known.insert(asked_[told_]);
}

void TableReader::narrow(std::string section) {
    tell_known();
    section_ = std::move(section);
}

void TableReader::finish() {
    tell_known();
    if (!judge_unknown_) return;
    for (const Entry& entry : node_.entry) {
        if (contains(asked_, entry.key)) continue;
        reading_.unknown.push_back({section_, entry.key, entry.place, asked_});
    }
}

}  // namespace swage
