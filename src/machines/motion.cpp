// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/motion.h"

#include <algorithm>

#include "base/text_error.h"

namespace swage {

namespace {

// Calls `body` and adds the expression to what it throws.
template <typename Body>
auto quoting(const Expression& text, const Body& body) {
    try {
        return body();
    } catch (const TextError& error) {
        throw TextError(error.at(), fmt::format("in \"{}\": {}", text, error.what()));
    }
}

std::vector<std::string> names_and_t(const Variables& known) {
    std::vector<std::string> names;
    for (const auto& [name, value] : known) names.push_back(name);
    names.push_back("t");
    return names;
}

}  // namespace

double evaluate(const Expression& text, const Variables& variables) {
    return quoting(text, [&] { return evaluate_text(text, variables); });
}

Vec3 evaluate(const Expression3& text, const Variables& variables) {
    return {evaluate(text[0], variables), evaluate(text[1], variables),
            evaluate(text[2], variables)};
}

Timed::Timed(const Expression& text, const Variables& known)
    : formula_(quoting(text, [&] { return Formula(text, names_and_t(known)); })) {
    for (const auto& [name, value] : known) value_.push_back(value);
    value_.push_back(0);
    const std::vector<std::string> used = formula_.used();
    varies_ = std::find(used.begin(), used.end(), "t") != used.end();
    if (!varies_) constant_ = quoting(text, [&] { return formula_.evaluate(value_); });
}

double Timed::at(double t) const {
    if (!varies_) return constant_;
    std::vector<double> value = value_;
    value.back() = t;
    return quoting(formula_.text(), [&] { return formula_.evaluate(value); });
}

Motion::Motion(const MotionSpec& spec, const Variables& known) : axis_(spec.axis) {
    for (const Expression& text : spec.move) move_.emplace_back(text, known);
    for (const Expression& text : spec.pivot) pivot_.emplace_back(text, known);
    turn_.emplace_back(spec.turn, known);
    if (!(axis_.norm() > 0)) fail(ExitCode::scene, "the axis of a motion has no length");
    axis_.normalize();
}

Pose Motion::at(double t) const {
    const Vec3 move(move_[0].at(t), move_[1].at(t), move_[2].at(t));
    const Vec3 pivot(pivot_[0].at(t), pivot_[1].at(t), pivot_[2].at(t));
    const double turn = turn_.front().at(t);
    const Quat rotation = turn_about(axis_, turn);
    return {rotation, pivot - rotation * pivot + move};
}

}  // namespace swage
