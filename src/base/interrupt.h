// SPDX-License-Identifier: GPL-3.0-or-later
// Whether somebody has asked the process to end, and the way out of what it is at.
#pragma once

#include <exception>

namespace swage {

// Thrown at a safe point; the process then exits with 128 + signal.
class Interrupted : public std::exception {
  public:
    explicit Interrupted(int signal) : signal_(signal) {}
    int signal() const { return signal_; }
    const char* what() const noexcept override { return "interrupted; complete files are kept"; }

  private:
    int signal_;
};

// A signal has come; the first counts. May be called by a signal handler.
void ask_to_stop(int signal);
int asked_to_stop();  // the signal, or 0

// A safe point: throws Interrupted when a signal has come.
void throw_if_interrupted();
// Whether it has thrown: the process is on its way out.
bool is_stopping();

}  // namespace swage
