// SPDX-License-Identifier: GPL-3.0-or-later
// The energy books of a stage, and what each of their entries is called and counts as.
#pragma once

#include <array>

namespace swage {

// Of one body, or of all.
struct Books {
    using IsPlain = Books;

    // Now, and when the stage began [J]; energy that a blade took at once was in it too.
    double kinetic = 0, kinetic_at_start = 0;
    double elastic = 0, elastic_at_start = 0;
    double contact = 0, contact_at_start = 0;  // in contacts and grips
    double among_at_start = 0;  // of that, in contacts with other bodies and itself [J]
    double work = 0, load_work = 0, gravity_work = 0;  // done on it since the stage began [J], by
                                                       // tools and grips, loads, gravity
    double passed = 0;  // to it by bodies that it touches, likewise; nothing in the sum of all
    double plastic = 0, damped = 0;  // taken since the stage began [J]
    double friction = 0, drag = 0;   // likewise; drag of the medium
    double severed_energy = 0;  // lost with severed connections, and where what lay on one side of
                                // a blade comes to move with the other, likewise [J]
    double fracture = 0;        // energy that breaking took, likewise [J]
    // While the drive stood, likewise [J]: what an equilibrium has less than the one before when
    // cracks have run on, a blade has cut or what held it is gone. Quasi-static only.
    double set_free = 0;
    // Of all work since the stage began, what none of the others accounts for [J]: in motion the
    // error of the steps; else what relaxation lets go where something snaps or is put on at once.
    double remainder = 0;

    void add(const Books& other);
    // What the others leave for the remainder.
    double left_over() const;
};

// What an entry counts as: work given to the body, energy that it holds, what other bodies pass to
// it, what is taken from it for good, and what is left of all that.
enum class BookSide { given, held, passed, taken, remaining };

struct BookEntry {
    const char* column;  // of a table
    const char* key;     // in run.json
    double Books::*value;
    BookSide side;
    double Books::*at_start = nullptr;  // of what is held
};

inline constexpr std::array<BookEntry, 15> kBookEntries{{
    {"kinetic energy [J]", "kinetic", &Books::kinetic, BookSide::held, &Books::kinetic_at_start},
    {"elastic energy [J]", "elastic", &Books::elastic, BookSide::held, &Books::elastic_at_start},
    {"contact energy [J]", "contact", &Books::contact, BookSide::held, &Books::contact_at_start},
    {"plastic work [J]", "plastic", &Books::plastic, BookSide::taken},
    {"damped work [J]", "damped", &Books::damped, BookSide::taken},
    {"friction work [J]", "friction", &Books::friction, BookSide::taken},
    {"drag work [J]", "drag", &Books::drag, BookSide::taken},
    {"machine work [J]", "machine_work", &Books::work, BookSide::given},
    {"load work [J]", "load_work", &Books::load_work, BookSide::given},
    {"gravity work [J]", "gravity_work", &Books::gravity_work, BookSide::given},
    {"severed energy [J]", "severed", &Books::severed_energy, BookSide::taken},
    {"fracture energy [J]", "fracture", &Books::fracture, BookSide::taken},
    {"set free [J]", "set_free", &Books::set_free, BookSide::taken},
    {"remainder [J]", "remainder", &Books::remainder, BookSide::remaining},
    {"passed to it [J]", "passed", &Books::passed, BookSide::passed},
}};
static_assert(sizeof(Books) == (kBookEntries.size() + 4) * sizeof(double),
              "each entry has its row, but for what stood at the start");

inline void Books::add(const Books& other) {
    for (const BookEntry& entry : kBookEntries) {
        this->*entry.value += other.*entry.value;
        if (entry.at_start != nullptr) this->*entry.at_start += other.*entry.at_start;
    }
    among_at_start += other.among_at_start;
}

inline double Books::left_over() const {
    double given = 0, held = 0, held_at_start = 0;
    for (const BookEntry& entry : kBookEntries) {
        if (entry.side == BookSide::given) given += this->*entry.value;
        if (entry.side != BookSide::held) continue;
        held += this->*entry.value;
        held_at_start += this->*entry.at_start;
    }
    double left = given + passed - (held - held_at_start);
    for (const BookEntry& entry : kBookEntries) {
        if (entry.side == BookSide::taken) left -= this->*entry.value;
    }
    return left;
}

}  // namespace swage
