// SPDX-License-Identifier: GPL-3.0-or-later
// Charts by the axis that a face looks along (box mapping), smoothed by iterated conditional
// modes (J. Besag, "On the statistical analysis of dirty pictures", 1986) and packed by their
// true outlines, largest first, at the largest scale that fits.
#include "geometry/atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "geometry/edges.h"

namespace swage {

namespace {

// Direction 2 a looks along axis a, 2 a + 1 against it.
Vec3 direction(int d) { return d % 2 == 0 ? Vec3(Vec3::Unit(d / 2)) : Vec3(-Vec3::Unit(d / 2)); }

Vec2 project(const Vec3& p, int d) {
    const int u = (d / 2 + 1) % 3, v = (d / 2 + 2) % 3;
    return d % 2 == 0 ? Vec2(p[u], p[v]) : Vec2(-p[u], p[v]);  // never mirrored
}

struct Chart {
    int direction = 0;
    double density = 1;
    std::vector<int> triangle;
    Vec2 low = Vec2::Zero(), size = Vec2::Zero();  // [m], before density
    Vec2 place = Vec2::Zero();                     // of `low`, in cells of the packing
};

// A square of bits, in which charts claim cells.
class Mask {
  public:
    Mask(int width, int height)
        : width_(width),
          height_(height),
          words_((width + 63) / 64),
          bits_(static_cast<std::size_t>(words_) * height) {}
    int width() const { return width_; }
    int height() const { return height_; }
    bool get(int x, int y) const { return bits_[y * words_ + x / 64] >> (x % 64) & 1; }
    void set(int x, int y) { bits_[y * words_ + x / 64] |= std::uint64_t{1} << (x % 64); }

    bool meets(const Mask& other, int x0, int y0) const {
        const int word = x0 / 64, shift = x0 % 64;
        for (int y = 0; y < other.height_; ++y)
            for (int w = 0; w < other.words_; ++w) {
                const std::uint64_t bits = other.bits_[y * other.words_ + w];
                const std::uint64_t* row = &bits_[(y0 + y) * words_];
                if (word + w < words_ && (row[word + w] & bits << shift)) return true;
                if (shift && word + w + 1 < words_ && (row[word + w + 1] & bits >> (64 - shift)))
                    return true;
            }
        return false;
    }
    void add(const Mask& other, int x0, int y0) {
        for (int y = 0; y < other.height_; ++y)
            for (int x = 0; x < other.width_; ++x)
                if (other.get(x, y)) set(x0 + x, y0 + y);
    }

  private:
    int width_, height_, words_;
    std::vector<std::uint64_t> bits_;
};

// f(x, y) for the cells of the plane, of side 1, whose square the triangle grown by `margin`
// may touch (never too few).
template <typename F>
void cells_near(const std::array<Vec2, 3>& corner, double margin, const F& f) {
    const double reach = margin + 0.7072;
    const Vec2 low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
    const Vec2 high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
    const double turn = (corner[1] - corner[0]).x() * (corner[2] - corner[0]).y() -
                        (corner[1] - corner[0]).y() * (corner[2] - corner[0]).x();
    for (int y = static_cast<int>(std::floor(low.y() - margin)); y <= high.y() + margin; ++y)
        for (int x = static_cast<int>(std::floor(low.x() - margin)); x <= high.x() + margin; ++x) {
            const Vec2 center(x + 0.5, y + 0.5);
            bool near = true;
            for (int k = 0; k < 3 && near; ++k) {
                const Vec2 side = corner[(k + 1) % 3] - corner[k], from = center - corner[k];
                const double out =
                    (side.y() * from.x() - side.x() * from.y()) * (turn > 0 ? 1 : -1);
                near = out <= reach * side.norm();
            }
            if (near) f(x, y);
        }
}

class Unwrapper {
  public:
    Unwrapper(TriMesh& mesh, const AtlasSettings& settings)
        : mesh_(mesh), settings_(settings), count_(static_cast<int>(mesh.triangle.size())) {}

