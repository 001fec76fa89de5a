// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/suggest.h"

#include <algorithm>
#include <numeric>

namespace swage {

namespace {

// ASCII alone, so that no locale has a say.
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Twice the distance, so that a whole word wins over an equally near part of one.
int score(std::string_view word, std::string_view candidate) {
    int least = 2 * edit_distance(word, candidate);
    for (std::size_t begin = 0; begin < candidate.size();) {
        const std::size_t end = std::min(candidate.find('_', begin), candidate.size());
        const std::string_view part = candidate.substr(begin, end - begin);
        if (part.size() >= 3) least = std::min(least, 2 * edit_distance(word, part) + 1);
        begin = end + 1;
    }
    return least;
}

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
    const std::size_t width = b.size() + 1;
    std::vector<int> before(width), last(width), now(width);
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = static_cast<int>(i);
        for (std::size_t j = 1; j < width; ++j) {
            const bool differ = lower(a[i - 1]) != lower(b[j - 1]);
            now[j] = std::min({last[j - 1] + differ, last[j] + 1, now[j - 1] + 1});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1])) {
                now[j] = std::min(now[j], before[j - 2] + 1);
            }
        }
        std::swap(before, last);
        std::swap(last, now);
    }
    return last.back();
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
    if (word.size() > 64) return {};
    const int letters = static_cast<int>(word.size());
    const int allowed = std::min(std::max(1, letters / 3), letters - 1);
    std::string best;
    int least = 2 * allowed + 2;
    for (const std::string& candidate : known) {
        const int now = score(word, candidate);
        if (now >= least || candidate.size() > 64) continue;
        least = now;
        best = candidate;
    }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
    const std::string best = nearest_word(word, known);
    return best.empty() ? "" : ", did you mean \"" + best + "\"?";
}

std::string hint_and(const std::string& hint, std::string more) {
    if (hint.empty() || more.empty()) return (hint.empty() ? "; " : hint) + more;
    if (more[0] >= 'a' && more[0] <= 'z') more[0] = static_cast<char>(more[0] - 'a' + 'A');
    return hint + " " + more;
}

}  // namespace swage
