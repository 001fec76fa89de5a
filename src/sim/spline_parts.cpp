// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/spline_parts.h"

#include <algorithm>
#include <utility>

#include "geometry/disjoint_sets.h"
#include "matter/connections.h"

namespace swage {

namespace {

// Pieces of fewer particles than this, or than this share of the largest, follow what is beside
// them: by themselves they come to rest soon.
constexpr int kCrumb = 64;
constexpr double kCrumbShare = 0.05;
// More nodes than this, and than so many at each place, cost more than they save.
constexpr int kManyNodes = 1000, kMostCopies = 3;

using Connections = std::array<ConnectionArrays, kForwardCount>;

std::vector<int> numbers_counted(const std::vector<int>& number, int count) {
    std::vector<int> times(static_cast<std::size_t>(count), 0);
    for (int n : number) ++times[n];
    return times;
}

int number_at(const Vec3i& at, const Vec3i& size) {
    return at.x() + size.x() * (at.y() + size.y() * at.z());
}

// The parts of a body, the element of each, and those that it is joined to.
struct Parts {
    std::vector<int> of_particle, size;
    std::vector<Vec3i> element;
    std::vector<std::vector<int>> in_element;  // by number_at()
    std::vector<std::vector<int>> joined;

    Parts(const Lattice& lattice, const Connections& connection,
          const std::array<std::vector<int>, 3>& element_of_site, const Vec3i& elements);
};

Parts::Parts(const Lattice& lattice, const Connections& connection,
             const std::array<std::vector<int>, 3>& element_of_site, const Vec3i& elements) {
    std::vector<Vec3i> at;
    std::vector<int> number;
    for (const ParticleRun& run : lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) {
            at.emplace_back(element_of_site[0][run.i + n], element_of_site[1][run.j],
                            element_of_site[2][run.k]);
            number.push_back(number_at(at.back(), elements));
        }
    }
    DisjointSets pieces(at.size()), parts(at.size());
    for_each_connection(lattice, connection, [&](ParticleId a, ParticleId b, float) {
        pieces.unite(a, b);
        if (number[a] == number[b]) parts.unite(a, b);
    });
    std::vector<int> piece;
    const int piece_count = pieces.number_sets(piece);
    const std::vector<int> piece_size = numbers_counted(piece, piece_count);
    const double crumb = std::min<double>(
        kCrumb, kCrumbShare * *std::max_element(piece_size.begin(), piece_size.end()));
    const auto is_crumb = [&](std::size_t p) { return piece_size[piece[p]] < crumb; };
    std::vector<int> beside(static_cast<std::size_t>(elements.prod()), -1);
    for (std::size_t p = 0; p < at.size(); ++p) {
        int& first = beside[number[p]];
        if (first < 0 || is_crumb(std::size_t(first))) first = static_cast<int>(p);
    }
    for (std::size_t p = 0; p < at.size(); ++p) {
        if (is_crumb(p)) parts.unite(static_cast<int>(p), beside[number[p]]);
    }

    size = numbers_counted(of_particle, parts.number_sets(of_particle));
    element.resize(size.size());
    joined.resize(size.size());
    for (std::size_t p = 0; p < at.size(); ++p) element[of_particle[p]] = at[p];
    in_element.resize(beside.size());
    for (std::size_t n = 0; n < size.size(); ++n) {
        in_element[number_at(element[n], elements)].push_back(static_cast<int>(n));
    }
    for_each_connection(lattice, connection, [&](ParticleId p, ParticleId q, float) {
        const int a = of_particle[p], b = of_particle[q];
        if (a != b && (joined[a].empty() || joined[a].back() != b)) joined[a].push_back(b);
    });
    for (std::vector<int>& to : joined) {
        std::sort(to.begin(), to.end());
        to.erase(std::unique(to.begin(), to.end()), to.end());
    }
}

// Components of some parts, by joints among these: of each its number.
class Components {
  public:
    explicit Components(const Parts& parts) : parts_(parts), at_(parts.size.size(), -1) {}

    std::vector<int> of(const std::vector<int>& some) {
        for (std::size_t n = 0; n < some.size(); ++n) at_[some[n]] = static_cast<int>(n);
        DisjointSets sets(some.size());
        for (int part : some) {
            for (int other : parts_.joined[part]) {
                if (at_[other] >= 0) sets.unite(at_[part], at_[other]);
            }
        }
        for (int part : some) at_[part] = -1;
        std::vector<int> number;
        sets.number_sets(number);
        return number;
    }

  private:
    const Parts& parts_;
    std::vector<int> at_;  // where a part stands among them
};

}  // namespace

SplineParts::SplineParts(const Lattice& lattice, const Connections& connection,
                         const std::array<std::vector<int>, 3>& element, const Vec3i& elements) {
    Parts parts(lattice, connection, element, elements);
    node.resize(parts.size.size());
    const Vec3i grid = elements + Vec3i::Constant(2);
    std::vector<Vec3i> further;
    Components components(parts);
    const auto visit = [&](const Vec3i& at) {
        const int number = static_cast<int>(place.size());
        place.push_back(at);
        std::vector<int> reached;
        for (int q = 0; q < kNodes; ++q) {
            const Vec3i e = at - Vec3i(q % 3, q / 3 % 3, q / 9);
            if ((e.array() < 0).any() || (e.array() >= elements.array()).any()) continue;
            const std::vector<int>& in = parts.in_element[number_at(e, elements)];
            reached.insert(reached.end(), in.begin(), in.end());
        }
        const std::vector<int> component = components.of(reached);
        std::vector<int> size(reached.size(), 0);
        for (std::size_t n = 0; n < reached.size(); ++n) {
            size[component[n]] += parts.size[reached[n]];
        }
        const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
        std::vector<int> node_of(size.size(), -1);
        for (std::size_t n = 0; n < reached.size(); ++n) {
            int& own = node_of[component[n]];
            if (own < 0 && component[n] == largest) own = number;
            if (own < 0) {
                own = grid.prod() + static_cast<int>(further.size());
                further.push_back(at);
            }
            const Vec3i way = at - parts.element[reached[n]];
            node[reached[n]][number_at(way, Vec3i::Constant(3))] = own;
        }
    };
    for (int k = 0; k < grid.z(); ++k) {
        for (int j = 0; j < grid.y(); ++j) {
            for (int i = 0; i < grid.x(); ++i) visit({i, j, k});
        }
    }
    place.insert(place.end(), further.begin(), further.end());
    of_particle = std::move(parts.of_particle);
    if (place.size() <= kManyNodes || static_cast<int>(place.size()) <= kMostCopies * grid.prod()) {
        return;
    }
    for (Nodes& nodes : node) {
        for (int& n : nodes) n = number_at(place[n], grid);
    }
    place.resize(place.size() - further.size());
}

}  // namespace swage
