// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/expressions.h"

#include <algorithm>
#include <cmath>

#include "base/ascii.h"

namespace swage {

const std::vector<std::pair<std::string, std::string>>& work_piece_names_told() {
    static const std::vector<std::pair<std::string, std::string>> told = {
        {"length", "size of the work-piece's box along the machine's x"},
        {"height", "size of that box along the machine's y"},
        {"width", "size of that box along the machine's z"},
        {"spacing", "spacing of the work-piece's lattice"},
        {"lattice_reach", "distance by which that lattice extends beyond the box"},
        {"material_friction",
         "friction of the work-piece, or of another body that touches the tool"}};
    return told;
}

const std::vector<std::string>& work_piece_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const auto& [name, meaning] : work_piece_names_told()) all.push_back(name);
        return all;
    }();
    return names;
}

void ExpressionReader::add_names(const std::vector<std::string>& names) {
    known_.insert(known_.end(), names.begin(), names.end());
}

ExpressionReader ExpressionReader::timed(bool stops) const {
    ExpressionReader reader = *this;
    reader.add_names({"t", "duration"});
    if (stops) reader.add_name(kStop);
    return reader;
}

bool ExpressionReader::sees_all_of(const Expression& text) const {
    try {
        if (text.empty()) return false;
        const Formula formula(text.text, known_);
        return true;
    } catch (const TextError&) {
        return false;
    }
}

ExpressionReader ExpressionReader::repeated() const {
    ExpressionReader reader = *this;
    reader.add_name(kNumber);
    return reader;
}

ExpressionReader ExpressionReader::curved() const {
    ExpressionReader reader = *this;
    reader.add_name(kAlong);
    reader.used_.clear();
    return reader;
}

namespace {

std::string word_at(const std::string& text, std::size_t at) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size()));
    return {begin, std::find_if_not(begin, text.end(), goes_on_name)};
}

// "roll_x" of "roll_2_x"; empty where it is no such name.
std::string without_number(const std::string& middle) {
    const std::size_t axis = middle.rfind('_');
    const std::size_t number =
        axis == 0 || axis == middle.npos ? middle.npos : middle.rfind('_', axis - 1);
    if (number == middle.npos || number + 1 == axis) return {};
    for (std::size_t n = number + 1; n < axis; ++n) {
        if (!is_digit(middle[n])) return {};
    }
    return middle.substr(0, number) + middle.substr(axis);
}

}  // namespace

void ExpressionReader::read_one(TableReader& table, const std::string& key, const Node& node,
                                Expression& into) {
    MistakeList& mistakes = table.reading().mistakes;
    if (node.kind == Node::Kind::whole || node.kind == Node::Kind::real) {
        if (std::isfinite(node.number)) {
            into = {fmt::format("{}", node.number), text_place(node.place)};
        } else {
            mistakes.add(node.place, key + " is not a finite number");
        }
        return;
    }
    if (node.kind != Node::Kind::text) {
        mistakes.add(node.place, fmt::format("{} is {}; expected a number or an expression", key,
                                             kind_text(node)));
        return;
    }
    try {
        const Formula formula(node.text, known_);
        for (const std::string& name : formula.used()) used_.insert(name);
        if (formula.is_constant()) {  // finite or refused
            table.reading().number[&node] =
                formula.evaluate(std::vector<double>(known_.size(), 0.0));
        }
        into = {node.text, text_place(node.place)};
    } catch (const TextError& error) {
        std::string what = error.what();
        const std::string word = word_at(node.text, error.at());
        const auto why = unseen_.find(word);
        const bool is_seen = std::find(known_.begin(), known_.end(), word) != known_.end();
        if (why != unseen_.end() && !is_seen && !is_reserved_name(word)) {
            what = fmt::format("unknown name \"{}\": {}", word, why->second);
        } else if (const auto one = unseen_.find(without_number(word));
                   one != unseen_.end() && !is_seen) {
            what = fmt::format("unknown name \"{}\": {}, as {}", word, one->second, one->first);
        }
        mistakes.add(place_inside(node, error.at()), key + ": " + what);
    }
}

bool ExpressionReader::read(TableReader& table, const std::string& key, Expression& into) {
    table.describe(key, "expression", into.text);
    const Node* node = table.find(key);
    if (node != nullptr) read_one(table, key, *node, into);
    return node != nullptr;
}

bool ExpressionReader::read(TableReader& table, const std::string& key, Expression3& into) {
    table.describe(key, "[x, y, z] of expressions",
                   fmt::format("[{}, {}, {}]", into[0].text, into[1].text, into[2].text));
    const Node* node = table.find(key);
    if (node != nullptr) read_item(table, key, *node, into);
    return node != nullptr;
}

