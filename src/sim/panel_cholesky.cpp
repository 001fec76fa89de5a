// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/panel_cholesky.h"

#include <Eigen/OrderingMethods>
#include <algorithm>

namespace swage {

PanelCholesky::PanelCholesky(int nodes, const std::vector<std::pair<int, int>>& pair)
    : node_at_(nodes), place_of_(nodes) {
    std::vector<Eigen::Triplet<double>> entry;
    for (const auto& [a, b] : pair) {
        entry.emplace_back(a, b, 1.0);
        if (a != b) entry.emplace_back(b, a, 1.0);
    }
    Matrix graph(nodes, nodes);
    graph.setFromTriplets(entry.begin(), entry.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(graph, order);
    for (int n = 0; n < nodes; ++n) {
        node_at_[n] = order.indices()[n];
        place_of_[node_at_[n]] = n;
    }
    entry.clear();
    for (const auto& [a, b] : pair) {
        const auto [column, row] = std::minmax(place_of_[a], place_of_[b]);
        for (int c = 0; c < 3; ++c) {
            for (int r = row == column ? c : 0; r < 3; ++r) {
                entry.emplace_back(3 * row + r, 3 * column + c, 1.0);
            }
        }
    }
    matrix_.resize(3 * nodes, 3 * nodes);
    matrix_.setFromTriplets(entry.begin(), entry.end());
    factor_.analyzePattern(matrix_);
}

// The rows of a factor do not depend on its values.
void PanelCholesky::find_panels() {
    const Matrix& l = factor_.matrixL().nestedExpression();
    const int* begin = l.outerIndexPtr();
    const int* row = l.innerIndexPtr();
    std::size_t values = 0;
    for (int c = 0; c < l.cols();) {
        Panel p{c, 1, row_.size(), 0, values};
        const int count = begin[c + 1] - begin[c];
        while (p.width < count && c + p.width < l.cols()) {
            const int next = c + p.width;
            if (begin[next + 1] - begin[next] != count - p.width ||
                !std::equal(row + begin[next], row + begin[next + 1], row + begin[c] + p.width)) {
                break;
            }
            ++p.width;
        }
        row_.insert(row_.end(), row + begin[c] + p.width, row + begin[c + 1]);
        p.rows_below = static_cast<std::size_t>(count - p.width);
        values += static_cast<std::size_t>(p.width) * count;
        panel_.push_back(p);
        c += p.width;
    }
    value_.assign(values, 0.0);
}

bool PanelCholesky::factor() {
    factor_.factorize(matrix_);
    if (factor_.info() != Eigen::Success) return false;
    if (panel_.empty()) find_panels();
    const Matrix& l = factor_.matrixL().nestedExpression();
    for (const Panel& p : panel_) {
        const std::size_t height = p.width + p.rows_below;
        for (int c = 0; c < p.width; ++c) {
            const double* from = l.valuePtr() + l.outerIndexPtr()[p.first + c];
            std::copy_n(from, height - c, &value_[p.value + c * height + c]);
        }
    }
    return true;
}

PanelCholesky::Vector PanelCholesky::solved(const Vector& b) const {
    using Block = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
    const auto blocks = [&](const Panel& p) {
        const auto height = static_cast<Eigen::Index>(p.width + p.rows_below);
        const double* value = &value_[p.value];
        return std::pair(
            Block(value, p.width, p.width, Eigen::OuterStride<>(height)),
            Block(value + p.width, height - p.width, p.width, Eigen::OuterStride<>(height)));
    };
    Vector x(b.size()), below(b.size());
    for (std::size_t n = 0; n < node_at_.size(); ++n) {
        x.segment<3>(3 * n) = b.segment<3>(3 * node_at_[n]);
    }
    for (const Panel& p : panel_) {
        const auto [own, rest] = blocks(p);
        auto part = x.segment(p.first, p.width);
        own.triangularView<Eigen::Lower>().solveInPlace(part);
        auto sum = below.head(rest.rows());
        sum.noalias() = rest * part;
        for (std::size_t r = 0; r < p.rows_below; ++r) x[row_[p.row + r]] -= sum[r];
    }
    for (auto p = panel_.rbegin(); p != panel_.rend(); ++p) {
        const auto [own, rest] = blocks(*p);
        auto part = x.segment(p->first, p->width);
        for (std::size_t r = 0; r < p->rows_below; ++r) below[r] = x[row_[p->row + r]];
        part.noalias() -= rest.transpose() * below.head(rest.rows());
        own.triangularView<Eigen::Lower>().transpose().solveInPlace(part);
    }
    Vector result(b.size());
    for (std::size_t n = 0; n < node_at_.size(); ++n) {
        result.segment<3>(3 * node_at_[n]) = x.segment<3>(3 * n);
    }
    return result;
}

}  // namespace swage
