// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/overhang.h"

namespace swage {

namespace {

constexpr int kPlaces = 8;  // along each axis

// The n-th of places that lie evenly in a cell, from 0 to 1.
Vec3 place_in_cell(int n) {
    const Vec3 at(n % kPlaces, n / kPlaces % kPlaces, n / (kPlaces * kPlaces));
    return (at + Vec3::Constant(0.5)) / kPlaces;
}

}  // namespace

CellFill Overhang::within(const CellFill& share, int k, double whole) const {
    CellFill part = share;
    part.fill = std::min(share.fill, whole);
    if (share.fill != 0) part.moment *= part.fill / share.fill;
    int in_inset = 0, in_both = 0, in_body = 0;
    Vec3 sum = Vec3::Zero();
    for (int n = 0; n < kPlaces * kPlaces * kPlaces; ++n) {
        const Vec3 local = place_in_cell(n);
        const Vec3 point = frame_.point(2 * (local + Vec3(share.i, share.j, k)));
        const bool is_body = body_.winding_number(point) > 0.5;
        const bool is_inset = inset_.winding_number(point) > 0.5;
        in_body += is_body, in_inset += is_inset;
        if (!is_body || !is_inset) continue;
        ++in_both;
        sum += local - Vec3::Constant(0.5);
    }
    // Too thin to be met, or all that the body has.
    if (in_inset == 0 || in_both == in_inset || in_both == in_body) return part;
    part.fill = std::min(share.fill * in_both / in_inset, whole);
    part.moment = in_both > 0 ? Vec3(part.fill / in_both * sum) : Vec3::Zero();
    return part;
}

}  // namespace swage
