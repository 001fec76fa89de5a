// SPDX-License-Identifier: GPL-3.0-or-later
// A mistake inside a short text that a user wrote: a quantity, an expression.
#pragma once

#include <cstddef>

#include "base/error.h"
#include "base/text.h"

namespace swage {

class TextError : public Error {
  public:
    // `at`: byte of the text where the mistake begins, from 0.
    TextError(std::size_t at, const std::string& sentence)
        : Error(ExitCode::scene, printable(sentence)), at_(at) {}  // what() ends at a 0
    std::size_t at() const { return at_; }

  private:
    std::size_t at_;
};

}  // namespace swage
