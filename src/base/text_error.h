// SPDX-License-Identifier: GPL-3.0-or-later
// A mistake inside a short text that a user wrote: a quantity, an expression.
#pragma once

#include <cstddef>
#include <filesystem>
#include <utility>

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

// Where such a text stands; without a file: nowhere.
struct TextPlace {
    std::filesystem::path file;  // as shown to the user
    int line = 0, column = 0;    // from 1; 0: the file as a whole
};

// A mistake that came to light far from the text that holds it.
class PlacedError : public Error {
  public:
    PlacedError(TextPlace place, const std::string& sentence, ExitCode code = ExitCode::scene)
        : Error(code, sentence), place_(std::move(place)) {}
    const TextPlace& place() const { return place_; }

  private:
    TextPlace place_;
};

}  // namespace swage