    void run() {
        find_neighbours();
        choose_directions();
        cut_charts();
        pack();
        write();
    }

  private:
    void find_neighbours() {
        neighbour_.assign(count_, Corners{-1, -1, -1});
        normal_.resize(count_);
        density_.assign(count_, 1);
        for (int t = 0; t < count_; ++t) {
            const Corners& c = mesh_.triangle[t];
            const Vec3 &p = mesh_.position[c[0]], &q = mesh_.position[c[1]];
            const Vec3& r = mesh_.position[c[2]];
            normal_[t] = area_vector(mesh_.position, c).stableNormalized();
            if (settings_.density) density_[t] = settings_.density((p + q + r) / 3);
        }
        for_each_edge(edge_uses(mesh_.triangle, mesh_.position.size()), [&](auto uses) {
            if (uses.size() != 2) return;
            neighbour_[uses[0].triangle][uses[0].side] = uses[1].triangle;
            neighbour_[uses[1].triangle][uses[1].side] = uses[0].triangle;
        });
    }

    void choose_directions() {
        facing_.resize(count_);
        for (int round = 0; round < 12; ++round)
            for (int t = 0; t < count_; ++t) {
                double best = -1e9;
                int choice = 0;
                for (int d = 0; d < 6; ++d) {
                    const double along = normal_[t].dot(direction(d));
                    double score = along < 0.3 ? along - 4 : along;
                    if (round > 0)
                        for (int n : neighbour_[t]) score += n >= 0 && facing_[n] == d ? 0.35 : 0;
                    if (score > best) {
                        best = score;
                        choice = d;
                    }
                }
                facing_[t] = choice;
            }
    }

    void cut_charts() {
        // Sides along which a chart would fold over itself show as cells claimed twice, at a
        // resolution of about a texel; what comes second waits for a chart of its own.
        const Box box = box_of(mesh_.position);
        const double cell = std::max(box.size().maxCoeff(), 1e-300) / 512;
        std::vector<int> waiting(count_), chart_of(count_, -1);
        std::iota(waiting.begin(), waiting.end(), 0);
        for (int seed = 0; seed < count_; ++seed) {
            if (chart_of[seed] >= 0) continue;
            const int number = static_cast<int>(charts_.size());
            Chart chart;
            chart.direction = facing_[seed];
            chart.density = density_[seed];
            Mask claimed(520, 520);
            const Vec2 a = project(box.low, chart.direction);
            const Vec2 corner = a.cwiseMin(project(box.high, chart.direction)) / cell;
            const auto claim = [&](int t) {
                std::array<Vec2, 3> p;
                for (int k = 0; k < 3; ++k)
                    p[k] = project(mesh_.position[mesh_.triangle[t][k]], chart.direction) / cell -
                           corner + Vec2::Ones();
                bool free = true;
                // Centres well inside the triangle only: neighbours share their edge.
                cells_near(p, -0.7072 - 1e-6,
                           [&](int x, int y) { free = free && !claimed.get(x, y); });
                if (free) cells_near(p, -0.7072 - 1e-6, [&](int x, int y) { claimed.set(x, y); });
                return free;
            };
            chart_of[seed] = number;
            claim(seed);
            chart.triangle.push_back(seed);
            for (std::size_t i = 0; i < chart.triangle.size(); ++i)
                for (int n : neighbour_[chart.triangle[i]])
                    if (n >= 0 && chart_of[n] < 0 && facing_[n] == chart.direction &&
                        density_[n] == chart.density && claim(n)) {
                        chart_of[n] = number;
                        chart.triangle.push_back(n);
                    }
            measure(chart);
            charts_.push_back(std::move(chart));
        }
    }

    void measure(Chart& chart) const {
        Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
        for (int t : chart.triangle)
            for (int p : mesh_.triangle[t]) {
                const Vec2 at = project(mesh_.position[p], chart.direction);
                low = low.cwiseMin(at);
                high = high.cwiseMax(at);
            }
        chart.low = low;
        chart.size = high - low;
    }

