// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse Cholesky factor of a matrix in blocks of three, for many solutions: neighbouring columns
// of the factor that have the same rows are kept as one dense panel (supernodes; Ng and Peyton,
// SIAM J. Sci. Comput. 14, 1993), which is several times as fast as going by indices.
#pragma once

#include <Eigen/SparseCholesky>
#include <utility>
#include <vector>

namespace swage {

class PanelCholesky {
  public:
    using Vector = Eigen::VectorXd;
    using Matrix = Eigen::SparseMatrix<double>;

    // `pair`: nodes that are coupled, each pair once; every node is with itself.
    PanelCholesky(int nodes, const std::vector<std::pair<int, int>>& pair);

    // The factor's matrix: its lower triangle, for node `node_at` in place of each place.
    Matrix& matrix() { return matrix_; }
    int node_at(int place) const { return node_at_[place]; }
    int place_of(int node) const { return place_of_[node]; }

    // False: the matrix is not positive definite.
    bool factor();
    // x = K^-1 b, both by node.
    Vector solved(const Vector& b) const;

  private:
    struct Panel {
        int first, width;             // columns
        std::size_t row, rows_below;  // in row_
        std::size_t value;            // in value_: the whole panel, by columns
    };
    void find_panels();

    std::vector<int> node_at_, place_of_;
    Matrix matrix_;
    Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
    std::vector<Panel> panel_;
    std::vector<int> row_;
    std::vector<double> value_;
};

}  // namespace swage
