// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_spec.h"

namespace swage {

MachineSpec::MachineSpec() = default;
MachineSpec::~MachineSpec() = default;
MachineSpec::MachineSpec(const MachineSpec&) = default;
MachineSpec::MachineSpec(MachineSpec&&) noexcept = default;
MachineSpec& MachineSpec::operator=(const MachineSpec&) = default;
MachineSpec& MachineSpec::operator=(MachineSpec&&) noexcept = default;

}  // namespace swage
