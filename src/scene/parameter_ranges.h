// SPDX-License-Identifier: GPL-3.0-or-later
// A machine's parameter ranges as far as they are certain before the work-piece is known.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/expression.h"
#include "machines/machine_spec.h"
#include "scene/table_reader.h"

namespace swage {

class ParameterRanges {
  public:
    explicit ParameterRanges(const MachineSpec& machine);

    // The range of each parameter, in the machine's order, with the `given` values; an end that
    // depends on what is not known yet is open to anything.
    std::vector<Range> ranges(const std::map<std::string, double>& given) const;

    // The values of those that are certain.
    std::map<std::string, double> values(const std::map<std::string, double>& given) const;

  private:
    struct Bound {  // an expression, and whose values it needs
        std::shared_ptr<const Formula> formula;
        std::vector<std::size_t> needs;
    };
    Bound bound(const Expression& text) const;
    static std::optional<double> value(const Bound& bound,
                                       const std::vector<std::optional<double>>& known);
    // Of the work-piece's names and the parameters.
    std::vector<std::optional<double>> known(const std::map<std::string, double>& given) const;

    std::vector<std::string> name_;  // of the work-piece, then of the parameters
    std::size_t first_parameter_;
    std::vector<Bound> default_, low_, high_;
};

}  // namespace swage
