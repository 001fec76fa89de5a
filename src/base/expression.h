// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas that users write, compiled once and evaluated often: "angle/2*ramp(t, 0, 0.7)".
//
// Numbers may carry a unit ("2*radius + 3 mm", "60 deg"); values are SI. Operators: + - * / ^,
// < <= > >= == !=, && ||, CONDITION ? A : B. The constant pi. formula_functions() lists the
// functions; angles are in radians.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/text_error.h"

namespace swage {

class Formula {
  public:
    // `variables`: the names that the text may use. Throws TextError with the place in the text;
    // an unknown name gets a suggestion.
    Formula(const std::string& text, const std::vector<std::string>& variables);

    // Values in the order of `variables`. Throws TextError when the result is not finite. Safe to
    // call from any thread.
    double evaluate(std::span<const double> values) const;

    const std::string& text() const;
    const std::vector<std::string>& variables() const;
    std::vector<std::string> used() const;  // of the variables, those that the text names
    bool is_constant() const { return used().empty(); }

  private:
    struct Compiled;
    std::shared_ptr<Compiled> compiled_;  // copies of a formula share it
};

// Compiles and evaluates at once.
double evaluate_text(const std::string& text, const std::map<std::string, double>& variables);

struct FormulaFunction {
    std::string call;  // "ramp(t, a, b)"
    std::string help;
};
std::vector<FormulaFunction> formula_functions();

// Names that no variable may have: functions, constants and units.
bool is_reserved_name(const std::string& name);

}  // namespace swage
