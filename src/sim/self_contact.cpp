// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/self_contact.h"

#include <utility>

#include "sim/vector_sums.h"

namespace swage {

namespace {

const std::vector<char> kAwake = {0};

}  // namespace

SelfContact::SelfContact(Aggregate& matter, const SimSettings& settings) {
    if (!settings.self_contact) return;
    contact_ = std::make_unique<BodyContact>(std::vector<Aggregate*>{&matter}, settings);
    unused_.resize(matter.particle_count());
}

void SelfContact::begin_move() {
    if (contact_ == nullptr) return;
    start_ = contact_->save();
    start_sums_ = sums_;
    lets_be_ = false;
}

double SelfContact::take_back() {
    if (contact_ == nullptr) return 0;
    contact_->restore(*start_);
    sums_ = start_sums_;
    if (!std::exchange(lets_be_, false)) return 0;
    find();
    contact_->meet_anew();
    return start_sums_.stored - sums_.stored;
}

// Forces were last found anywhere: a try of another way, a step back.
void SelfContact::find() {
    set_zero(unused_.size(), unused_);
    add_forces(unused_);
}

bool SelfContact::presses() {
    if (contact_ == nullptr) return false;
    contact_->renew(kAwake);
    if (!is_near()) return false;
    find();
    return sums_.contacts > 0;
}

bool SelfContact::meet_anew() {
    if (contact_ == nullptr) return false;
    contact_->meet_anew();
    return sums_.contacts > 0;
}

double SelfContact::commit() {
    if (contact_ == nullptr) return 0;
    find();
    contact_->commit(kAwake);
    return sums_.friction;
}

void SelfContact::connections_changed() {
    if (contact_ == nullptr) return;
    contact_->connections_changed(0);
    find();
    contact_->commit(kAwake);
}

void SelfContact::add_forces(Vec3Array& force) {
    if (contact_ == nullptr) return;
    contact_->renew(kAwake);
    std::vector<ContactSums> sums;
    contact_->add_forces({&force}, Vec3::Zero(), 0, kAwake, sums);
    sums_ = sums[0];
}

void SelfContact::add_stiffness(std::vector<double>& stiffness) {
    if (contact_ == nullptr) return;
    contact_->add_stiffness(stiffness);
    weighed_ = contact_->candidates();
}

std::vector<PressedPlaces> SelfContact::pressed() const {
    return contact_ != nullptr ? contact_->pressed() : std::vector<PressedPlaces>{};
}

int SelfContact::let_be(double deeper) {
    if (contact_ == nullptr) return 0;
    const int count = contact_->let_be(deeper);
    lets_be_ = lets_be_ || count > 0;
    return count;
}

}  // namespace swage