    std::array<Vec2, 3> placed(const Chart& chart, int t, double scale) const {
        std::array<Vec2, 3> p;
        for (int k = 0; k < 3; ++k)
            p[k] = scale * chart.density *
                   (project(mesh_.position[mesh_.triangle[t][k]], chart.direction) - chart.low);
        return p;
    }

    // All charts at `scale` cells a metre, largest first, each at the first free place.
    bool try_pack(double scale, double margin) {
        Mask square(kCells, kCells);
        for (int c : order_) {
            Chart& chart = charts_[c];
            const Vec2 room = scale * chart.density * chart.size + Vec2::Constant(2 * margin + 2);
            const int width = static_cast<int>(std::ceil(room.x()));
            const int height = static_cast<int>(std::ceil(room.y()));
            if (width > kCells || height > kCells) return false;
            Mask shape(width, height);
            for (int t : chart.triangle) {
                auto p = placed(chart, t, scale);
                for (Vec2& corner : p) corner += Vec2::Constant(margin + 1);
                cells_near(p, margin, [&](int x, int y) {
                    if (x >= 0 && y >= 0 && x < width && y < height) shape.set(x, y);
                });
            }
            bool found = false;
            for (int y = 0; y + height <= kCells && !found; ++y)
                for (int x = 0; x + width <= kCells && !found; ++x)
                    if (!square.meets(shape, x, y)) {
                        found = true;
                        square.add(shape, x, y);
                        chart.place = Vec2(x, y) + Vec2::Constant(margin + 1);
                    }
            if (!found) return false;
        }
        return true;
    }

    void pack() {
        order_.resize(charts_.size());
        std::iota(order_.begin(), order_.end(), 0);
        const auto extent = [&](int c) {
            return charts_[c].density * (charts_[c].size.x() + charts_[c].size.y());
        };
        std::stable_sort(order_.begin(), order_.end(),
                         [&](int a, int b) { return extent(a) > extent(b); });
        const double margin = settings_.margin * kCells / settings_.size;
        double fits = 0, too_large = 4 * kCells / std::max(extent(order_[0]), 1e-300);
        for (int i = 0; i < 14; ++i) {
            const double middle = 0.5 * (fits + too_large);
            (try_pack(middle, margin) ? fits : too_large) = middle;
        }
        if (fits == 0 || !try_pack(fits, margin))
            fail(ExitCode::mesh, "the {} charts of the texture atlas do not fit into {} texels",
                 charts_.size(), settings_.size);
        scale_ = fits;
    }

    void write() {
        mesh_.uv.clear();
        mesh_.triangle_uv.assign(count_, Corners{-1, -1, -1});
        std::vector<int> seen(mesh_.position.size(), -1), owner(mesh_.position.size(), -1);
        for (std::size_t c = 0; c < charts_.size(); ++c) {
            const Chart& chart = charts_[c];
            for (int t : chart.triangle) {
                const auto p = placed(chart, t, scale_);
                for (int k = 0; k < 3; ++k) {
                    const int vertex = mesh_.triangle[t][k];
                    if (owner[vertex] != static_cast<int>(c)) {
                        owner[vertex] = static_cast<int>(c);
                        seen[vertex] = static_cast<int>(mesh_.uv.size());
                        mesh_.uv.push_back((p[k] + chart.place) / kCells);
                    }
                    mesh_.triangle_uv[t][k] = seen[vertex];
                }
            }
        }
    }

    static constexpr int kCells = 256;  // a side of the packing

    TriMesh& mesh_;
    const AtlasSettings& settings_;
    int count_;
    std::vector<Corners> neighbour_;
    std::vector<Vec3> normal_;
    std::vector<double> density_;
    std::vector<int> facing_;
    std::vector<Chart> charts_;
    std::vector<int> order_;
    double scale_ = 0;  // cells a metre
};

}  // namespace

void unwrap(TriMesh& mesh, const AtlasSettings& settings) {
    if (mesh.triangle.empty()) return;
    Unwrapper(mesh, settings).run();
}

}  // namespace swage
