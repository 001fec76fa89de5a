// SPDX-License-Identifier: GPL-3.0-or-later
// How values pass to bytes and back (base/bytes.h). What a thing consists of is said once for
// both ways, so that a member that is added to it and forgotten here does not compile:
//
//     template <typename Io>
//     void visit(Io& io, Thing& thing) {
//         auto& [one, other] = thing;  // all of its members
//         io(one, other);
//     }
//
// Where members are private, `thing.visit(io)` does that. What is one run of bytes, and points to
// nothing, may say so instead: `using IsPlain = Thing;`. Its gaps pass as they are.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/math.h"

namespace swage {

template <typename T>
concept SaysPlain = std::is_same_v<typename T::IsPlain, T>;  // and not what it derives from
template <typename T>
struct IsRaw : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T> || SaysPlain<T>> {};
template <>
struct IsRaw<Pose> : std::true_type {};
template <>
struct IsRaw<Twist> : std::true_type {};
template <typename T, int rows, int columns>
struct IsRaw<Eigen::Matrix<T, rows, columns>> : std::bool_constant<(rows > 0 && columns > 0)> {};
template <typename T, std::size_t count>
struct IsRaw<std::array<T, count>> : IsRaw<T> {};
template <typename T>
concept Raw = IsRaw<T>::value;
template <typename T>
concept Visited = !Raw<T>;
template <typename T, typename Io>
concept HasMembers = Visited<T> && requires(Io& io, T& value) {
    value.visit(io);
};
template <typename T, typename Io>
concept HasRule = Visited<T> && requires(Io& io, T& value) {
    visit(io, value);
};

template <typename Io, Raw T>
void pass(Io& io, T& value) {
    io.raw(&value, sizeof value);
}
template <typename Io>
void pass(Io& io, std::string& text) {
    text.resize(io.count(text.size(), 1));
    io.raw(text.data(), text.size());
}
template <typename Io>
void pass(Io& io, std::filesystem::path& path) {
    std::string text = path.string();
    io(text);
    path = text;
}
// One after another: a count that is no truth ends where the bytes do, before it takes much room.
template <typename Io, typename List>
void pass_each(Io& io, List& values) {
    const std::size_t count = io.count(values.size(), 1);
    for (std::size_t n = 0; n < count; ++n) {
        if (n == values.size()) values.emplace_back();
        io(values[n]);
    }
    values.resize(count);
}
template <typename Io, typename T>
void pass(Io& io, std::vector<T>& values) {
    if constexpr (Raw<T>) {
        values.resize(io.count(values.size(), sizeof(T)));
        io.raw(values.data(), values.size() * sizeof(T));
    } else {
        pass_each(io, values);
    }
}
template <typename Io, typename T>
void pass(Io& io, std::deque<T>& values) {
    pass_each(io, values);
}
constexpr std::int64_t kMostRows = std::int64_t(1) << 40;  // or columns, of a matrix
template <typename Io>
void pass(Io& io, Eigen::MatrixXd& matrix) {
    std::int64_t rows = matrix.rows(), columns = matrix.cols();
    io(rows, columns);
    std::vector<double> values(matrix.data(), matrix.data() + matrix.size());
    io(values);
    if constexpr (Io::kReads) {
        const auto size = static_cast<std::int64_t>(values.size());
        const bool is_empty = rows == 0 || columns == 0;
        const bool fits = rows >= 0 && columns >= 0 && rows <= kMostRows && columns <= kMostRows &&
                          (is_empty ? size == 0 : size % rows == 0 && size / rows == columns);
        if (!fits) fail(ExitCode::output, "a matrix of the file is damaged");
        matrix = Eigen::Map<Eigen::MatrixXd>(values.data(), rows, columns);
    }
}
template <typename Io, typename K, typename T>
void pass(Io& io, std::map<K, T>& values) {
    std::vector<std::pair<K, T>> all(values.begin(), values.end());
    io(all);
    if constexpr (Io::kReads) values = std::map<K, T>(all.begin(), all.end());
}
template <typename Io, Visited T, std::size_t count>
void pass(Io& io, std::array<T, count>& values) {
    for (T& value : values) io(value);
}
template <typename Io, typename A, typename B>
void pass(Io& io, std::pair<A, B>& both) {
    io(both.first, both.second);
}
template <typename Io, typename T>
void pass(Io& io, std::optional<T>& value) {
    bool is_there = value.has_value();
    io(is_there);
    if (!is_there) value.reset();
    if (is_there && !value) value.emplace();
    if (is_there) io(*value);
}
template <typename Io, HasMembers<Io> T>
void pass(Io& io, T& value) {
    value.visit(io);
}
template <typename Io, HasRule<Io> T>
void pass(Io& io, T& value) {
    visit(io, value);
}

}  // namespace swage
