// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_search.h"

#include "base/parallel.h"
#include "geometry/near_pairs.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // points
constexpr int kSheet = 3;  // cells nearer than this to each other are one place of contact

Box box_of_cell(const Vec3Array& position, const std::array<ParticleId, 8>& corner) {
    Box box;
    for (ParticleId p : corner) box.grow(position.at(p));
    return box;
}

// Of the many points of a body few are near a thin piece.
void keep_within(const std::vector<Box>& boxes, std::vector<int>& number,
                 std::vector<Vec3>& point) {
    Box all;
    for (const Box& box : boxes) all.grow(box);
    std::size_t kept = 0;
    for (std::size_t n = 0; n < point.size(); ++n) {
        if (!all.contains(point[n])) continue;
        number[kept] = number[n];
        point[kept++] = point[n];
    }
    number.resize(kept);
    point.resize(kept);
}

}  // namespace

void find_contacts(const ContactSide& from, const ContactSide& onto, double margin,
                   const ContactList& last, ContactList& found) {
    const Aggregate& other = onto.matter();
    margin += (onto.is_cut() ? onto.beyond() : kSliver) * other.lattice.spacing;
    std::vector<int> meeting = from.meeting();
    std::vector<Vec3> point(meeting.size());
    parallel_each(point.size(), kChunk,
                  [&](std::size_t n) { point[n] = from.position(meeting[n]); });
    const Box all = box_of(point).widened(margin);
    std::vector<CellId> cell;
    std::vector<Vec3i> site;
    std::vector<Box> box;
    auto run = other.lattice.cell_run.begin();
    for (CellId id : onto.whole_rim()) {
        while (id >= run->first + run->count) ++run;
        const int n = id - run->first;
        std::array<ParticleId, 8> c;
        for (int q = 0; q < 8; ++q) c[q] = run->corner(n, q);
        const Box one = box_of_cell(other.particle_position, c);
        if (!one.overlaps(all)) continue;
        cell.push_back(id);
        site.emplace_back(run->i + n, run->j, run->k);
        box.push_back(one.widened(margin));
    }
    if (onto.is_thin()) keep_within(box, meeting, point);
    const std::vector<NearPair> pair = near_pairs(point, box);

    found.contact.clear();
    found.memory.clear();
    std::size_t old = 0;
    const auto keep = [&] {
        if (!last.memory[old].history.touches) return;
        found.contact.push_back(last.contact[old]);
        found.memory.push_back(last.memory[old]);
    };
    const auto one_place = [](const Vec3i& a, const Vec3i& b) {
        return ((a - b).array().abs() <= kSheet).all();
    };
    std::vector<double> nearest;  // of those found at this point
    for (std::size_t n = 0; n < pair.size();) {
        const int at = pair[n].point, p = meeting[std::size_t(at)];
        for (; old < last.size() && last.contact[old].point < p; ++old) keep();
        const std::size_t first = found.size();
        for (; old < last.size() && last.contact[old].point == p; ++old) keep();
        const std::size_t kept = found.size();
        nearest.clear();
        for (; n < pair.size() && pair[n].point == at; ++n) {
            const int b = pair[n].box;
            if (&from == &onto && from.is_own_place(p, site[b])) continue;
            const double far = (box[b].center() - point[std::size_t(at)]).squaredNorm();
            bool is_new = true;
            for (std::size_t m = first; m < found.size() && is_new; ++m) {
                Contact& other_place = found.contact[m];
                if (!one_place(other_place.site, site[b])) continue;
                is_new = false;
                if (m < kept || far >= nearest[m - kept]) continue;
                nearest[m - kept] = far;
                other_place.cell = cell[b];
                other_place.site = site[b];
            }
            if (!is_new) continue;
            Contact contact;
            contact.cell = cell[b];
            contact.site = site[b];
            contact.point = p;
            found.contact.push_back(contact);
            found.memory.emplace_back();
            nearest.push_back(far);
        }
    }
    for (; old < last.size(); ++old) keep();
}

}  // namespace swage
