// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>
#include <string>

#include "sim/books.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE(
    "what is given to a body or passed to it raises the remainder, what it holds or has lost "
    "lowers it, what it held at the start raises it") {
    for (const BookEntry& entry : kBookEntries) {
        Books books;
        books.*entry.value = 3;
        const bool comes = entry.side == BookSide::given || entry.side == BookSide::passed;
        INFO(entry.column);
        CHECK(books.left_over() == (comes ? 3 : entry.side == BookSide::remaining ? 0 : -3));
        CHECK((entry.at_start != nullptr) == (entry.side == BookSide::held));
        if (entry.at_start == nullptr) continue;
        books.*entry.at_start = 5;
        CHECK(books.left_over() == 2);
    }
}

TEST_CASE("the books of all bodies are the sums of theirs, entry by entry") {
    Books books, all;
    double value = 1;
    std::set<std::string> columns, keys;
    for (const BookEntry& entry : kBookEntries) {
        columns.insert(entry.column);
        keys.insert(entry.key);
        books.*entry.value = value++;
        if (entry.at_start != nullptr) books.*entry.at_start = value++;
    }
    books.among_at_start = value++;
    CHECK(value == 20);  // each has been given another
    CHECK(columns.size() == kBookEntries.size());
    CHECK(keys.size() == kBookEntries.size());
    all.add(books);
    all.add(books);
    CHECK(all.among_at_start == 2 * books.among_at_start);
    for (const BookEntry& entry : kBookEntries) {
        INFO(entry.column);
        CHECK(all.*entry.value == 2 * books.*entry.value);
        if (entry.at_start != nullptr) {
            CHECK(all.*entry.at_start == 2 * books.*entry.at_start);
        }
    }
}
