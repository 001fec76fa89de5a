// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/motion.h"

#include <algorithm>

#include "base/text_error.h"

namespace swage {

namespace {

[[noreturn]] void refuse(const Expression& text, const std::string& why) {
    throw PlacedError(text.place, fmt::format("in \"{}\": {}", text.text, why));
}

// Calls `body` and adds the expression to what it throws.
template <typename Body>
auto quoting(const Expression& text, const Body& body) {
    try {
        return body();
    } catch (const TextError& error) {
        refuse(text, error.what());
    }
}

double meant(double value, const Expression& text, Quantity quantity) {
    const std::string why = why_not_meant(value, quantity);
    if (!why.empty()) refuse(text, why);
    return value;
}

std::vector<std::string> names_and_times(const Variables& known) {
    std::vector<std::string> names;
    for (const auto& [name, value] : known) names.push_back(name);
    names.push_back("t");
    names.push_back("stop");
    return names;
}

}  // namespace

double evaluate(const Expression& text, const Variables& variables) {
    return quoting(text, [&] { return evaluate_text(text.text, variables); });
}

double evaluate(const Expression& text, const Variables& variables, Quantity quantity) {
    return meant(evaluate(text, variables), text, quantity);
}

Vec3 evaluate(const Expression3& text, const Variables& variables, Quantity quantity) {
    return {evaluate(text[0], variables, quantity), evaluate(text[1], variables, quantity),
            evaluate(text[2], variables, quantity)};
}

Timed::Timed(const Expression& text, const Variables& known, Quantity quantity)
    : text_(text),
      quantity_(quantity),
      formula_(quoting(text, [&] { return Formula(text.text, names_and_times(known)); })) {
    for (const auto& [name, value] : known) value_.push_back(value);
    value_.insert(value_.end(), {0.0, 1.0});
    const std::vector<std::string> used = formula_.used();
    varies_ = std::any_of(used.begin(), used.end(),
                          [](const std::string& name) { return name == "t" || name == "stop"; });
    if (varies_) return;
    constant_ = meant(quoting(text, [&] { return formula_.evaluate(value_); }), text, quantity);
}

double Timed::at(double t, double stop) const {
    if (!varies_) return constant_;
    std::vector<double> value = value_;
    value[value.size() - 2] = t;
    value.back() = stop;
    return meant(quoting(text_, [&] { return formula_.evaluate(value); }), text_, quantity_);
}

Motion::Motion(const MotionSpec& spec, const Variables& known) {
    for (const Expression& text : spec.move) move_.emplace_back(text, known, Quantity::length);
    for (const Expression& text : spec.pivot) {
        pivot_.emplace_back(text.empty() ? "0" : text, known, Quantity::length);
    }
    turn_.emplace_back(spec.turn, known, Quantity::angle);
    axis_ = evaluate(spec.axis, known, Quantity::number);
    if (!(axis_.norm() > 0)) refuse(spec.axis[0], "the axis of a motion has no length");
    axis_.normalize();
}

Vec3 Motion::pivot_at(double t, double stop) const {
    return {pivot_[0].at(t, stop), pivot_[1].at(t, stop), pivot_[2].at(t, stop)};
}

Pose Motion::at(double t, double stop) const {
    const Vec3 move(move_[0].at(t, stop), move_[1].at(t, stop), move_[2].at(t, stop));
    const Vec3 pivot = pivot_at(t, stop);
    const double turn = turn_.front().at(t, stop);
    const Quat rotation = turn_about(axis_, turn);
    return {rotation, pivot - rotation * pivot + move};
}

}  // namespace swage
