// SPDX-License-Identifier: GPL-3.0-or-later
// A machine's parameters: given ones checked, the rest by their defaults.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "base/error.h"
#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

// A parameter's value that cannot be, so that a caller can say where it was given.
class ParameterError : public Error {
  public:
    ParameterError(std::string parameter, const std::string& sentence)
        : Error(ExitCode::scene, sentence), parameter_(std::move(parameter)) {}
    const std::string& parameter() const { return parameter_; }

  private:
    std::string parameter_;
};

// `known` are the variables of the work-piece. Returns every parameter, SI. Throws
// ParameterError naming machine, parameter, value and allowed range.
Variables resolve_parameters(const MachineSpec& spec, const Variables& given,
                             const Variables& known);

}  // namespace swage
