// SPDX-License-Identifier: GPL-3.0-or-later
// Expressions with their variables, and the motions made of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/expression.h"
#include "base/math.h"
#include "machines/machine_spec.h"

namespace swage {

using Variables = std::map<std::string, double>;

// Throw PlacedError, which quotes the expression: it has no finite value, or one that is larger
// than its quantity's can be meant (base/units.h).
double evaluate(const Expression& text, const Variables& variables, Quantity quantity);
Vec3 evaluate(const Expression3& text, const Variables& variables, Quantity quantity);
// The same of any size.
double evaluate(const Expression& text, const Variables& variables);

// The value of an expression that may depend on t, and on stop: when the machine came no farther, 1
// where it goes all its way.
class Timed {
  public:
    // Compiles the expression, which sees `known`, t and stop. Throws PlacedError.
    Timed(const Expression& text, const Variables& known, Quantity quantity);
    // Safe to call from any thread. Throws as evaluate().
    double at(double t, double stop = 1) const;
    bool varies() const { return varies_; }

  private:
    Expression text_;
    Quantity quantity_;
    Formula formula_;
    std::vector<double> value_;  // of the formula's variables; the last are t and stop
    bool varies_;
    double constant_ = 0;
};

// Where a thing goes, as time goes from 0 to 1.
class Motion {
  public:
    // Compiles the expressions, which see `known`, t and stop. Throws PlacedError.
    Motion(const MotionSpec& spec, const Variables& known);

    // Where the motion takes a point of the work frame: moved_from_start * point. Safe to call from
    // any thread. Throws as evaluate().
    Pose at(double t, double stop = 1) const;

    Vec3 pivot_at(double t, double stop = 1) const;
    const Vec3& axis() const { return axis_; }  // of the turn; unit
    bool turns() const { return turn_[0].varies(); }

  private:
    std::vector<Timed> move_, pivot_, turn_;  // 3, 3, 1
    Vec3 axis_;
};

}  // namespace swage
