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

// Throw TextError, which quotes the expression.
double evaluate(const Expression& text, const Variables& variables);
Vec3 evaluate(const Expression3& text, const Variables& variables);

// The value of an expression that may depend on t.
class Timed {
  public:
    // Compiles the expression, which sees `known` and t. Throws TextError.
    Timed(const Expression& text, const Variables& known);
    // Safe to call from any thread. Throws TextError when there is no finite value.
    double at(double t) const;

  private:
    Formula formula_;
    std::vector<double> value_;  // of the formula's variables; the last is t
    bool varies_;
    double constant_ = 0;
};

// Where a thing goes, as time goes from 0 to 1.
class Motion {
  public:
    // Compiles the expressions, which see `known` and t. Throws TextError.
    Motion(const MotionSpec& spec, const Variables& known);

    // Where the motion takes a point of the work frame: moved_from_start * point. Safe to call from
    // any thread. Throws TextError when an expression has no finite value.
    Pose at(double t) const;

  private:
    std::vector<Timed> move_, pivot_, turn_;  // 3, 3, 1
    Vec3 axis_;
};

}  // namespace swage