void ExpressionReader::read_item(TableReader& table, const std::string& key, const Node& item,
                                 Expression3& into) {
    if (item.kind != Node::Kind::array || item.item.size() != 3) {
        table.reading().mistakes.add(
            item.place, key + " must be three numbers or expressions, such as [0, \"height\", 0]");
        return;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) read_one(table, key, item.item[axis], into[axis]);
}

void ExpressionReader::expect_meant(TableReader& table, const std::string& key, const Node& node,
                                    Quantity quantity, bool is_positive) const {
    const std::optional<double> value = certain(node);
    const std::string why = value ? why_not_meant(*value, quantity, is_positive) : "";
    if (!why.empty()) table.reading().mistakes.add(node.place, key + " = " + why);
}

void ExpressionReader::expect_unit(TableReader& table, const std::string& key, const Node& node,
                                   Quantity quantity) {
    expect_meant(table, key, node, quantity);
    const bool is_number = node.kind == Node::Kind::whole || node.kind == Node::Kind::real;
    if (is_number && quantity == Quantity::angle) table.warn_of_turns(key, node, node.number);
    if (node.kind != Node::Kind::text) return;
    const std::string_view text = node.text;
    const auto after_blanks = [&](std::size_t at) {
        return std::min(text.find_first_not_of(" \t\r\n", at), text.size());
    };
    try {
        std::size_t at = after_blanks(0);
        const auto number = leading_number(text.substr(at));
        if (!number) return;
        at = after_blanks(at + number->size);
        if (at == text.size() && quantity == Quantity::angle) {
            table.warn_of_turns(key, node, number->value);
        }
        const auto unit = leading_unit(text.substr(at));
        if (!unit || after_blanks(at + unit->size) != text.size()) return;
    } catch (const TextError&) {
        return;  // reported when it was read
    }
    try {
        parse_quantity(node.text, quantity);
    } catch (const TextError& error) {
        table.reading().mistakes.add(place_inside(node, error.at()), key + ": " + error.what());
    }
}

bool ExpressionReader::read(TableReader& table, const std::string& key, Quantity quantity,
                            Expression& into) {
    table.describe(key, quantity_name(quantity) + " or expression", into.text);
    if (!read(table, key, into)) return false;
    expect_unit(table, key, *table.find(key), quantity);
    return true;
}

bool ExpressionReader::read(TableReader& table, const std::string& key, Quantity quantity,
                            Expression3& into) {
    table.describe(key, fmt::format("[x, y, z] of {} or expression", quantity_name(quantity)));
    const Node* node = table.find(key);
    if (node != nullptr) read_item(table, key, *node, quantity, into);
    return node != nullptr;
}

void ExpressionReader::read_item(TableReader& table, const std::string& key, const Node& item,
                                 Quantity quantity, Expression3& into) {
    read_item(table, key, item, into);
    for (const Node& one : item.item) expect_unit(table, key, one, quantity);
}

std::optional<double> ExpressionReader::certain(const Node& node) const {
    if (node.kind == Node::Kind::whole || node.kind == Node::Kind::real) {
        return std::isfinite(node.number) ? std::optional(node.number) : std::nullopt;
    }
    if (node.kind != Node::Kind::text) return std::nullopt;
    try {
        const Formula formula(node.text, known_);
        if (!formula.is_constant()) return std::nullopt;
        return formula.evaluate(std::vector<double>(known_.size(), 0.0));
    } catch (const TextError&) {
        return std::nullopt;  // reported when it was read
    }
}

void ExpressionReader::expect_positive(TableReader& table, const std::string& key) {
    const Node* given = table.find(key);
    if (given == nullptr) return;
    const auto judge = [&](const Node& one) {
        const std::optional<double> value = certain(one);
        if (!value) return;
        if (*value <= 0) {
            table.reading().mistakes.add(one.place,
                                         fmt::format("{} = {} must be more than 0", key, *value));
        } else if (why_not_meant(*value, Quantity::length).empty()) {
            expect_meant(table, key, one, Quantity::length, true);
        }
    };
    if (given->kind != Node::Kind::array) return judge(*given);
    for (const Node& one : given->item) judge(one);
}

void ExpressionReader::expect_count(TableReader& table, const std::string& key, int most) {
    const Node* given = table.find(key);
    const std::optional<double> value = given != nullptr ? certain(*given) : std::nullopt;
    if (!value || (*value >= 0 && *value <= most && *value == std::round(*value))) return;
    table.mistake(key,
                  fmt::format("{} = {} must be a whole number from 0 to {}", key, *value, most));
}

void ExpressionReader::expect_direction(TableReader& table) {
    const Node* given = table.find("axis");
    if (given == nullptr || given->kind != Node::Kind::array || given->item.size() != 3) return;
    for (const Node& one : given->item) {
        if (certain(one) != 0.0) return;
    }
    table.mistake("axis", "axis = [0, 0, 0] has no direction");
}

}  // namespace swage
