// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/bytes.h"

#include <deque>
#include <limits>
#include <optional>

#include "tests/catch.h"

using namespace swage;

namespace {

struct Large {
    Large() { ++made; }
    static inline int made = 0;
    std::array<double, 1000> room{};
    std::vector<int> number;
    template <typename Io>
    void visit(Io& io) {
        io(number);
    }
};

// A matrix that says to be so large, of so many numbers.
std::string matrix_bytes(std::int64_t rows, std::int64_t columns, std::size_t numbers) {
    ByteWriter out;
    out(rows, columns, std::vector<double>(numbers, 0.5));
    return out.bytes();
}

template <typename T>
T read(const std::string& bytes) {
    ByteReader in(bytes);
    return in.get<T>();
}

}  // namespace

TEST_CASE("a matrix comes back as it was") {
    for (const auto& [rows, columns] : {std::pair(3, 2), {1, 7}, {0, 0}, {0, 4}, {4, 0}}) {
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(rows, columns);
        ByteWriter out;
        out(matrix);
        const auto back = read<Eigen::MatrixXd>(out.bytes());
        REQUIRE(back.rows() == rows);
        REQUIRE(back.cols() == columns);
        CHECK((back.size() == 0 || back == matrix));
    }
}

TEST_CASE("a matrix whose size is not that of its numbers is refused") {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    CHECK(read<Eigen::MatrixXd>(matrix_bytes(2, 3, 6)).size() == 6);
    const std::pair<std::int64_t, std::int64_t> wrong[] = {
        {2, 2},         {3, 3},
        {6, 0},         {0, 6},
        {-2, -3},       {kMost, 6},
        {6, kMost},     {kMost, kMost},
        {kMost / 2, 2}, {std::int64_t(1) << 33, std::int64_t(1) << 31},
        {-kMost, 1},    {1, -kMost},
    };
    for (const auto& [rows, columns] : wrong) {
        INFO(rows << " x " << columns);
        CHECK_THROWS_AS(read<Eigen::MatrixXd>(matrix_bytes(rows, columns, 6)), Error);
    }
    CHECK_THROWS_AS(read<Eigen::MatrixXd>(matrix_bytes(std::int64_t(1) << 62, 4, 0)), Error);
    CHECK_THROWS_AS(read<Eigen::MatrixXd>(matrix_bytes(kMost, 0, 0)), Error);
}

TEST_CASE("a count that is no truth ends with the bytes, before it takes room") {
    ByteWriter out;
    out(std::uint64_t(30'000));
    const std::string bytes = out.bytes() + std::string(30'000, '\xff');
    Large::made = 0;
    CHECK_THROWS_AS(read<std::vector<Large>>(bytes), Error);
    CHECK_THROWS_AS(read<std::deque<Large>>(bytes), Error);
    CHECK(Large::made < 10);
}

TEST_CASE("what is read into is changed only where the bytes say so, and is as long as they say") {
    for (const std::size_t length : {0, 2, 5}) {
        std::vector<Large> there(3), from(length);
        there[0].room[7] = 1;
        for (std::size_t n = 0; n < length; ++n) from[n].number = {int(n)};
        ByteWriter out;
        out(from);
        ByteReader in(out.bytes());
        in(there);
        CHECK(in.left() == 0);
        REQUIRE(there.size() == length);
        for (std::size_t n = 0; n < length; ++n) CHECK(there[n].number == from[n].number);
        if (length > 0) CHECK(there[0].room[7] == 1);
    }
}

TEST_CASE("a sink takes the same bytes in pieces, and no more than a piece is held for it") {
    const auto write = [](ByteWriter& out, const std::function<void()>& after_each) {
        for (int n = 0; n < 30'000; ++n) {
            out(n, std::string("of it"));
            after_each();
        }
        out(std::vector<double>(1'000'000, 0.5), std::string("last"));
        after_each();
    };
    ByteWriter at_once;
    write(at_once, [] {});
    std::string taken;
    ByteWriter out(false, [&](std::string_view piece) { taken += piece; });
    std::size_t most = 0;
    write(out, [&] { most = std::max(most, out.bytes().size()); });
    CHECK(most <= 1 << 16);
    CHECK(taken.size() < at_once.bytes().size());
    out.flush();
    CHECK((taken == at_once.bytes()));
    out.flush();
    CHECK(taken.size() == at_once.bytes().size());
}
