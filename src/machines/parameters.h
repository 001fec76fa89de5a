// SPDX-License-Identifier: GPL-3.0-or-later
// A machine's parameters: given ones checked, the rest by their defaults.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

struct ParameterMistake {
    std::string parameter, sentence;
    TextPlace place = {};  // of a default that cannot be
};

// Values of parameters that cannot be, so that a caller can say where each was given.
class ParameterError : public Error {
  public:
    explicit ParameterError(std::vector<ParameterMistake> mistakes)  // one at least
        : Error(ExitCode::scene, mistakes.front().sentence), mistakes_(std::move(mistakes)) {}
    const std::vector<ParameterMistake>& mistakes() const { return mistakes_; }

  private:
    std::vector<ParameterMistake> mistakes_;
};

// `known` are the variables of the work-piece. Returns every parameter, SI. Throws
// ParameterError naming machine, parameter, value and allowed range of all that are given wrong, or
// of the first default that cannot be.
Variables resolve_parameters(const MachineSpec& spec, const Variables& given,
                             const Variables& known);

}  // namespace swage
