// SPDX-License-Identifier: GPL-3.0-or-later
// A move that was given up on its way, and what it did until then.
#pragma once

#include <utility>

#include "base/error.h"
#include "sim/advance.h"

namespace swage {

// The report is of the way to where the matter has got to, at its time.
class GivenUp : public Error {
  public:
    GivenUp(const Error& why, FrameReport report) : Error(why), report_(std::move(report)) {}
    const FrameReport& report() const { return report_; }

  private:
    FrameReport report_;
};

}  // namespace swage
