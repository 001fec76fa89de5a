// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_flow_curve.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "laws/flow_forms.h"

namespace swage {

namespace {

constexpr const char* kWanted =
    "a list of points [strain, \"stress\"], such as [[0, \"250 MPa\"], [0.1, \"400 MPa\"]], or "
    "one of the forms {K, e0, n}, {A, B, n} and {s0, Q, b}";
constexpr double kMostStrain = 10;                      // of a point: more is meant in percent
constexpr double kLeastStep = 1e-9;                     // between points
constexpr Range kStress = {.low = 1e-3, .high = 1e15};  // [Pa]
constexpr double kUnitless = 1e-3;   // of the largest stress with a unit: less lacks its own
constexpr double kLeastPower = 0.1;  // of Ludwik's form, which is too steep at its beginning

// A stress that stands without a unit among others that have one, and is nothing beside them: one
// was forgotten. Whether there is such a one, which is then told.
bool lacks_unit(TableReader& table, const std::vector<const Node*>& stress) {
    const auto pascals = [](const Node& node) -> std::optional<double> {
        if (node.kind != Node::Kind::text) return node.number;
        try {
            return parse_quantity(node.text, Quantity::stress);
        } catch (const TextError&) {
            return std::nullopt;
        }
    };
    const auto says_unit = [](const Node& node) {
        return node.kind == Node::Kind::text && !unit_in(node.text).empty();
    };
    const Node* largest = nullptr;
    for (const Node* one : stress) {
        const bool counts = says_unit(*one) && pascals(*one);
        if (counts && (!largest || *pascals(*one) > *pascals(*largest))) largest = one;
    }
    if (largest == nullptr) return false;
    bool any = false;
    for (const Node* one : stress) {
        const bool is_plain = one->kind == Node::Kind::text || one->kind == Node::Kind::whole ||
                              one->kind == Node::Kind::real;
        if (!is_plain || says_unit(*one) || !pascals(*one)) continue;
        const double value = *pascals(*one);
        if (!(value > 0 && value < kUnitless * *pascals(*largest))) continue;
        table.reading().mistakes.add(
            one->place, fmt::format("flow_curve: {0:g} without a unit is {0:g} Pa, next to "
                                    "\"{1}\": is a unit missing, as in \"{0:g} {2}\"?",
                                    value, largest->text, unit_in(largest->text)));
        any = true;
    }
    return any;
}

// Points that say how matter hardens; none after a mistake.
std::vector<FlowPoint> read_points(TableReader& table, const Node& list) {
    std::vector<FlowPoint> point;
    const auto mistake = [&](const Node& at, const std::string& text) {
        table.reading().mistakes.add(at.place, "flow_curve: " + text);
        return std::vector<FlowPoint>{};
    };
    std::vector<const Node*> stress;
    for (const Node& item : list.item) {
        if (item.kind == Node::Kind::array && item.item.size() == 2) {
            stress.push_back(&item.item[1]);
        }
    }
    if (lacks_unit(table, stress)) return {};
    for (const Node& item : list.item) {
        if (item.kind != Node::Kind::array || item.item.size() != 2) {
            return mistake(item,
                           std::string("each point must be a pair [strain, \"stress\"], such as ") +
                               "[0.1, \"400 MPa\"]");
        }
        FlowPoint next{};
        const bool right =
            table.value("flow_curve", item.item[0], Quantity::number, between(0, kMostStrain),
                        next.strain) &&
            table.value("flow_curve", item.item[1], Quantity::stress, kStress, next.stress);
        if (!right) return {};
        if (point.empty() && next.strain != 0) {
            return mistake(
                item.item[0],
                "the first point is where plastic flow begins: its plastic strain must be 0");
        }
        if (!point.empty() && !(next.strain - point.back().strain > kLeastStep)) {
            return mistake(
                item.item[0],
                fmt::format(
                    "a strain of {:g} after one of {:g}: strains must rise, each by more than {:g}",
                    next.strain, point.back().strain, kLeastStep));
        }
        if (!point.empty() && next.stress < point.back().stress) {
            return mistake(
                item.item[1],
                fmt::format(
                    "the stress falls from {} to {}: matter that softens would flow in a single "
                    "row of cells, however small these are, so its strength would never converge",
                    quantity_text(point.back().stress, Quantity::stress),
                    quantity_text(next.stress, Quantity::stress)));
        }
        point.push_back(next);
    }
    if (point.size() < 2) {
        return mistake(
            list,
            "it needs at least two points; for flow at constant stress use yield_stress instead");
    }
    return point;
}

// A closed form: its three numbers and an example.
struct FormKey {
    const char* key;
    Quantity quantity;
    Range range;
};
struct FormKeys {
    FormKey number[3];
    const char* example;
};
const FormKeys kSwift = {{{"K", Quantity::stress, kStress},
                          {"e0", Quantity::number, between(1e-12, 1)},
                          {"n", Quantity::number, {0, 1, true, false}}},
                         "{K = \"530 MPa\", e0 = 0.005, n = 0.2}"};
const FormKeys kLudwik = {{{"A", Quantity::stress, kStress},
                           {"B", Quantity::stress, between(0, kStress.high)},
                           {"n", Quantity::number, between(kLeastPower, 1)}},
                          "{A = \"90 MPa\", B = \"292 MPa\", n = 0.31}"};
const FormKeys kVoce = {{{"s0", Quantity::stress, kStress},
                         {"Q", Quantity::stress, between(0, kStress.high)},
                         {"b", Quantity::number, {0, 1e6, true, false}}},
                        "{s0 = \"140 MPa\", Q = \"160 MPa\", b = 9}"};

std::vector<FlowPoint> read_form(TableReader& table, const Node& node) {
    const FormKeys* const like = node.find("K")   ? &kSwift
                                 : node.find("A") ? &kLudwik
                                 : node.find("Q") ? &kVoce
                                                  : nullptr;
    if (like == nullptr) {
        table.mistake("flow_curve", std::string("flow_curve is ") + kWanted);
        return {};
    }
    TableReader form(node, "flow_curve", table.reading());
    double a[3];
    std::vector<const Node*> stress;
    for (const auto& [key, quantity, range] : like->number) {
        const Entry* given = node.find(key);
        if (given != nullptr && quantity == Quantity::stress) stress.push_back(&given->value);
    }
    bool right = !lacks_unit(table, stress);
    for (int n = 0; n < 3; ++n) {
        const auto& [key, quantity, range] = like->number[n];
        const Node* given = form.find(key);
        if (given == nullptr) {
            form.missing(key, std::string("as in flow_curve = ") + like->example);
        }
        right = given != nullptr && form.value(key, *given, quantity, range, a[n]) && right;
    }
    form.finish();
    if (!right) return {};
    return like == &kSwift    ? points_of(SwiftForm{a[0], a[1], a[2]})
           : like == &kLudwik ? points_of(LudwikForm{a[0], a[1], a[2]})
                              : points_of(VoceForm{a[0], a[1], a[2]});
}

}  // namespace

bool is_infinite(const Node* node) {
    if (node == nullptr) return false;
    if (node->kind == Node::Kind::real) return std::isinf(node->number) && node->number > 0;
    if (node->kind != Node::Kind::text) return false;
    std::string_view text = node->text;
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    if (text.starts_with('+')) text.remove_prefix(1);
    if (!text.starts_with("inf")) return false;
    try {
        parse_quantity("1 " + std::string(text.substr(3)), Quantity::stress);
        return true;
    } catch (const TextError&) {
        return false;
    }
}

void read_flow(TableReader& table, Material& material) {
    const bool had_curve = !material.flow_curve.empty();
    const bool has_yield = table.find("yield_stress") != nullptr;
    if (is_infinite(table.find("yield_stress"))) {
        material.yield_stress = std::numeric_limits<double>::infinity();
    } else {
        table.quantity("yield_stress", Quantity::stress, above(0), material.yield_stress);
    }
    const bool has_hardening =
        table.quantity("hardening", Quantity::stress, between(0, kStress.high), material.hardening);
    const Node* curve = table.find("flow_curve");
    if (curve == nullptr) {
        if (has_yield) material.flow_curve.clear();
        if (!had_curve) return;
        if (has_yield && !has_hardening && material.yields()) {
            table.warn("yield_stress",
                       fmt::format("yield_stress replaces the flow_curve of {}: give hardening "
                                   "too, or the flow stress stays constant",
                                   material.name));
        } else if (has_hardening && !has_yield) {
            table.mistake("hardening",
                          fmt::format("{} hardens by its flow_curve: give yield_stress beside "
                                      "hardening, or another flow_curve",
                                      material.name));
        }
        return;
    }
    if (has_yield) {
        table.mistake("yield_stress",
                      "yield_stress is given by the first point of flow_curve: leave it out");
    }
    if (has_hardening) {
        table.mistake("hardening", "hardening is given by flow_curve: leave one of them out");
    }
    std::vector<FlowPoint> points;
    if (curve->kind == Node::Kind::array) {
        points = read_points(table, *curve);
    } else if (curve->kind == Node::Kind::table) {
        points = read_form(table, *curve);
    } else {
        table.mistake("flow_curve",
                      fmt::format("flow_curve is {}; expected {}", kind_text(*curve), kWanted));
    }
    if (!points.empty()) material.flow_along(std::move(points));
}

}  // namespace swage
