// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of one body's surface may come to lie in which cells of another, or of its own.
#pragma once

#include "sim/contact_list.h"

namespace swage {

// All points within `margin` [m] of a cell at the surface, one contact for each place where they
// may meet it; of the last ones, those that touch are kept as they are. Sorted by point, in place
// of what `found` holds.
void find_contacts(const ContactSide& from, const ContactSide& onto, double margin,
                   const ContactList& last, ContactList& found);

}  // namespace swage
